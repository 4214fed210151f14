#pragma once
/// \file The cones of a network in a tree of boxes: those that reach a point, and the one nearest to it.

#include <array>
#include <cstdint>
#include <vector>

#include "vasohex/surface/cone_kernel.h"

namespace vasohex {

/// Const after construction; the order in which segments are visited depends on nothing but the segments.
class ConeTree {
 public:
  explicit ConeTree(std::vector<ConeSegment> segments);

  /// Calls visit(segment) for the segments that may reach x: all that do, in a fixed order.
  template <class Visit>
  void for_each_near(const Vec3& x, Visit&& visit) const {
    const auto end = static_cast<std::uint32_t>(nodes_.size());
    for (std::uint32_t i = 0; i < end;) {
      const Node& node = nodes_[i];
      const bool in = (x[0] >= node.min[0]) & (x[1] >= node.min[1]) & (x[2] >= node.min[2]) & (x[0] <= node.max[0]) &
                      (x[1] <= node.max[1]) & (x[2] <= node.max[2]);
      if (!in) {
        i = node.skip;
        continue;
      }
      for (std::uint32_t k = 0; k < node.count; ++k) {
        visit(segments_[node.first + k]);
      }
      ++i;
    }
  }

  /// The point of all axes with the least distance / radius from x.
  ConeNearest nearest(const Vec3& x) const;

 private:
  struct Node {
    std::array<double, 3> min{}, max{};  ///< around all that its segments reach
    std::uint32_t skip = 0;              ///< the node after its subtree; its first child follows it
    std::uint32_t first = 0, count = 0;  ///< segments of a leaf; none otherwise
    std::uint32_t unused = 0;
  };
  struct Core {
    Box axis;  ///< around the axes
    double max_radius = 0;
  };

  void build(std::uint32_t begin, std::uint32_t end);
  void nearest(std::uint32_t node, const Vec3& x, ConeNearest& best) const;
  double bound(std::uint32_t node, const Vec3& x) const;  ///< no distance / radius below it is less

  std::vector<ConeSegment> segments_;
  std::vector<Node> nodes_;  ///< depth first
  std::vector<Core> cores_;  ///< [node]
};

}  // namespace vasohex
