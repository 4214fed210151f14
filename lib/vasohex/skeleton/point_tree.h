#pragma once
/// \file Nearest points and points in a ball: a k-d tree over points in space.

#include <functional>
#include <limits>
#include <vector>

#include "vasohex/core/vec3.h"

namespace vasohex {

/// Const and thread-safe; holds a copy of the points. Queries are O(log n) for points that spread evenly.
class PointTree {
 public:
  explicit PointTree(std::vector<Vec3> points);

  /// Index of the point nearest to x, `skip` left out; -1 if there is none at a distance below `closer_than`.
  int nearest(const Vec3& x, int skip = -1, double closer_than = std::numeric_limits<double>::infinity()) const;

  /// Calls `found(index)` for every point with |point - x| <= radius, in an order that depends on the points alone.
  void within(const Vec3& x, double radius, const std::function<void(int)>& found) const;

 private:
  std::vector<Vec3> points_;
  std::vector<int> order_;  ///< [n] indices of points: left half, median, right half, and so on
  std::vector<char> axis_;  ///< [n] of the median at this place of order_

  void build(int begin, int end);
};

}  // namespace vasohex
