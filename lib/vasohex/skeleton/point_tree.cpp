#include "vasohex/skeleton/point_tree.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

namespace vasohex {

PointTree::PointTree(std::vector<Vec3> points)
    : points_(std::move(points)), order_(points_.size()), axis_(points_.size(), 0) {
  std::iota(order_.begin(), order_.end(), 0);
  build(0, static_cast<int>(points_.size()));
}

void PointTree::build(int begin, int end) {
  if (end - begin < 2) {
    return;
  }
  Box box;
  for (int i = begin; i < end; ++i) {
    box.add(points_[order_[i]]);
  }
  int axis = 0;
  (box.max - box.min).maxCoeff(&axis);
  const int middle = begin + (end - begin) / 2;
  std::nth_element(order_.begin() + begin, order_.begin() + middle, order_.begin() + end,
                   [&](int a, int b) { return std::pair(points_[a][axis], a) < std::pair(points_[b][axis], b); });
  axis_[middle] = static_cast<char>(axis);
  build(begin, middle);
  build(middle + 1, end);
}

int PointTree::nearest(const Vec3& x, int skip, double closer_than) const {
  int best = -1;
  double least = closer_than * closer_than;  // squared distance
  // `offset`: from x to the box of the range, at least, along each axis
  const auto descend = [&](const auto& self, int begin, int end, Vec3 offset) -> void {
    if (begin >= end || offset.squaredNorm() >= least) {
      return;
    }
    const int middle = begin + (end - begin) / 2;
    const int i = order_[middle], axis = axis_[middle];
    if (const double d = (points_[i] - x).squaredNorm(); d < least && i != skip) {
      least = d;
      best = i;
    }
    const double side = x[axis] - points_[i][axis];
    side < 0 ? self(self, begin, middle, offset) : self(self, middle + 1, end, offset);
    offset[axis] = std::max(offset[axis], std::abs(side));
    side < 0 ? self(self, middle + 1, end, offset) : self(self, begin, middle, offset);
  };
  descend(descend, 0, static_cast<int>(order_.size()), Vec3::Zero());
  return best;
}

void PointTree::within(const Vec3& x, double radius, const std::function<void(int)>& found) const {
  const auto descend = [&](const auto& self, int begin, int end) -> void {
    if (begin >= end) {
      return;
    }
    const int middle = begin + (end - begin) / 2;
    const int i = order_[middle];
    if ((points_[i] - x).squaredNorm() <= radius * radius) {
      found(i);
    }
    const double side = x[axis_[middle]] - points_[i][axis_[middle]];
    if (side <= radius) {
      self(self, begin, middle);
    }
    if (side >= -radius) {
      self(self, middle + 1, end);
    }
  };
  descend(descend, 0, static_cast<int>(order_.size()));
}

}  // namespace vasohex
