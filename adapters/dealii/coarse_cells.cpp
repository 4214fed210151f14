#include "dealii/coarse_cells.h"

#include <algorithm>
#include <string>
#include <utility>

#include "vasohex/core/error.h"
#include "vasohex/core/node_family.h"
#include "vasohex/core/reference_hex.h"
#include "vasohex/mesh/wall_node.h"

namespace vasohex {

HexMesh block_mesh(const BlockStructure& blocks) {
  HexMesh mesh;
  mesh.order = blocks.degree;
  mesh.family = NodeFamily::gauss_lobatto;
  mesh.nodes = blocks.nodes;
  mesh.elements = blocks.block_nodes;
  mesh.element_branch = blocks.places;
  for (std::size_t b = 0; b < blocks.blocks.size(); ++b) {
    mesh.element_block.push_back(static_cast<int>(b));
  }
  for (const BlockStructure::BoundaryFace& f : blocks.boundary) {
    mesh.boundary.push_back({f.block, f.face, f.surface});
  }
  mesh.surfaces = blocks.surfaces;
  mesh.units = blocks.units;
  return mesh;
}

CoarseCells::CoarseCells(HexMesh mesh) : mesh_(std::move(mesh)), nodes_1d_(family_nodes(mesh_.family, mesh_.order)) {
  for (int e = 0; e < mesh_.element_count(); ++e) {
    Eigen::Matrix3d jacobian;
    const Vec3 middle = point(e, Vec3::Constant(0.5), jacobian);
    if (!(jacobian.determinant() > 0)) {
      const auto text = [&](int d) { return std::to_string(middle[d]); };
      throw Error(ErrorCode::bad_input,
                  "element " + std::to_string(e) + " around (" + text(0) + ", " + text(1) + ", " + text(2) +
                      ") is mirrored or degenerate: its Jacobian determinant must be positive in the middle");
    }
  }
}

CoarseCells::CoarseCells(const BlockStructure& blocks, std::shared_ptr<const ImplicitSurface> surface)
    : CoarseCells(block_mesh(blocks)) {
  if (!surface) {
    return;
  }
  surface_ = std::move(surface);
  for (const std::vector<Stretch>& region : blocks.regions) {
    parts_.push_back(surface_->part(region));
  }
  for (const SectionFrame& end : blocks.ends) {
    plane_normals_.push_back(end.normal());
  }
  walls_.resize(blocks.blocks.size());
  for (std::size_t b = 0; b < walls_.size(); ++b) {
    walls_[b].surface = parts_[blocks.block_region[b]].get();
  }
  for (const BlockStructure::BoundaryFace& f : blocks.boundary) {
    if (f.surface == 0) {
      walls_[f.block].face = f.face;
    } else {
      walls_[f.block].end[f.face] = f.surface;
    }
  }
}

std::vector<Vec3> CoarseCells::points(int element, const SubCube& cube, int order, WallShifts& known) const {
  const int n = mesh_.order + 1, m = order + 1;
  Places at;
  const std::vector<double> lobatto = family_nodes(NodeFamily::gauss_lobatto, order);
  for (int d = 0; d < 3; ++d) {
    for (const double x : lobatto) {
      at.t[d].push_back(cube.low[d] + cube.size * x);
    }
    at.t[d].back() = cube.low[d] + cube.size;  // neighbours have this very number
    at.values[d] = lagrange_values(nodes_1d_, at.t[d]);
  }
  const int* ids = &mesh_.elements[static_cast<std::size_t>(element) * n * n * n];
  std::vector<Vec3> along_i(m * n * n), along_j(m * m * n), out(m * m * m);
  for (int r = 0; r < n * n; ++r) {
    for (int a = 0; a < m; ++a) {
      Vec3 x = Vec3::Zero();
      for (int i = 0; i < n; ++i) {
        x += at.values[0][a * n + i] * mesh_.nodes[ids[r * n + i]];
      }
      along_i[r * m + a] = x;
    }
  }
  for (int k = 0; k < n; ++k) {
    for (int b = 0; b < m; ++b) {
      for (int a = 0; a < m; ++a) {
        Vec3 x = Vec3::Zero();
        for (int j = 0; j < n; ++j) {
          x += at.values[1][b * n + j] * along_i[(k * n + j) * m + a];
        }
        along_j[(k * m + b) * m + a] = x;
      }
    }
  }
  for (int c = 0; c < m; ++c) {
    for (int ab = 0; ab < m * m; ++ab) {
      Vec3 x = Vec3::Zero();
      for (int k = 0; k < n; ++k) {
        x += at.values[2][c * n + k] * along_j[k * m * m + ab];
      }
      out[c * m * m + ab] = x;
    }
  }
  if (!walls_.empty() && walls_[element].face >= 0) {
    shift_towards_wall(element, at, known, out);
  }
  return out;
}

void CoarseCells::shift_towards_wall(int element, const Places& at, WallShifts& known,
                                     std::vector<Vec3>& points) const {
  const int m = static_cast<int>(at.t[0].size());
  const Wall& wall = walls_[element];
  const int d = wall.face / 2;
  const bool at_end = wall.face % 2 == 1;
  const auto [da, db] = hex_face_axes(wall.face);
  const std::array<int, 3> stride{1, m, m * m};
  for (int b = 0; b < m; ++b) {
    for (int a = 0; a < m; ++a) {
      const auto [entry, is_new] = known.try_emplace({at.t[da][a], at.t[db][b]});
      Vec3& shift = entry->second;
      if (is_new) {
        Vec3 reference;
        reference[da] = at.t[da][a];
        reference[db] = at.t[db][b];
        reference[d] = at_end ? 1 : 0;
        Eigen::Matrix3d jacobian;
        const Vec3 start = point(element, reference, jacobian);
        const Vec3 outward = (at_end ? 1 : -1) * jacobian.col(d).normalized();
        int end = 0;
        for (const int direction : {da, db}) {
          for (int side = 0; side < 2; ++side) {
            if (reference[direction] == side) {
              end = std::max(end, wall.end[2 * direction + side]);
            }
          }
        }
        const WallNode w = onto_wall(*wall.surface, start, outward, end > 0 ? &plane_normals_[end - 1] : nullptr,
                                     wall.surface->radius(start));
        shift = w.converged ? Vec3(w.point - start) : Vec3::Zero();
      }
      for (int i = 0; i < m; ++i) {
        points[a * stride[da] + b * stride[db] + i * stride[d]] += (at_end ? at.t[d][i] : 1 - at.t[d][i]) * shift;
      }
    }
  }
}

Vec3 CoarseCells::point(int element, const Vec3& reference, Eigen::Matrix3d& jacobian) const {
  const int n = mesh_.order + 1;
  std::array<std::vector<double>, 3> value, slope;
  for (int d = 0; d < 3; ++d) {
    const double t[]{reference[d]};
    value[d] = lagrange_values(nodes_1d_, t);
    slope[d] = lagrange_derivatives(nodes_1d_, t);
  }
  const int* ids = &mesh_.elements[static_cast<std::size_t>(element) * n * n * n];
  Vec3 x = Vec3::Zero();
  jacobian.setZero();
  for (int k = 0; k < n; ++k) {
    for (int j = 0; j < n; ++j) {
      for (int i = 0; i < n; ++i) {
        const Vec3& node = mesh_.nodes[*ids++];
        x += value[0][i] * value[1][j] * value[2][k] * node;
        jacobian.col(0) += slope[0][i] * value[1][j] * value[2][k] * node;
        jacobian.col(1) += value[0][i] * slope[1][j] * value[2][k] * node;
        jacobian.col(2) += value[0][i] * value[1][j] * slope[2][k] * node;
      }
    }
  }
  return x;
}

}  // namespace vasohex
