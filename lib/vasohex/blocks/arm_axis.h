#pragma once
/// \file The way of a branch out of a junction as a polyline with radii: where two part, cross-sections along one.

#include <vector>

#include "vasohex/blocks/cross_section.h"
#include "vasohex/core/vec3.h"

namespace vasohex {

/// Points at most about a quarter of a radius apart, with the radius at each. [n >= 2]
struct ArmAxis {
  std::vector<Vec3> points;
  std::vector<double> radii;
};

/// Position and radius at length `s` along the polyline, clamped to its ends.
struct ArmPoint {
  Vec3 position = Vec3::Zero();
  double radius = 0;
};
ArmPoint arm_point(const ArmAxis& axis, double s);
double length_of(const ArmAxis& axis);

/// From the other end.
ArmAxis reversed(ArmAxis axis);

/// Between places side by side [n >= 1], nearer to the wider ones: where the tubes together have their middle. The
/// largest radius.
ArmPoint middle_of(const std::vector<ArmPoint>& places);

/// Length along both from their common start up to which their tubes overlap; at most the length of the shorter.
double parting_length(const ArmAxis& a, const ArmAxis& b);

/// Frames normal to the axis at each of its points, which do not turn about it.
std::vector<SectionFrame> transported_frames(const ArmAxis& axis);

/// Where layers of blocks meet between a cube at the start (and one at the end, if so): points of the axis, ascending;
/// none where one layer does. Layers are about as long as the lumen is wide, which is twice `widths` [points of the
/// axis], and shorter in bends.
std::vector<int> layer_places(const ArmAxis& axis, const std::vector<double>& widths, bool cube_at_end);

}  // namespace vasohex
