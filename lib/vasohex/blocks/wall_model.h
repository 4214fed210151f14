#pragma once
/// \file The surface as the optimisation of blocks sees it: looked at seldom, a polynomial between.

#include <array>
#include <vector>

#include "vasohex/surface/implicit_surface.h"

namespace vasohex {

/// Value and gradient of a surface for points that wander a little at a time. Each has an anchor, the place where the
/// surface was last looked at for it; within `reach` of it the surface is its Taylor polynomial of second order (its
/// second derivative along the normal taken as 0, that of a distance), whose error is about reach^3 / (6 radius^2).
class WallModel {
 public:
  WallModel(const ImplicitSurface& surface, std::size_t points) : surface_(&surface), anchors_(points) {}

  /// How far a point may be from its anchor.
  void set_reach(double reach) { reach_ = reach; }
  /// Looks at the surface again wherever it is asked for.
  void forget();
  double value(std::size_t point, const Vec3& x, Vec3& gradient);

  /// The same where the wall is known to face the unit vector `outward` (zero: not known). A point beyond the middle
  /// of the gap to another vessel sees that one's wall: its value then is the way back against `outward`.
  double value_facing(std::size_t point, const Vec3& x, const Vec3& outward, Vec3& gradient);

 private:
  enum class Known : char { nothing, gradient, curvature };
  struct Anchor {
    Known known = Known::nothing;
    Vec3 at = Vec3::Zero();
    double value = 0;
    Vec3 gradient = Vec3::Zero();
    Eigen::Matrix3d hessian;
  };
  Eigen::Matrix3d hessian(const Anchor& anchor) const;

  const ImplicitSurface* surface_;
  std::vector<Anchor> anchors_;
  double reach_ = 0;
};

}  // namespace vasohex
