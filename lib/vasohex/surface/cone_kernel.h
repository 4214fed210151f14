#pragma once
/// \file The convolution of one cone: a segment whose radius is linear along it, with a compact kernel.
///
/// F(x) = scale * (1 - k . (x - start)) * integral of v^3 dt / r(t) over the segment,
///         v = 1 - |x - c(t)|^2 / (S r(t))^2 where positive,
/// else 0. A kernel that scales with r, of power 3 and of reach S = 1.5 radii: C2 across joints of segments, and
/// exactly zero beyond S r. Scaled such that an infinite cone has F = 1 on its surface |x - c(t)| = r(t) in the plane
/// normal to the axis. The factor with the curvature k: on the inner side of a bend the kernel sees more axis than on
/// the outer one, and would shift and flatten the section. Compact polynomial kernels of skeletons: Zanni et al.,
/// "SCALe-invariant Integral Surfaces" (2013).

#include "vasohex/core/vec3.h"

namespace vasohex {

/// Reach of the kernel in radii.
inline constexpr double kernel_reach = 1.5;
/// Power to which F falls with v on a straight tube: k + 1/2.
inline constexpr double kernel_power = 3.5;

/// Within how many radii a vessel fades beyond its free end.
inline constexpr double end_fade_radii = 0.25;
/// The share of the true curvature that makes bends rounder than any other once calibrated: torus of bend radius 1.5
/// r 1.5 % off at worst without it, .3 % with it; bend radius 3 r .28 % and .03 %.
inline constexpr double bend_correction = 0.75;

/// A cone that is part of a vessel. Its length should not exceed half its radius: 4 Gauss points are then exact for
/// slope 0 and 3e-6 off at slope .5.
struct ConeSegment {
  Vec3 start = Vec3::Zero();
  Vec3 direction = Vec3::UnitZ();  ///< unit
  double length = 0;               ///< > 0
  double radius = 0;               ///< at the start, > 0
  double slope = 0;                ///< radius(t) = radius + slope * t, > 0 on [0, length]
  Vec3 curvature = Vec3::Zero();   ///< of the vessel here, times bend_correction, across the direction; * S r < 1
  double scale = 0;                ///< as cone_scale(slope), with the constants of the kernel
  int piece = 0;                   ///< of the network (blending.h)
  /// Beyond the plane normal . x = offset of a free end F fades to 0 within `fade` (a quintic step), so that what
  /// stands in for the vessel behind its end does not reach its neighbours. 0: no end near.
  Vec3 end_normal = Vec3::Zero();
  double end_offset = 0;
  double end_fade = 0;  ///< end_fade_radii times the radius at the end
};

/// The factor in front of the integral of a segment of slope `slope`: smooth and even in the slope. Slopes beyond .6
/// (the cone's reach becomes infinite at 1 / S) are scaled like .6.
double cone_scale(double slope);

/// A segment between two points that differ, with the radii there (> 0).
ConeSegment cone_segment(const Vec3& start, double start_radius, const Vec3& end, double end_radius, int piece);

/// The point of a segment with the least distance / radius from x, for an x where F = 0.
struct ConeNearest {
  Vec3 point = Vec3::Zero();
  double radius = 0;
  double ratio = 0;  ///< |x - point| / radius; where the segment has faded at least S + radii beyond the fading
  Vec3 gradient = Vec3::Zero();  ///< of the ratio
};
ConeNearest cone_nearest(const ConeSegment& segment, const Vec3& x);

}  // namespace vasohex
