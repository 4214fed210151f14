#pragma once
/// \file A lumen as triangles, and the ends where vessels are cut.

#include <array>
#include <string>
#include <vector>

#include "vasohex/core/vec3.h"

namespace vasohex {

/// Triangles turn counter-clockwise seen from outside the lumen.
struct TriSurface {
  std::vector<Vec3> points;                   ///< [n]
  std::vector<std::array<int, 3>> triangles;  ///< [m], indices of points
  std::string units;                          ///< `mm`, `cm`, `m`, `um`, or empty: not stated
};

/// Where a vessel is cut by a plane: an open rim of the triangles, or a flat cap that was there.
struct SurfaceEnd {
  Vec3 centre = Vec3::Zero();
  Vec3 normal = Vec3::UnitZ();  ///< unit, out of the lumen
  double radius = 0;            ///< of the disc of the same area
};

}  // namespace vasohex
