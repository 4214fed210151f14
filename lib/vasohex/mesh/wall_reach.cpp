#include "vasohex/mesh/wall_reach.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "vasohex/core/disjoint_sets.h"
#include "vasohex/core/parallel.h"
#include "vasohex/core/reference_hex.h"
#include "vasohex/skeleton/point_tree.h"
#include "vasohex/surface/project.h"
#include "vasohex/surface/triangle_tree.h"

namespace vasohex {
namespace {

constexpr double kSpacing = 0.3;    // of points on triangles, in radii
constexpr int kMostPieces = 64;     // of a triangle's edge
constexpr double kOnePlace = 0.5;   // radii between points of one place
constexpr double kEndReach = 3;     // radii of an end around its centre
constexpr double kAtEnd = 0.02;     // radii inside an end's plane that still count as beyond it: its rim

/// The quadrilaterals between neighbouring nodes of the wall's faces, as two triangles each.
TriSurface wall_of(const HexMesh& mesh) {
  TriSurface wall;
  wall.points = mesh.nodes;
  const int n = mesh.order + 1;
  for (const HexMesh::BoundaryFace& face : mesh.boundary) {
    if (face.surface != 0) {
      continue;
    }
    const int* ids = &mesh.elements[static_cast<std::size_t>(face.element) * mesh.nodes_per_element()];
    const auto node = [&](int a, int b) { return ids[hex_face_point(face.face, a, b, {n, n, n})]; };
    for (int b = 0; b < mesh.order; ++b) {
      for (int a = 0; a < mesh.order; ++a) {
        wall.triangles.push_back({node(a, b), node(a + 1, b), node(a + 1, b + 1)});
        wall.triangles.push_back({node(a, b), node(a + 1, b + 1), node(a, b + 1)});
      }
    }
  }
  return wall;
}

bool beyond_an_end(const Vec3& x, const std::vector<SurfaceEnd>& ends) {
  return std::any_of(ends.begin(), ends.end(), [&](const SurfaceEnd& e) {
    const Vec3 away = x - e.centre;
    return away.dot(e.normal) > -kAtEnd * e.radius && away.norm() < kEndReach * e.radius;
  });
}

}  // namespace

std::vector<Vec3> points_on(const TriSurface& triangles, const ImplicitSurface& surface) {
  std::vector<Vec3> points;
  for (const auto& [i, j, k] : triangles.triangles) {
    const Vec3 &a = triangles.points[i], &b = triangles.points[j], &c = triangles.points[k];
    const double longest = std::sqrt(std::max({(b - a).squaredNorm(), (c - b).squaredNorm(), (a - c).squaredNorm()}));
    const double spacing = kSpacing * surface.radius((a + b + c) / 3);
    const int n = static_cast<int>(std::clamp(std::ceil(longest / spacing), 1.0, 1.0 * kMostPieces));
    for (int u = 0; u < n; ++u) {  // the middles of the pieces that lie as the triangle does
      for (int v = 0; u + v < n; ++v) {
        points.push_back(a + (u + 1.0 / 3) / n * (b - a) + (v + 1.0 / 3) / n * (c - a));
      }
    }
  }
  return points;
}

std::vector<Vec3> points_on(const LabelVolume& volume, const ImplicitSurface& surface) {
  std::vector<Vec3> points;
  for (std::size_t i = 0; i < volume.inside.size(); ++i) {
    const std::array<int, 3> v = volume.voxel(i);
    for (int d = 0; d < 3; ++d) {
      if (v[d] + 1 == volume.size[d]) {
        continue;
      }
      std::array<int, 3> w = v;
      ++w[d];
      const std::size_t next = volume.index(w[0], w[1], w[2]);
      if (volume.inside[i] == volume.inside[next]) {
        continue;
      }
      const Vec3 between = (volume.centre(i) + volume.centre(next)) / 2;
      const Projection on_wall = project(surface, between, 0.5 * volume.spacing.minCoeff(), 1e-3);
      if (on_wall.converged && (on_wall.point - between).norm() < volume.spacing.maxCoeff()) {
        points.push_back(on_wall.point);
      }
    }
  }
  return points;
}

WallReach measure_reach(const HexMesh& mesh, const std::vector<Vec3>& wall, const std::vector<SurfaceEnd>& ends,
                        const ImplicitSurface& surface, const Run& run) {
  WallReach reach;
  const TriangleTree tree(wall_of(mesh));
  std::vector<double> distance(wall.size(), -1), radius(wall.size(), 1);
  parallel_for(run, wall.size(), 256, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      if (!beyond_an_end(wall[i], ends)) {
        radius[i] = surface.radius(wall[i]);
        distance[i] = std::sqrt(tree.closest(wall[i]).distance2);
      }
    }
  });
  std::vector<double> counted;
  std::vector<int> far;
  for (std::size_t i = 0; i < wall.size(); ++i) {
    if (distance[i] >= 0) {
      counted.push_back(distance[i] / radius[i]);
      reach.mean += counted.back();
      if (counted.back() > kReached) {
        far.push_back(static_cast<int>(i));
      }
    }
  }
  if (counted.empty()) {
    return reach;
  }
  reach.points = static_cast<int>(counted.size());
  reach.mean /= reach.points;
  reach.max = *std::max_element(counted.begin(), counted.end());
  const auto rank = counted.begin() + static_cast<std::ptrdiff_t>(0.99 * (reach.points - 1));
  std::nth_element(counted.begin(), rank, counted.end());
  reach.p99 = *rank;

  std::vector<Vec3> places;
  for (const int i : far) {
    places.push_back(wall[i]);
  }
  DisjointSets sets(static_cast<int>(far.size()));
  const PointTree near(places);
  for (std::size_t i = 0; i < far.size(); ++i) {
    near.within(places[i], kOnePlace * radius[far[i]], [&](int j) { sets.join(static_cast<int>(i), j); });
  }
  std::map<int, WallReach::Place> by_set;
  for (std::size_t i = 0; i < far.size(); ++i) {
    WallReach::Place& place = by_set[sets.find(static_cast<int>(i))];
    const double radii = distance[far[i]] / radius[far[i]];
    place.share += 1.0 / reach.points;
    if (radii > place.radii) {
      place.at = places[i];
      place.distance = distance[far[i]];
      place.radii = radii;
    }
  }
  for (const auto& [set, place] : by_set) {
    reach.unreached.push_back(place);
  }
  std::stable_sort(reach.unreached.begin(), reach.unreached.end(),
                   [](const WallReach::Place& a, const WallReach::Place& b) { return a.radii > b.radii; });
  return reach;
}

}  // namespace vasohex
