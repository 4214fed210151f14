#include "dealii/mesh_info.h"

#include <cmath>
#include <numbers>

#include "vasohex/core/error.h"
#include "vasohex/core/node_family.h"
#include "vasohex/core/reference_hex.h"

namespace vasohex {
namespace {

BoundaryRole role_of(const std::string& name) {
  if (name == "wall") {
    return BoundaryRole::wall;
  }
  return name.starts_with("inlet") ? BoundaryRole::inlet : BoundaryRole::outlet;
}

/// Gauss-Lobatto quadrature with order + 1 points on [0,1]: the weights are the integrals of the Lagrange
/// polynomials, w = 1 / (q (q + 1) P_q(x)^2).
std::vector<double> lobatto_weights(const std::vector<double>& nodes) {
  const int q = static_cast<int>(nodes.size()) - 1;
  std::vector<double> weights;
  for (const double node : nodes) {
    const double x = 2 * node - 1;
    double before = 1, value = x;
    for (int k = 2; k <= q; ++k) {
      const double next = ((2 * k - 1) * x * value - (k - 1) * before) / k;
      before = value;
      value = next;
    }
    weights.push_back(1 / (q * (q + 1.0) * value * value));
  }
  return weights;
}

}  // namespace

const BoundaryInfo& MeshInfo::boundary(const std::string& name) const {
  std::string names;
  for (const BoundaryInfo& b : boundaries) {
    if (b.name == name) {
      return b;
    }
    names += (names.empty() ? "" : ", ") + b.name;
  }
  throw Error(ErrorCode::bad_input, "there is no boundary '" + name + "'; there are " + names);
}

MeshInfo mesh_info(const HexMesh& mesh) {
  MeshInfo info;
  for (std::size_t s = 0; s < mesh.surfaces.size(); ++s) {
    BoundaryInfo b;
    b.id = static_cast<unsigned int>(s) + 1;
    b.name = mesh.surfaces[s];
    b.role = role_of(b.name);
    info.boundaries.push_back(b);
  }
  info.material_id = static_cast<unsigned int>(mesh.surfaces.size()) + 1;
  info.volume = mesh.volume;
  info.units = mesh.units;

  const int n = mesh.order + 1, m = mesh.order + 4;
  const std::vector<double> at = family_nodes(NodeFamily::gauss_lobatto, m - 1), weights = lobatto_weights(at);
  const std::vector<double> nodes = family_nodes(mesh.family, mesh.order);
  const std::vector<double> value = lagrange_values(nodes, at), slope = lagrange_derivatives(nodes, at);
  std::vector<Vec3> normals(info.boundaries.size(), Vec3::Zero());
  for (const HexMesh::BoundaryFace& face : mesh.boundary) {
    const int* ids = &mesh.elements[static_cast<std::size_t>(face.element) * mesh.nodes_per_element()];
    BoundaryInfo& b = info.boundaries[face.surface];
    for (int q = 0; q < m; ++q) {
      for (int p = 0; p < m; ++p) {
        Vec3 x = Vec3::Zero(), along_a = Vec3::Zero(), along_b = Vec3::Zero();
        for (int j = 0; j < n; ++j) {
          for (int i = 0; i < n; ++i) {
            const Vec3& node = mesh.nodes[ids[hex_face_point(face.face, i, j, {n, n, n})]];
            x += value[p * n + i] * value[q * n + j] * node;
            along_a += slope[p * n + i] * value[q * n + j] * node;
            along_b += value[p * n + i] * slope[q * n + j] * node;
          }
        }
        const Vec3 normal = weights[p] * weights[q] * along_a.cross(along_b);
        b.area += normal.norm();
        b.centre += normal.norm() * x;
        normals[face.surface] += normal;
      }
    }
  }
  for (std::size_t s = 0; s < info.boundaries.size(); ++s) {
    BoundaryInfo& b = info.boundaries[s];
    if (b.area > 0) {
      b.centre /= b.area;
    }
    if (b.role != BoundaryRole::wall) {
      b.normal = normals[s].normalized();
      b.radius = std::sqrt(b.area / std::numbers::pi);
    }
  }
  return info;
}

}  // namespace vasohex
