#include "dealii/grid_data.h"

#include <deal.II/base/types.h>

#include <algorithm>
#include <string>
#include <tuple>

#include "vasohex/core/error.h"
#include "vasohex/mesh_part.h"

namespace vasohex {
namespace {

constexpr std::array<int, 8> corner_nodes(int order) {
  std::array<int, 8> at{};
  for (int c = 0; c < 8; ++c) {
    at[c] = order * ((c & 1) + (order + 1) * ((c >> 1 & 1) + (order + 1) * (c >> 2 & 1)));
  }
  return at;
}

}  // namespace

int DealiiGrid::Data::element_of(std::int64_t coarse_cell_id) const {
  if (ids.empty()) {
    return static_cast<int>(coarse_cell_id);
  }
  const auto found = std::lower_bound(ids.begin(), ids.end(), coarse_cell_id);
  if (found == ids.end() || *found != coarse_cell_id) {
    throw Error(ErrorCode::internal, "coarse cell " + std::to_string(coarse_cell_id) + " is not of this rank's part");
  }
  return static_cast<int>(found - ids.begin());
}

std::pair<std::vector<dealii::Point<3>>, std::vector<dealii::CellData<3>>> DealiiGrid::Data::corner_cells(
    const std::vector<int>& elements) const {
  const HexMesh& mesh = cells.mesh();
  const std::array<int, 8> corners = corner_nodes(mesh.order);
  std::vector<int> vertex_of(mesh.nodes.size(), -1);
  std::pair<std::vector<dealii::Point<3>>, std::vector<dealii::CellData<3>>> out;
  for (const int e : elements) {
    dealii::CellData<3> cell;
    cell.material_id = info.material_id;
    for (int c = 0; c < 8; ++c) {
      const int node = mesh.elements[static_cast<std::size_t>(e) * mesh.nodes_per_element() + corners[c]];
      if (vertex_of[node] < 0) {
        vertex_of[node] = static_cast<int>(out.first.size());
        const Vec3& x = mesh.nodes[node];
        out.first.emplace_back(x.x(), x.y(), x.z());
      }
      cell.vertices[c] = static_cast<unsigned int>(vertex_of[node]);
    }
    out.second.push_back(cell);
  }
  return out;
}

dealii::TriangulationDescription::Description<3, 3> DealiiGrid::Data::description(MPI_Comm communicator) const {
  const HexMesh& mesh = cells.mesh();
  const int count = mesh.element_count();
  std::vector<int> relevant;
  std::vector<int> ranks = owner;
  if (ids.empty()) {
    const int size = static_cast<int>(dealii::Utilities::MPI::n_mpi_processes(communicator));
    const int rank = static_cast<int>(dealii::Utilities::MPI::this_mpi_process(communicator));
    if (count < size) {
      throw Error(ErrorCode::bad_input, "a grid of " + std::to_string(count) + " cells cannot be dealt out to " +
                                            std::to_string(size) + " ranks; use at most as many ranks as cells");
    }
    for (int e = 0; e < count; ++e) {
      ranks.push_back(owner_of(e, count, size));
    }
    const std::array<int, 8> corners = corner_nodes(mesh.order);
    std::vector<char> own_vertex(mesh.nodes.size(), 0);
    for (const int pass : {0, 1}) {
      for (int e = 0; e < count; ++e) {
        const int* nodes = &mesh.elements[static_cast<std::size_t>(e) * mesh.nodes_per_element()];
        bool near = false;
        for (const int c : corners) {
          if (pass == 0 && ranks[e] == rank) {
            own_vertex[nodes[c]] = 1;
          }
          near = near || own_vertex[nodes[c]];
        }
        if (pass == 1 && near) {
          relevant.push_back(e);
        }
      }
    }
  } else {
    for (int e = 0; e < count; ++e) {
      relevant.push_back(e);
    }
  }
  dealii::TriangulationDescription::Description<3, 3> out;
  std::tie(out.coarse_cell_vertices, out.coarse_cells) = corner_cells(relevant);
  out.comm = communicator;
  out.settings = dealii::TriangulationDescription::Settings::construct_multigrid_hierarchy;
  out.smoothing = dealii::Triangulation<3, 3>::limit_level_difference_at_vertices;
  out.cell_infos.resize(1);
  for (const int e : relevant) {
    const dealii::types::coarse_cell_id id = static_cast<std::uint64_t>(ids.empty() ? e : ids[e]);
    out.coarse_cell_index_to_coarse_cell_id.push_back(id);
    dealii::TriangulationDescription::CellData<3> cell;
    cell.id = dealii::CellId(id, {}).to_binary<3>();
    cell.subdomain_id = static_cast<unsigned int>(ranks[e]);
    cell.level_subdomain_id = cell.subdomain_id;
    cell.manifold_id = dealii::numbers::flat_manifold_id;
    cell.manifold_line_ids.fill(dealii::numbers::flat_manifold_id);
    cell.manifold_quad_ids.fill(dealii::numbers::flat_manifold_id);
    out.cell_infos[0].push_back(cell);
  }
  return out;
}

}  // namespace vasohex
