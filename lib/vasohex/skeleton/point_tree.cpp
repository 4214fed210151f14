#include "vasohex/skeleton/point_tree.h"

#include <algorithm>
#include <numeric>
#include <utility>

namespace vasohex {
namespace {

constexpr int kLeaf = 8;

double squared_distance(const Box& box, const Vec3& x) {
  return (box.min - x).cwiseMax(x - box.max).cwiseMax(0).squaredNorm();
}

}  // namespace

PointTree::PointTree(const std::vector<Vec3>& points) : index_(points.size()) {
  std::iota(index_.begin(), index_.end(), 0);
  if (!points.empty()) {
    build(points, 0, static_cast<int>(points.size()));
  }
  points_.reserve(points.size());
  for (const int i : index_) {
    points_.push_back(points[i]);
  }
}

void PointTree::build(const std::vector<Vec3>& points, int begin, int end) {
  const std::size_t at = nodes_.size();
  nodes_.push_back({{}, begin, end, 0});
  Box box;
  for (int i = begin; i < end; ++i) {
    box.add(points[index_[i]]);
  }
  nodes_[at].box = box;
  if (end - begin <= kLeaf) {
    return;
  }
  int axis = 0;
  (box.max - box.min).maxCoeff(&axis);
  const int middle = begin + (end - begin) / 2;
  std::nth_element(index_.begin() + begin, index_.begin() + middle, index_.begin() + end,
                   [&](int a, int b) { return std::pair(points[a][axis], a) < std::pair(points[b][axis], b); });
  build(points, begin, middle);
  nodes_[at].second = static_cast<int>(nodes_.size());
  build(points, middle, end);
}

int PointTree::nearest(const Vec3& x, int skip, double closer_than) const {
  int best = -1;
  double least = closer_than * closer_than;  // squared distance
  const auto descend = [&](const auto& self, int at, double distance) -> void {
    if (distance >= least) {
      return;
    }
    const Node& node = nodes_[at];
    if (node.second == 0) {
      for (int i = node.begin; i < node.end; ++i) {
        if (const double d = (points_[i] - x).squaredNorm(); d < least && index_[i] != skip) {
          least = d;
          best = index_[i];
        }
      }
      return;
    }
    std::pair<double, int> first{squared_distance(nodes_[at + 1].box, x), at + 1};
    std::pair<double, int> second{squared_distance(nodes_[node.second].box, x), node.second};
    if (second.first < first.first) {
      std::swap(first, second);
    }
    self(self, first.second, first.first);
    self(self, second.second, second.first);
  };
  if (!nodes_.empty()) {
    descend(descend, 0, squared_distance(nodes_[0].box, x));
  }
  return best;
}

void PointTree::within(const Vec3& x, double radius, const std::function<void(int)>& found) const {
  const auto descend = [&](const auto& self, int at) -> void {
    const Node& node = nodes_[at];
    if (squared_distance(node.box, x) > radius * radius) {
      return;
    }
    if (node.second != 0) {
      self(self, at + 1);
      self(self, node.second);
      return;
    }
    for (int i = node.begin; i < node.end; ++i) {
      if ((points_[i] - x).squaredNorm() <= radius * radius) {
        found(index_[i]);
      }
    }
  };
  if (!nodes_.empty()) {
    descend(descend, 0);
  }
}

}  // namespace vasohex
