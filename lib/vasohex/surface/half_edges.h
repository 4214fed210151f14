#pragma once
/// \file Which triangles are neighbours. Half-edge 3 t + k of triangle t runs from its corner k to its corner k + 1.

#include <array>
#include <vector>

#include "vasohex/surface/tri_surface.h"

namespace vasohex {

/// The next half-edge around its triangle.
inline int next_half_edge(int h) { return h % 3 == 2 ? h - 2 : h + 1; }

/// The point where half-edge h starts.
inline int start_point(const TriSurface& surface, int h) { return surface.triangles[h / 3][h % 3]; }
inline int end_point(const TriSurface& surface, int h) { return start_point(surface, next_half_edge(h)); }

/// Normal of a triangle, its length twice the area.
inline Vec3 area_normal(const TriSurface& surface, int triangle) {
  const auto& [a, b, c] = surface.triangles[triangle];
  return (surface.points[b] - surface.points[a]).cross(surface.points[c] - surface.points[a]);
}

/// The other half-edge of each one's edge [3m]; -1 where there is none. At an edge of more than two triangles those
/// are paired that continue each other straightest; `crowded` receives one half-edge of each such edge, if it is
/// given. The two half-edges of a pair run against each other only if the triangles are oriented alike.
std::vector<int> pair_half_edges(const TriSurface& surface, std::vector<int>* crowded = nullptr);

/// The rims of oriented triangles, one loop of half-edges without a pair each.
std::vector<std::vector<int>> rim_loops(const std::vector<int>& opposite);

/// Component of each triangle [m], from 0 in the order of the triangles; neighbours are in one.
std::vector<int> triangle_components(const std::vector<int>& opposite);

}  // namespace vasohex
