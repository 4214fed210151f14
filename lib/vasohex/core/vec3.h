#pragma once
/// \file Points, directions and boxes in space. Lengths are in the unit of the caller's data.

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

namespace vasohex {

using Vec3 = Eigen::Vector3d;

/// In [0, pi]; of any lengths > 0, exact for small angles too.
inline double angle_between(const Vec3& a, const Vec3& b) { return std::atan2(a.cross(b).norm(), a.dot(b)); }

/// Where on the segment from a to b the point nearest to x is: 0 at a, 1 at b. 0 of a segment without length.
inline double nearest_on_segment(const Vec3& x, const Vec3& a, const Vec3& b) {
  const Vec3 along = b - a;
  return std::clamp((x - a).dot(along) / std::max(along.squaredNorm(), 1e-300), 0.0, 1.0);
}

/// From x to the nearest point of the segment.
inline double distance_to_segment(const Vec3& x, const Vec3& a, const Vec3& b) {
  return (a + nearest_on_segment(x, a, b) * (b - a) - x).norm();
}

/// Axis-parallel box; empty until the first point is added.
struct Box {
  Vec3 min = Vec3::Constant(std::numeric_limits<double>::infinity());
  Vec3 max = Vec3::Constant(-std::numeric_limits<double>::infinity());

  void add(const Vec3& p) {
    min = min.cwiseMin(p);
    max = max.cwiseMax(p);
  }
  bool empty() const { return !(min.array() <= max.array()).all(); }
};

}  // namespace vasohex
