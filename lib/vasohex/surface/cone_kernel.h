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

#include <algorithm>
#include <cmath>

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

/// What a segment, or a sum of segments, contributes at a point.
struct ConeSum {
  double value = 0;              ///< F
  double weighted_radius = 0;    ///< the same integral with the integrand times r(t): / value = mean radius
  Vec3 gradient = Vec3::Zero();  ///< of F
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

/// Adds what `segment` contributes at x; false, and nothing added, when x is out of its reach. The gradient is
/// computed only when `with_gradient`.
template <bool with_gradient>
inline bool add_cone(const ConeSegment& segment, const Vec3& x, ConeSum& sum) {
  double present = 1, present_slope = 0;
  if (segment.end_fade > 0) {
    const double s = (segment.end_normal.dot(x) - segment.end_offset) / segment.end_fade;
    if (s >= 1) {
      return false;
    }
    if (s > 0) {
      present = 1 - s * s * s * (10 + s * (6 * s - 15));
      present_slope = -30 * s * s * (1 - s) * (1 - s) / segment.end_fade;
    }
  }
  constexpr double reach2 = kernel_reach * kernel_reach;
  const Vec3 w = x - segment.start;
  const double length = segment.length, slope = segment.slope, radius = segment.radius;
  const double p = w.dot(segment.direction);
  // v (S r)^2 = c0 + 2 c1 t + c2 t^2. Where it is positive with r > 0, |x - c(t)| - S r(t) < 0: convex in t, so one
  // interval, whatever the sign of c2.
  const double c0 = reach2 * radius * radius - w.squaredNorm();
  const double c1 = reach2 * radius * slope + p;
  const double c2 = reach2 * slope * slope - 1;
  const double at_end = c0 + (2 * c1 + c2 * length) * length;
  double from = 0, to = length;
  if (!(c0 > 0 && at_end > 0)) {
    if (!(c0 > 0 || at_end > 0) && !(c2 < 0 && c1 > 0 && c1 + c2 * length < 0)) {
      return false;
    }
    const double discriminant = c1 * c1 - c0 * c2;
    if (!(discriminant > 0)) {
      return false;
    }
    const double root = std::sqrt(discriminant);  // half the slope of the quadratic where it enters or leaves
    if (!(c0 > 0)) {
      from = c1 > 0 ? -c0 / (c1 + root) : (root - c1) / c2;
    }
    if (!(at_end > 0)) {
      to = c1 < 0 ? c0 / (root - c1) : -(c1 + root) / c2;
    }
    from = std::clamp(from, 0.0, length);
    to = std::clamp(to, 0.0, length);
    if (!(to > from)) {
      return false;
    }
  }
  // Gauss-Legendre on [0, 1]; exact for degree 7, which slope 0 needs 6 of. The mirrored points side by side, as
  // two-wide arithmetic has it.
  const Eigen::Array4d node(0.06943184420297371, 0.93056815579702629, 0.33000947820757187, 0.66999052179242813);
  const Eigen::Array4d weight(0.17392742256872693, 0.17392742256872693, 0.32607257743127307, 0.32607257743127307);
  const double h = to - from;
  const Eigen::Array4d t = from + h * node;
  const Eigen::Array4d inverse = (radius + slope * t).inverse();
  const Eigen::Array4d q = c0 + (2 * c1 + c2 * t) * t;
  const Eigen::Array4d a = weight * (q * inverse * inverse * inverse).square();  // / r: integrand of the gradient
  const Eigen::Array4d b = a * q;                                                // / r: that of F
  const double value = (b * inverse).sum(), mean = b.sum();
  const double bend = 1 - segment.curvature.dot(w);
  const double scale = segment.scale * h * bend * present;
  sum.value += scale * value;
  sum.weighted_radius += scale * mean;
  if constexpr (with_gradient) {
    const Eigen::Array4d c = a * inverse;
    const double all = c.sum(), along = (c * t).sum();
    sum.gradient -=
        6 * scale * (all * w - along * segment.direction) + (segment.scale * h * present * value) * segment.curvature;
    sum.gradient += (segment.scale * h * bend * present_slope * value) * segment.end_normal;
  }
  return true;
}

}  // namespace vasohex
