#pragma once
/// \file Sections of a closed surface by planes.

#include <span>
#include <vector>

#include "vasohex/core/vec3.h"
#include "vasohex/skeleton/closed_lumen.h"

namespace vasohex {

/// One closed line of a section: a polygon that turns counter-clockwise around the normal of the plane.
struct SectionLoop {
  std::vector<Vec3> points;
  std::vector<int> nearest;  ///< [points] the point of the surface next to each
};

/// The loops of the plane through `origin` with unit `normal` that cross one of the half-edges `through`.
std::vector<SectionLoop> plane_section(const ClosedLumen& lumen, const Vec3& origin, const Vec3& normal,
                                       std::span<const int> through);

}  // namespace vasohex
