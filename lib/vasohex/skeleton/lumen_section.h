#pragma once
/// \file Cross-sections of a lumen given as a level set, and its middle line.

#include <optional>
#include <vector>

#include "vasohex/core/vec3.h"
#include "vasohex/surface/level_set.h"

namespace vasohex {

/// What a plane through a vessel shows, by rays from a point in it.
struct LumenSection {
  double radius = 0;            ///< of the disc with the same area
  double inscribed = 0;         ///< least distance to the wall in the plane
  Vec3 shift = Vec3::Zero();    ///< from the point to the middle of the section
  bool open = false;            ///< rays ran more than twice the inscribed radius without a wall: another vessel
};

/// The section in the plane through `x` with this unit normal; nothing if x is not inside. Rays end at `longest`, and
/// at twice the least distance to the wall, where they count as that of the median ray.
std::optional<LumenSection> measure_section(const LevelSet& level_set, const Vec3& x, const Vec3& normal,
                                            double longest);

/// A place near x, at most `longest` away, from which the level set does not fall further: on the middle line or, where
/// vessels meet, in the middle. Steps of `step`.
Vec3 deepest_near(const LevelSet& level_set, const Vec3& x, double step, double longest);

/// Radius of the ball around x in the lumen, by rays to all sides; 0 if x is not inside. At most `longest`.
double inscribed_radius(const LevelSet& level_set, const Vec3& x, double longest);

}  // namespace vasohex
