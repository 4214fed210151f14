#include "vasohex/surface/refine_triangles.h"

#include <algorithm>
#include <optional>
#include <vector>

#include "vasohex/surface/cut_needles.h"
#include "vasohex/surface/half_edges.h"
#include "vasohex/surface/point_jets.h"
#include "vasohex/surface/triangle_surface.h"

namespace vasohex {
namespace {

/// Where a triangle is more than 20 degrees off the normal of the point: a normal there says nothing of the wall.
std::vector<char> sharp_points(const TriSurface& surface, const std::vector<Vec3>& normals) {
  std::vector<char> sharp(normals.size(), 0);
  for (int t = 0; t < static_cast<int>(surface.triangles.size()); ++t) {
    const Vec3 normal = area_normal(surface, t);
    for (const int p : surface.triangles[t]) {
      sharp[p] = sharp[p] || normal.dot(normals[p]) < 0.94 * normal.norm();
    }
  }
  return sharp;
}

/// Where the wall is in the middle of an edge.
class MiddleOfEdge {
 public:
  explicit MiddleOfEdge(const TriSurface& surface)
      : before_(surface),
        fits_(before_, angle_weighted_normals(before_)),
        sharp_(sharp_points(before_, fits_.normals())),
        known_(before_.points.size()) {}

  /// On the cubic that the normals of both ends make; in the middle of the straight edge if that is further away than
  /// `furthest`.
  Vec3 operator()(int a, int b, double furthest) {
    const Vec3 straight = 0.5 * (before_.points[a] + before_.points[b]);
    if (sharp_[a] || sharp_[b]) {
      return straight;
    }
    const Vec3 along = before_.points[b] - before_.points[a], na = normal(a), nb = normal(b);
    const Vec3 bulge = (along.dot(nb) * nb - along.dot(na) * na) / 8;
    return bulge.norm() < furthest ? Vec3(straight + bulge) : straight;
  }

 private:
  /// Of the jet: that of the triangles is not accurate enough.
  Vec3 normal(int p) {
    if (!known_[p]) {
      const Jet jet = fits_.fit(p, 2, space_);
      known_[p] = jet.degree >= 2 ? jet.normal() : fits_.normals()[p];
    }
    return *known_[p];
  }

  TriSurface before_;
  PointJets fits_;
  std::vector<char> sharp_;
  std::vector<std::optional<Vec3>> known_;
  PointJets::Space space_;
};

}  // namespace

void refine_triangles(TriSurface& surface, const std::function<double(const Vec3&)>& radius) {
  cut_needles(surface, radius);
  for (int round = 0; round < 6; ++round) {
    const std::vector<int> opposite = pair_half_edges(surface);
    const int count = static_cast<int>(opposite.size());
    std::vector<int> middle(count, -1);  // the new point of each half-edge
    std::optional<MiddleOfEdge> on_wall;
    for (int t = 0; t < count / 3; ++t) {
      std::array<double, 3> length{};
      for (int k = 0; k < 3; ++k) {
        length[k] =
            (surface.points[start_point(surface, 3 * t + k)] - surface.points[end_point(surface, 3 * t + k)]).norm();
      }
      const double shortest = *std::min_element(length.begin(), length.end());
      const double longest = *std::max_element(length.begin(), length.end());
      double r = -1;
      for (int k = 0; k < 3; ++k) {
        const int h = 3 * t + k;
        if (middle[h] >= 0) {
          continue;
        }
        r = r < 0 ? radius(surface.points[start_point(surface, h)]) : r;
        if (!(length[k] > 0.4 * r || (length[k] > 0.2 * r && length[k] > 2 * shortest && length[k] == longest))) {
          continue;
        }
        if (!on_wall) {
          on_wall.emplace(surface);
        }
        const Vec3 p = (*on_wall)(start_point(surface, h), end_point(surface, h), 0.1 * r);
        middle[h] = static_cast<int>(surface.points.size());
        if (opposite[h] >= 0) {
          middle[opposite[h]] = middle[h];
        }
        surface.points.push_back(p);
      }
    }
    if (!on_wall) {
      return;
    }
    for (int t = 0; t < count / 3; ++t) {
      const std::array<int, 3> p = surface.triangles[t];
      const std::array<int, 3> m{middle[3 * t], middle[3 * t + 1], middle[3 * t + 2]};
      const auto cut = std::count_if(m.begin(), m.end(), [](int i) { return i >= 0; });
      const auto add = [&](int a, int b, int c) { surface.triangles.push_back({a, b, c}); };
      if (cut == 3) {
        surface.triangles[t] = m;
        for (int k = 0; k < 3; ++k) {
          add(p[k], m[k], m[(k + 2) % 3]);
        }
      } else if (cut == 2) {
        const int k = m[0] < 0 ? 0 : m[1] < 0 ? 1 : 2;  // the edge that stays, from a to b
        const int a = p[k], b = p[(k + 1) % 3], c = p[(k + 2) % 3], mb = m[(k + 1) % 3], ma = m[(k + 2) % 3];
        surface.triangles[t] = {ma, mb, c};
        const double along_a = (surface.points[a] - surface.points[mb]).squaredNorm();
        const double along_b = (surface.points[b] - surface.points[ma]).squaredNorm();
        if (along_a < along_b) {
          add(a, b, mb);
          add(a, mb, ma);
        } else {
          add(a, b, ma);
          add(b, mb, ma);
        }
      } else if (cut == 1) {
        const int k = m[0] >= 0 ? 0 : m[1] >= 0 ? 1 : 2;
        surface.triangles[t] = {p[k], m[k], p[(k + 2) % 3]};
        add(m[k], p[(k + 1) % 3], p[(k + 2) % 3]);
      }
    }
  }
}

}  // namespace vasohex
