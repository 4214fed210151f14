#pragma once
/// \file The cones of a network in a tree of boxes: those that reach a point, and the one nearest to it.

#include <array>
#include <cstdint>
#include <vector>

#include "vasohex/core/box_nodes.h"
#include "vasohex/surface/cone_kernel.h"
#include "vasohex/surface/cone_lanes.h"

namespace vasohex {

/// Const after construction; the order in which segments are visited depends on nothing but the segments.
class ConeTree {
 public:
  explicit ConeTree(std::vector<ConeSegment> segments);

  /// Calls visit(piece, sum) for the groups of neighbouring cones of one piece that reach x, in a fixed order.
  template <class Visit>
  void for_each_sum(const Vec3& x, Visit&& visit) const {
    for_each_item_near(nodes_, x, [&](std::uint32_t i) {
      kernel::GroupSum sum;
      if (kernel::add_cones(groups_[i], x.data(), sum)) {
        visit(groups_[i].piece, sum);
      }
    });
  }

  /// The point of all axes with the least distance / radius from x.
  ConeNearest nearest(const Vec3& x) const;

 private:
  struct Node {
    std::array<double, 3> min{}, max{};  ///< around all that its segments reach
    std::uint32_t skip = 0;              ///< the node after its subtree; its first child follows it
    std::uint32_t first = 0, count = 0;  ///< the group of a leaf; none otherwise
    std::uint32_t unused = 0;
  };
  struct Core {
    Box axis;  ///< around the axes
    double max_radius = 0;
  };
  /// Segments begin to end, of one piece.
  struct Range {
    std::uint32_t begin = 0, end = 0;
    Vec3 middle = Vec3::Zero();
  };

  /// Puts segments `begin` to `end`, of one piece, in order and divides them among as few groups as can be.
  void divide(std::uint32_t begin, std::uint32_t end, std::vector<Range>& ranges);
  void build(std::vector<Range>& ranges, std::uint32_t begin, std::uint32_t end);
  void nearest(std::uint32_t node, const Vec3& x, ConeNearest& best) const;
  double bound(std::uint32_t node, const Vec3& x) const;  ///< no distance / radius below it is less

  std::vector<ConeSegment> segments_;
  std::vector<kernel::ConeGroup> groups_;
  std::vector<std::array<std::uint32_t, 2>> of_group_;  ///< [groups] begin and end of its segments
  std::vector<Node> nodes_;                             ///< depth first
  std::vector<Core> cores_;                             ///< [node]
};

}  // namespace vasohex
