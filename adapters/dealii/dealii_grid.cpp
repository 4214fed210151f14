#include "dealii/dealii_grid.h"

#include <deal.II/base/mpi.h>
#include <deal.II/base/multithread_info.h>
#include <deal.II/distributed/fully_distributed_tria.h>
#include <deal.II/distributed/tria.h>
#include <deal.II/fe/fe_tools.h>
#include <deal.II/fe/mapping_q_cache.h>
#include <deal.II/grid/tria.h>

#include <numeric>
#include <utility>

#include "dealii/grid_data.h"
#include "vasohex/core/error.h"
#include "vasohex/core/parallel.h"
#include "vasohex/mesh_part.h"

namespace vasohex {
namespace {

using Triangulation = dealii::Triangulation<3, 3>;
using CellIterator = Triangulation::cell_iterator;

dealii::Point<3> to_point(const Vec3& x) { return {x.x(), x.y(), x.z()}; }

using FullyDistributed = dealii::parallel::fullydistributed::Triangulation<3, 3>;

/// The element that a coarse cell was made of.
int element_of(const DealiiGrid::Data& data, const CellIterator& coarse) {
  if (dynamic_cast<const FullyDistributed*>(&coarse->get_triangulation())) {  // each rank has a numbering of its own
    return data.element_of(static_cast<std::int64_t>(coarse->id().get_coarse_cell_id()));
  }
  return coarse->index();  // with p4est the coarse cell id is the number of a tree; the index is the one that we gave
}

/// Calls f(cell, its cube within the coarse cell) for a cell and all its descendants. On each refinement deal.II
/// halves the cell's own reference cube, child c at (c & 1, c >> 1 & 1, c >> 2 & 1), however the cell is turned.
template <class F>
void for_descendants(const CellIterator& cell, const SubCube& cube, const F& f) {
  f(cell, cube);
  for (unsigned int c = 0; cell->has_children() && c < 8; ++c) {
    SubCube child{cube.low, cube.size / 2};
    for (int d = 0; d < 3; ++d) {
      child.low[d] += child.size * (c >> d & 1);
    }
    for_descendants(cell->child(c), child, f);
  }
}

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
  std::vector<CellIterator> cells(mesh.element_count());
  for (const CellIterator& cell : triangulation.cell_iterators_on_level(0)) {
    cells[element_of(*data_, cell)] = cell;
  }
  for (const HexMesh::BoundaryFace& face : mesh.boundary) {
    if (cells[face.element].state() == dealii::IteratorState::valid) {
      cells[face.element]->face(face.face)->set_all_boundary_ids(face.surface + 1);
    }
  }
}

void DealiiGrid::map(Triangulation& triangulation, dealii::MappingQCache<3, 3>& mapping) const {
  const int order = static_cast<int>(mapping.get_degree());
  const std::vector<unsigned int> lexicographic =
      dealii::FETools::hierarchic_to_lexicographic_numbering<3>(mapping.get_degree());
  std::vector<std::vector<std::vector<dealii::Point<3>>>> points(triangulation.n_levels());
  for (unsigned int level = 0; level < points.size(); ++level) {
    points[level].resize(triangulation.n_raw_cells(level));
  }
  std::vector<CellIterator> coarse;
  for (const CellIterator& cell : triangulation.cell_iterators_on_level(0)) {
    coarse.push_back(cell);
  }
  Run run;
  run.threads = static_cast<int>(dealii::MultithreadInfo::n_threads());
  parallel_for(run, coarse.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const int element = element_of(*data_, coarse[i]);
      CoarseCells::WallShifts known;
      for_descendants(coarse[i], {}, [&](const CellIterator& cell, const SubCube& cube) {
        const std::vector<Vec3> x = data_->cells.points(element, cube, order, known);
        std::vector<dealii::Point<3>>& out = points[cell->level()][cell->index()];
        out.resize(x.size());
        for (std::size_t n = 0; n < x.size(); ++n) {
          out[n] = to_point(x[lexicographic[n]]);
        }
      });
    }
  });
  for (const CellIterator& cell : triangulation.cell_iterators()) {
    for (unsigned int v = 0; v < 8; ++v) {
      cell->vertex(v) = points[cell->level()][cell->index()][v];
    }
  }
  triangulation.signals.mesh_movement();
  mapping.initialize(triangulation,
                     [&](const CellIterator& cell) { return std::move(points[cell->level()][cell->index()]); });
}

}  // namespace vasohex
