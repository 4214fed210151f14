#pragma once
/// \file Walk over a tree of boxes that is stored depth first.

#include <vector>

#include "vasohex/core/vec3.h"

namespace vasohex {

/// Calls visit(i) for the items of all nodes whose boxes hold x, in a fixed order. A node has its box `min`, `max`
/// [3], the items first to first + count of a leaf (count 0 otherwise), and `skip`, the node after its subtree; its
/// first child follows it.
template <class Node, class Visit>
void for_each_item_near(const std::vector<Node>& nodes, const Vec3& x, Visit&& visit) {
  using Index = decltype(Node::skip);
  const auto end = static_cast<Index>(nodes.size());
  for (Index i = 0; i < end;) {
    const Node& node = nodes[i];
    const bool in = (x[0] >= node.min[0]) & (x[1] >= node.min[1]) & (x[2] >= node.min[2]) & (x[0] <= node.max[0]) &
                    (x[1] <= node.max[1]) & (x[2] <= node.max[2]);
    if (!in) {
      i = node.skip;
      continue;
    }
    for (Index k = 0; k < node.count; ++k) {
      visit(node.first + k);
    }
    ++i;
  }
}

}  // namespace vasohex
