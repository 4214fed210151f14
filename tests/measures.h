#pragma once
/// \file Volume and surface of a mesh by quadrature of its polynomials.

#include <cmath>
#include <vector>

#include "vasohex/core/node_family.h"
#include "vasohex/core/reference_hex.h"
#include "vasohex/mesh/hex_mesh.h"

namespace vasohex::measures {

/// Weights of Gauss-Lobatto quadrature on [0,1]: w = 1 / (q (q + 1) P_q(x)^2).
inline std::vector<double> lobatto_weights(const std::vector<double>& at) {
  const int q = static_cast<int>(at.size()) - 1;
  std::vector<double> weight(q + 1);
  for (int i = 0; i <= q; ++i) {
    const double x = 2 * at[i] - 1;
    double before = 1, value = x;
    for (int k = 2; k <= q; ++k) {
      const double next = ((2 * k - 1) * x * value - (k - 1) * before) / k;
      before = value;
      value = next;
    }
    weight[i] = 1 / (q * (q + 1.0) * value * value);
  }
  return weight;
}

/// Exact volume of the curved elements by Gauss-Lobatto quadrature of det J, of degree 3p - 1.
inline double volume(const HexMesh& mesh) {
  const int p = mesh.order, n = p + 1;
  const int q = (3 * p) / 2 + 2;
  const std::vector<double> nodes = family_nodes(mesh.family, p);
  const std::vector<double> at = family_nodes(NodeFamily::gauss_lobatto, q);
  const std::vector<double> weight = lobatto_weights(at);
  const std::vector<double> v = lagrange_values(nodes, at), d = lagrange_derivatives(nodes, at);
  double sum = 0;
  const int m = q + 1;
  // along i, then j, then k: values and derivatives
  std::vector<Vec3> ai(n * n * m), di(n * n * m), aj(n * m * m), dj(n * m * m), ij(n * m * m);
  for (int e = 0; e < mesh.element_count(); ++e) {
    const int* ids = &mesh.elements[static_cast<std::size_t>(e) * n * n * n];
    for (int r = 0; r < n * n; ++r) {
      for (int a = 0; a < m; ++a) {
        ai[r * m + a] = di[r * m + a] = Vec3::Zero();
        for (int i = 0; i < n; ++i) {
          ai[r * m + a] += v[a * n + i] * mesh.nodes[ids[i + n * r]];
          di[r * m + a] += d[a * n + i] * mesh.nodes[ids[i + n * r]];
        }
      }
    }
    for (int k = 0; k < n; ++k) {
      for (int b = 0; b < m; ++b) {
        for (int a = 0; a < m; ++a) {
          const int to = (k * m + b) * m + a;
          aj[to] = dj[to] = ij[to] = Vec3::Zero();
          for (int j = 0; j < n; ++j) {
            aj[to] += v[b * n + j] * ai[(k * n + j) * m + a];
            dj[to] += d[b * n + j] * ai[(k * n + j) * m + a];
            ij[to] += v[b * n + j] * di[(k * n + j) * m + a];
          }
        }
      }
    }
    for (int c = 0; c < m; ++c) {
      for (int ba = 0; ba < m * m; ++ba) {
        Vec3 x = Vec3::Zero(), y = Vec3::Zero(), z = Vec3::Zero();
        for (int k = 0; k < n; ++k) {
          x += v[c * n + k] * ij[k * m * m + ba];
          y += v[c * n + k] * dj[k * m * m + ba];
          z += d[c * n + k] * aj[k * m * m + ba];
        }
        sum += weight[ba % m] * weight[ba / m] * weight[c] * x.dot(y.cross(z));
      }
    }
  }
  return sum;
}

/// Areas of the named surfaces, by `points` Gauss-Lobatto points along each edge of a face.
inline std::vector<double> areas(const HexMesh& mesh, int points) {
  const int n = mesh.order + 1, m = points;
  const std::vector<double> at = family_nodes(NodeFamily::gauss_lobatto, m - 1), weight = lobatto_weights(at);
  const std::vector<double> nodes = family_nodes(mesh.family, mesh.order);
  const std::vector<double> v = lagrange_values(nodes, at), d = lagrange_derivatives(nodes, at);
  std::vector<double> sums(mesh.surfaces.size(), 0.0);
  for (const HexMesh::BoundaryFace& face : mesh.boundary) {
    const int* ids = &mesh.elements[static_cast<std::size_t>(face.element) * mesh.nodes_per_element()];
    for (int q = 0; q < m; ++q) {
      for (int p = 0; p < m; ++p) {
        Vec3 along_a = Vec3::Zero(), along_b = Vec3::Zero();
        for (int j = 0; j < n; ++j) {
          for (int i = 0; i < n; ++i) {
            const Vec3& node = mesh.nodes[ids[hex_face_point(face.face, i, j, {n, n, n})]];
            along_a += d[p * n + i] * v[q * n + j] * node;
            along_b += v[p * n + i] * d[q * n + j] * node;
          }
        }
        sums[face.surface] += weight[p] * weight[q] * along_a.cross(along_b).norm();
      }
    }
  }
  return sums;
}

}  // namespace vasohex::measures
