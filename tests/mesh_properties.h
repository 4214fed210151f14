#pragma once
/// \file What every mesh must have, checked by brute force from the element lists alone.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <map>
#include <numeric>
#include <set>
#include <vector>

#include "vasohex/core/reference_hex.h"
#include "vasohex/mesh/hex_mesh.h"

namespace vasohex::properties {

struct Topology {
  int components = 0;
  int loops = 0;  ///< genus of the boundary, summed over its components
};

/// Nodes of a face, sorted, and its four corners.
inline std::vector<int> face_nodes(const HexMesh& mesh, int element, int face) {
  const int n = mesh.order + 1;
  std::vector<int> nodes;
  for (int b = 0; b < n; ++b) {
    for (int a = 0; a < n; ++a) {
      nodes.push_back(mesh.elements[static_cast<std::size_t>(element) * mesh.nodes_per_element() +
                                    hex_face_point(face, a, b, {n, n, n})]);
    }
  }
  return nodes;
}

/// Every face belongs to one element or, with the same nodes, to two; those of one element are exactly the boundary
/// list; every node is used; the boundary is a closed manifold.
inline Topology expect_conforming(const HexMesh& mesh) {
  const int p = mesh.order, elements = mesh.element_count();
  std::map<std::array<int, 4>, std::vector<std::pair<int, int>>> by_corners;
  const auto corners_of = [&](int e, int f) {
    const std::vector<int> nodes = face_nodes(mesh, e, f);
    return std::array<int, 4>{nodes[0], nodes[p], nodes[p * (p + 1)], nodes[p * (p + 1) + p]};
  };
  std::vector<int> leader(elements);
  std::iota(leader.begin(), leader.end(), 0);
  const auto find = [&](int e) {
    while (leader[e] != e) {
      e = leader[e] = leader[leader[e]];
    }
    return e;
  };
  for (int e = 0; e < elements; ++e) {
    for (int f = 0; f < 6; ++f) {
      auto key = corners_of(e, f);
      std::sort(key.begin(), key.end());
      EXPECT_TRUE(std::adjacent_find(key.begin(), key.end()) == key.end()) << "element " << e << " repeats a node";
      by_corners[key].push_back({e, f});
    }
  }
  std::set<std::pair<int, int>> single;
  int mismatched = 0;
  for (const auto& [key, uses] : by_corners) {
    EXPECT_LE(uses.size(), 2u);
    if (uses.size() == 1) {
      single.insert(uses[0]);
    } else {
      std::vector<int> a = face_nodes(mesh, uses[0].first, uses[0].second);
      std::vector<int> b = face_nodes(mesh, uses[1].first, uses[1].second);
      std::sort(a.begin(), a.end());
      std::sort(b.begin(), b.end());
      mismatched += a != b;
      leader[find(uses[0].first)] = find(uses[1].first);
    }
  }
  EXPECT_EQ(mismatched, 0);
  std::set<std::pair<int, int>> listed;
  for (const auto& face : mesh.boundary) {
    EXPECT_TRUE(listed.insert({face.element, face.face}).second) << "boundary face listed twice";
    EXPECT_GE(face.surface, 0);
    EXPECT_LT(face.surface, static_cast<int>(mesh.surfaces.size()));
  }
  EXPECT_EQ(listed, single);
  std::vector<char> used(mesh.nodes.size(), 0);
  for (const int node : mesh.elements) {
    used[node] = 1;
  }
  EXPECT_EQ(std::count(used.begin(), used.end(), 0), 0);

  Topology t;
  for (int e = 0; e < elements; ++e) {
    t.components += find(e) == e;
  }
  std::set<int> vertices;
  std::map<std::array<int, 2>, int> edges;
  for (const auto& [e, f] : single) {
    const auto c = corners_of(e, f);
    for (const auto& [a, b] : {std::pair(0, 1), std::pair(1, 3), std::pair(3, 2), std::pair(2, 0)}) {
      vertices.insert(c[a]);
      ++edges[{std::min(c[a], c[b]), std::max(c[a], c[b])}];
    }
  }
  for (const auto& [edge, count] : edges) {
    EXPECT_EQ(count, 2) << "boundary is not a manifold";
  }
  const int euler =
      static_cast<int>(vertices.size()) - static_cast<int>(edges.size()) + static_cast<int>(single.size());
  t.loops = t.components - euler / 2;
  return t;
}

/// Distance from the plane through `origin` of all nodes on the given surface.
inline double distance_from_plane(const HexMesh& mesh, int surface, const Vec3& origin, const Vec3& normal) {
  double most = 0;
  for (const auto& face : mesh.boundary) {
    if (face.surface == surface) {
      for (const int node : face_nodes(mesh, face.element, face.face)) {
        most = std::max(most, std::abs((mesh.nodes[node] - origin).dot(normal)));
      }
    }
  }
  return most;
}

}  // namespace vasohex::properties
