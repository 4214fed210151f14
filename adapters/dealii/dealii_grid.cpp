#include "dealii/dealii_grid.h"

#include <deal.II/base/mpi.h>
#include <deal.II/distributed/fully_distributed_tria.h>
#include <deal.II/distributed/tria.h>
#include <deal.II/fe/fe_tools.h>
#include <deal.II/fe/mapping_q_cache.h>
#include <deal.II/grid/tria.h>

#include <numeric>
#include <utility>

#include "dealii/grid_data.h"
#include "vasohex/core/error.h"
#include "vasohex/mesh_part.h"

namespace vasohex {
namespace {

using Triangulation = dealii::Triangulation<3, 3>;
using CellIterator = Triangulation::cell_iterator;

dealii::Point<3> to_point(const Vec3& x) { return {x.x(), x.y(), x.z()}; }

/// Where a cell lies within its coarse cell. On each refinement deal.II halves the cell's own reference cube, child c
/// at (c & 1, c >> 1 & 1, c >> 2 & 1), however the cell is turned.
SubCube cube_of(const dealii::CellId& id) {
  SubCube cube;
  for (const std::uint8_t child : id.get_child_indices()) {
    cube.size /= 2;
    for (int d = 0; d < 3; ++d) {
      cube.low[d] += cube.size * (child >> d & 1);
    }
  }
  return cube;
}

using FullyDistributed = dealii::parallel::fullydistributed::Triangulation<3, 3>;

/// Finds the element that a cell stems from.
class ElementOf {
 public:
  ElementOf(const DealiiGrid::Data& data, const Triangulation& triangulation)
      : data_(data), by_id_(dynamic_cast<const FullyDistributed*>(&triangulation) != nullptr) {}

  int operator()(CellIterator cell, const dealii::CellId& id) const {
    if (by_id_) {  // each rank has a numbering of its own
      return data_.element_of(static_cast<std::int64_t>(id.get_coarse_cell_id()));
    }
    // with p4est the coarse cell id is the number of a tree; the index is the one that we gave
    while (cell->level() > 0) {
      cell = cell->parent();
    }
    return cell->index();
  }

 private:
  const DealiiGrid::Data& data_;
  bool by_id_;
};

}  // namespace

DealiiGrid::DealiiGrid(HexMesh mesh) : DealiiGrid(Data{CoarseCells(std::move(mesh)), {}, {}, {}}) {}

DealiiGrid::DealiiGrid(const BlockStructure& blocks, std::shared_ptr<const ImplicitSurface> surface)
    : DealiiGrid(Data{CoarseCells(blocks, std::move(surface)), {}, {}, {}}) {}

DealiiGrid::DealiiGrid(const BlockFile& file) : DealiiGrid(file.blocks, make_surface(file)) {}

DealiiGrid::DealiiGrid(const BlockFile& file, const Grading& grading, const MeshOptions& options,
                       MPI_Comm communicator) {
  Run run;
  run.threads = 1;  // one rank, one core
  MeshPart part =
      mesh_part(file, grading, options, static_cast<int>(dealii::Utilities::MPI::this_mpi_process(communicator)),
                static_cast<int>(dealii::Utilities::MPI::n_mpi_processes(communicator)), run);
  data_ =
      std::make_shared<const Data>(Data{CoarseCells(std::move(part.result.mesh)), mesh_info(block_mesh(file.blocks)),
                                        std::move(part.ids), std::move(part.owner)});
}

DealiiGrid::DealiiGrid(Data data) {
  data.info = mesh_info(data.cells.mesh());
  data_ = std::make_shared<const Data>(std::move(data));
}

const MeshInfo& DealiiGrid::info() const { return data_->info; }

void DealiiGrid::create(Triangulation& triangulation) const {
  if (auto* fully = dynamic_cast<FullyDistributed*>(&triangulation)) {
    fully->create_triangulation(data_->description(fully->get_communicator()));
  } else {
    if (!data_->ids.empty()) {
      throw Error(ErrorCode::bad_input,
                  "one rank's part of a mesh can only become a parallel::fullydistributed triangulation");
    }
    std::vector<int> all(data_->cells.mesh().element_count());
    std::iota(all.begin(), all.end(), 0);
    const auto [vertices, cells] = data_->corner_cells(all);
    triangulation.create_triangulation(vertices, cells, dealii::SubCellData());
  }
  // The rest is set here, since a list of boundary quadrangles would have to be found by their vertices again.
  const HexMesh& mesh = data_->cells.mesh();
  const ElementOf element_of(*data_, triangulation);
  std::vector<CellIterator> cells(mesh.element_count());
  for (const CellIterator& cell : triangulation.cell_iterators_on_level(0)) {
    cells[element_of(cell, cell->id())] = cell;
  }
  for (const HexMesh::BoundaryFace& face : mesh.boundary) {
    if (cells[face.element].state() == dealii::IteratorState::valid) {
      cells[face.element]->face(face.face)->set_all_boundary_ids(face.surface + 1);
    }
  }
}

void DealiiGrid::map(Triangulation& triangulation, dealii::MappingQCache<3, 3>& mapping) const {
  const ElementOf element_of(*data_, triangulation);
  std::vector<char> moved(triangulation.n_vertices(), 0);
  for (const CellIterator& cell : triangulation.cell_iterators()) {
    bool all_moved = true;
    for (unsigned int v = 0; v < 8; ++v) {
      all_moved = all_moved && moved[cell->vertex_index(v)];
    }
    if (all_moved) {
      continue;
    }
    const dealii::CellId id = cell->id();
    const std::vector<Vec3> corners = data_->cells.points(element_of(cell, id), cube_of(id), 1);
    for (unsigned int v = 0; v < 8; ++v) {
      cell->vertex(v) = to_point(corners[v]);
      moved[cell->vertex_index(v)] = 1;
    }
  }
  triangulation.signals.mesh_movement();
  const int order = static_cast<int>(mapping.get_degree());
  const std::vector<unsigned int> lexicographic =
      dealii::FETools::hierarchic_to_lexicographic_numbering<3>(mapping.get_degree());
  mapping.initialize(triangulation, [&](const CellIterator& cell) {
    const dealii::CellId id = cell->id();
    const std::vector<Vec3> x = data_->cells.points(element_of(cell, id), cube_of(id), order);
    std::vector<dealii::Point<3>> points(x.size());
    for (std::size_t i = 0; i < x.size(); ++i) {
      points[i] = to_point(x[lexicographic[i]]);
    }
    return points;
  });
}

}  // namespace vasohex
