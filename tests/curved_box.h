#pragma once
/// \file A box of curved hexahedra whose shape is a known polynomial without symmetry, so that every exchange of two
/// nodes shows. tests/vtu_oracle.py has the same map.

#include <array>
#include <cmath>
#include <vector>

#include "vasohex/core/reference_hex.h"
#include "vasohex/mesh/hex_mesh.h"

namespace vasohex {

/// Of degree p per direction at most, so elements of order p reproduce it.
inline Vec3 curved_box_point(int p, const Vec3& t) {
  const double u = t[0], v = t[1], w = t[2];
  return {2 * u + 0.3 * std::pow(v, p) * w, v + 0.2 * std::pow(w, p) * u + 0.1 * std::pow(u, p),
          1.5 * w + 0.25 * u * std::pow(v, p)};
}

/// cells[d] hexahedra per direction, i fastest; surface d for both faces across direction d.
inline HexMesh curved_box(int p, const std::array<int, 3>& cells, NodeFamily family = NodeFamily::equispaced) {
  HexMesh mesh;
  mesh.order = p;
  mesh.family = family;
  mesh.surfaces = {"wall", "inlet", "outlet_1"};
  mesh.units = "mm";
  const std::vector<double> nodes = family_nodes(family, p);
  const std::array<int, 3> lattice{p * cells[0] + 1, p * cells[1] + 1, p * cells[2] + 1};
  const auto at = [&](int d, int i) { return i == p * cells[d] ? 1.0 : (i / p + nodes[i % p]) / cells[d]; };
  for (int k = 0; k < lattice[2]; ++k) {
    for (int j = 0; j < lattice[1]; ++j) {
      for (int i = 0; i < lattice[0]; ++i) {
        mesh.nodes.push_back(curved_box_point(p, {at(0, i), at(1, j), at(2, k)}));
      }
    }
  }
  std::array<int, 3> c{};
  for (c[2] = 0; c[2] < cells[2]; ++c[2]) {
    for (c[1] = 0; c[1] < cells[1]; ++c[1]) {
      for (c[0] = 0; c[0] < cells[0]; ++c[0]) {
        const int e = static_cast<int>(mesh.element_block.size());
        for (int k = 0; k <= p; ++k) {
          for (int j = 0; j <= p; ++j) {
            for (int i = 0; i <= p; ++i) {
              mesh.elements.push_back(p * c[0] + i + lattice[0] * (p * c[1] + j + lattice[1] * (p * c[2] + k)));
            }
          }
        }
        mesh.element_block.push_back(10 + e);
        mesh.element_branch.push_back(-1 - e);
        for (int f = 0; f < 6; ++f) {
          if (c[f / 2] == (f % 2 == 1 ? cells[f / 2] - 1 : 0)) {
            mesh.boundary.push_back({e, f, f / 2});
          }
        }
      }
    }
  }
  return mesh;
}

}  // namespace vasohex
