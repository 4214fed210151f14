#pragma once
/// \file A lumen as the set of points where a function is negative.

#include <memory>
#include <vector>

#include "vasohex/core/vec3.h"

namespace vasohex {

/// A part of a vessel of the network, by arc lengths along the branch.
struct Stretch {
  int branch = 0;
  double from = 0, to = 0;
};

/// Const and thread-safe. Lengths are in the unit of the points given.
class ImplicitSurface {
 public:
  virtual ~ImplicitSurface() = default;

  /// Value at x: < 0 inside, 0 on the surface, > 0 outside. Near the surface |value| / |gradient| is the distance.
  virtual double value(const Vec3& x) const = 0;

  /// The same value; `gradient` receives its gradient, which points outward.
  virtual double value(const Vec3& x, Vec3& gradient) const = 0;

  /// Radius of the vessel around x: the length that tolerances and trust regions relate to. > 0.
  virtual double radius(const Vec3& x) const = 0;

  /// Whether a cross-section away from junctions is a circle of the network's radius.
  virtual bool is_round() const { return false; }

  /// The same surface around these stretches, without the vessels that only pass there: what a mesh of the stretches
  /// must follow where vessels touch or overlap. Dear; the whole surface if it does not know vessels. Must not outlive
  /// this surface.
  virtual std::shared_ptr<const ImplicitSurface> part(const std::vector<Stretch>&) const {
    return {std::shared_ptr<const void>(), this};
  }
};

}  // namespace vasohex
