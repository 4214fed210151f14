#pragma once
/// \file Nearest points and points in a ball: a tree of boxes around points in space.

#include <functional>
#include <limits>
#include <vector>

#include "vasohex/core/vec3.h"

namespace vasohex {

/// Const and thread-safe; holds a copy of the points. Queries are O(log n) for points that spread evenly. The boxes
/// are tight: points of a surface leave most of space out, where balls inside it end.
class PointTree {
 public:
  explicit PointTree(const std::vector<Vec3>& points);

  /// Index of the point nearest to x, `skip` left out; -1 if there is none at a distance below `closer_than`.
  int nearest(const Vec3& x, int skip = -1, double closer_than = std::numeric_limits<double>::infinity()) const;

  /// Calls `found(index)` for every point with |point - x| <= radius, in an order that depends on the points alone.
  void within(const Vec3& x, double radius, const std::function<void(int)>& found) const;

 private:
  struct Node {
    Box box;
    int begin = 0, end = 0;  ///< of points_
    int second = 0;          ///< node of the second half, the first half's is the next one; 0: a leaf
  };

  std::vector<Vec3> points_;  ///< those of a node side by side
  std::vector<int> index_;    ///< [n] of a point, as it was given
  std::vector<Node> nodes_;   ///< the root first

  void build(const std::vector<Vec3>& points, int begin, int end);
};

}  // namespace vasohex
