#pragma once
/// \file Points onto an implicit surface: along the gradient, along a ray.

#include <optional>

#include "vasohex/surface/implicit_surface.h"

namespace vasohex {

struct Projection {
  Vec3 point = Vec3::Zero();
  Vec3 normal = Vec3::UnitZ();  ///< unit, outward, at `point`
  bool converged = false;
};

/// Newton along the gradient from x, never further than `trust` (a length; 0: half the local radius) per step. A step
/// that does not bring |value| / |gradient| down is halved. Converged when that first-order distance to the surface
/// is below `tolerance` times the radius at x; otherwise (a critical point, 50 steps) `point` is the best one met. It
/// finds a near sheet of the surface, not always the nearest: start within the trust region of the one meant.
Projection project(const ImplicitSurface& surface, const Vec3& x, double trust = 0, double tolerance = 1e-10);

/// The first point of the ray origin + t * direction (t >= 0, direction unit) on the surface, for an origin inside:
/// t to 1e-12 of `length_scale`. Nothing when the origin is not inside or no crossing lies before `t_max`.
/// `length_scale` (> 0, about the local radius) bounds the steps: .8 |value| / |gradient|, at most .5 and at least
/// .05 of it, so no gap thicker than a tenth of it is stepped over as long as value / gradient is about the distance.
std::optional<double> shoot(const ImplicitSurface& surface, const Vec3& origin, const Vec3& direction,
                            double length_scale, double t_max);

}  // namespace vasohex
