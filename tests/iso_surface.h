#pragma once
/// \file Triangles of an implicit surface, for tests: open where the surface leaves the box.

#include <array>
#include <functional>
#include <map>
#include <utility>
#include <vector>

#include "vasohex/surface/tri_surface.h"

namespace vasohex {

/// The surface value = 0 of a function that is < 0 inside, by marching tetrahedra on n cells of size `step` from
/// `corner`. Oriented outward; points are shared.
inline TriSurface iso_surface(const std::function<double(const Vec3&)>& value, const Vec3& corner, double step,
                              const std::array<int, 3>& n) {
  const auto index = [&](int i, int j, int k) { return i + (n[0] + 1) * (j + (n[1] + 1) * k); };
  std::vector<Vec3> grid;
  std::vector<double> values;
  for (int k = 0; k <= n[2]; ++k) {
    for (int j = 0; j <= n[1]; ++j) {
      for (int i = 0; i <= n[0]; ++i) {
        grid.push_back(corner + step * Vec3(i, j, k));
        values.push_back(value(grid.back()));
      }
    }
  }
  TriSurface surface;
  std::map<std::pair<int, int>, int> number;
  const auto crossing = [&](int a, int b) {  // of the edge from a, inside, to b
    const auto [entry, is_new] = number.emplace(std::minmax(a, b), static_cast<int>(surface.points.size()));
    if (is_new) {
      const double s = values[a] / (values[a] - values[b]);
      surface.points.push_back(grid[a] + s * (grid[b] - grid[a]));
    }
    return entry->second;
  };
  const auto add = [&](int a, int b, int c, const Vec3& outward) {
    const Vec3 normal = (surface.points[b] - surface.points[a]).cross(surface.points[c] - surface.points[a]);
    normal.dot(outward) > 0 ? surface.triangles.push_back({a, b, c}) : surface.triangles.push_back({a, c, b});
  };
  // the six tetrahedra around the diagonal of a cell
  constexpr std::array<std::array<int, 3>, 6> kOrders{
      {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}}};
  for (int k = 0; k < n[2]; ++k) {
    for (int j = 0; j < n[1]; ++j) {
      for (int i = 0; i < n[0]; ++i) {
        for (const auto& order : kOrders) {
          std::array<int, 3> at{i, j, k};
          std::vector<int> inside, outside;
          for (int corner_of = 0; corner_of < 4; ++corner_of) {
            const int v = index(at[0], at[1], at[2]);
            (values[v] < 0 ? inside : outside).push_back(v);
            if (corner_of < 3) {
              ++at[order[corner_of]];
            }
          }
          if (inside.empty() || outside.empty()) {
            continue;
          }
          Vec3 outward = Vec3::Zero();
          for (const int a : inside) {
            for (const int b : outside) {
              outward += grid[b] - grid[a];
            }
          }
          if (inside.size() == 2) {
            const int p = crossing(inside[0], outside[0]), q = crossing(inside[0], outside[1]);
            const int r = crossing(inside[1], outside[1]), s = crossing(inside[1], outside[0]);
            add(p, q, r, outward);
            add(p, r, s, outward);
          } else if (inside.size() == 1) {
            add(crossing(inside[0], outside[0]), crossing(inside[0], outside[1]), crossing(inside[0], outside[2]),
                outward);
          } else {
            add(crossing(inside[0], outside[0]), crossing(inside[1], outside[0]), crossing(inside[2], outside[0]),
                outward);
          }
        }
      }
    }
  }
  return surface;
}

}  // namespace vasohex
