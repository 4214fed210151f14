#pragma once
/// \file The axis of a vessel as a row of places, while it is being moved.

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <vector>

#include "vasohex/core/vec3.h"

namespace vasohex {

/// A place on an axis; radius 0: no section counts there.
struct Station {
  Vec3 point = Vec3::Zero();
  double width = 0;
  double radius = 0;
};
using Path = std::vector<Station>;

/// The radius between two stations, u of the way; 0 if one of them does not count.
inline double radius_between(const Station& a, const Station& b, double u) {
  return a.radius > 0 && b.radius > 0 ? (1 - u) * a.radius + u * b.radius : 0;
}

/// Stations at equal steps of (length / local size), about `spacing` each; first and last stay.
template <class Size>
Path resample(const Path& path, double spacing, Size&& size) {
  std::vector<double> t{0};
  for (std::size_t i = 1; i < path.size(); ++i) {
    t.push_back(t.back() + (path[i].point - path[i - 1].point).norm() * 2 / (size(path[i]) + size(path[i - 1])));
  }
  const int pieces = std::max(1, static_cast<int>(std::lround(t.back() / spacing)));
  Path result{path.front()};
  std::size_t i = 1;
  for (int k = 1; k < pieces; ++k) {
    const double at = t.back() * k / pieces;
    while (i + 1 < path.size() && t[i] < at) {
      ++i;
    }
    const double u = t[i] > t[i - 1] ? std::clamp((at - t[i - 1]) / (t[i] - t[i - 1]), 0.0, 1.0) : 0.0;
    const Station &a = path[i - 1], &b = path[i];
    result.push_back({(1 - u) * a.point + u * b.point, (1 - u) * a.width + u * b.width, radius_between(a, b, u)});
  }
  result.push_back(path.back());
  return result;
}

/// Direction of a path at station i, seen over about a local width to both sides.
Vec3 direction_at(const Path& path, std::size_t i);

/// The stations with a section, seen from one of the ends of the path.
Path counted(const Path& path, bool from_back);

/// Stations between two, on a cubic Hermite curve, `spacing` local widths apart; directions unit. Neither end is
/// included.
void bridge(Path& path, const Station& a, const Vec3& da, const Station& b, const Vec3& db, double spacing);

/// The path from node to node through the stations that count, all if none does; in between it goes straight on, at
/// ends along `inward`. Stations `spacing` local widths apart.
Path joined(const Path& path, const Station& start, const std::optional<Vec3>& start_inward, const Station& goal,
            const std::optional<Vec3>& goal_inward, double spacing);

/// Radii where no section counts: between the nearest ones. `end_radii` those of the ends, 0: not known.
void fill_radii(Path& path, const std::array<double, 2>& end_radii);

/// Places along a path are numbers: the station before and the part of the way to the next one.
Station station_at(const Path& path, double place);
Vec3 tangent_at(const Path& path, double place);
/// From one place to another; negative if b is before a.
double length_along(const Path& path, double a, double b);
/// The place nearest to a point.
double foot_of(const Path& path, const Vec3& x);

}  // namespace vasohex
