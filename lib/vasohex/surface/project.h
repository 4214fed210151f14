#pragma once
/// \file Points onto an implicit surface: along the gradient, along a ray, within a plane.

#include <optional>

#include "vasohex/surface/implicit_surface.h"

namespace vasohex {

struct Projection {
  Vec3 point = Vec3::Zero();
  Vec3 normal = Vec3::UnitZ();  ///< unit, outward, at `point`
  bool converged = false;
};

/// Newton along the gradient from x, never further than `trust` (a length; 0: half the local radius) per step.
/// Converged when the distance to the surface is below `tolerance` times the local radius.
Projection project(const ImplicitSurface& surface, const Vec3& x, double trust = 0, double tolerance = 1e-10);

/// The first point of the ray origin + t * direction (t >= 0, direction unit) on the surface, for an origin inside.
/// `length_scale` (> 0, about the local radius) bounds the steps; nothing when no crossing lies before `t_max`.
std::optional<double> shoot(const ImplicitSurface& surface, const Vec3& origin, const Vec3& direction,
                            double length_scale, double t_max);

}  // namespace vasohex
