#pragma once
/// \file The radius of the vessel around a point.

#include "vasohex/skeleton/network.h"
#include "vasohex/surface/cone_tree.h"

namespace vasohex {

class LocalRadius {
 public:
  /// Throws Error (bad_input) if the network has no branch of two points with radii > 0.
  explicit LocalRadius(const Network& network);

  /// Radius at the point of all axes with the least distance / radius from x.
  double at(const Vec3& x) const { return tree_.nearest(x).radius; }

 private:
  ConeTree tree_;
};

}  // namespace vasohex
