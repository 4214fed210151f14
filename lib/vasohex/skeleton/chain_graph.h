#pragma once
/// \file A curve graph while it is being cleaned: points may be joined, added and merged.

#include <algorithm>
#include <set>
#include <vector>

#include "vasohex/skeleton/closed_lumen.h"
#include "vasohex/skeleton/collapse_to_graph.h"

namespace vasohex {

/// Points along the graph, from a node to the next one; first and last may be the same.
using Chain = std::vector<int>;

/// Shortest ways along the graph to one of several points.
struct Ways {
  std::vector<int> before;        ///< [points] the next point on the way; -1: there, or not connected
  std::vector<double> distances;  ///< [points]
  std::vector<int> order;         ///< the points that are connected, ascending by distance

  int farthest() const { return order.back(); }
};

class ChainGraph {
 public:
  static constexpr int kNoEnd = -1, kDeadEnd = -2;

  /// Every point is as wide as the lumen is on average where it was collapsed to it.
  ChainGraph(const CurveGraph& graph, const SizedLumen& sized);

  std::vector<Vec3> points;
  std::vector<double> widths;
  std::vector<std::set<int>> neighbours;
  std::vector<int> end_of;  ///< index of the SurfaceEnd, kNoEnd or kDeadEnd

  int size() const { return static_cast<int>(points.size()); }
  int degree(int i) const { return static_cast<int>(neighbours[i].size()); }
  int root(int i) const { return into_[i] == i ? i : root(into_[i]); }
  bool is_gone(int i) const { return into_[i] != i; }

  void join(int a, int b);
  int add(const Vec3& position, double width);
  /// The wall of b becomes that of a, its edges too.
  void merge(int a, int b);
  /// Both at their common middle.
  void unite(int a, int b);

  double length(const Chain& chain) const;
  /// The chain that leaves `node` for `next`, up to the next node.
  Chain chain_from(int node, int next) const;
  /// All chains once, ascending by their first node.
  std::vector<Chain> chains() const;
  Ways ways_from(const std::vector<int>& starts) const;

 private:
  std::vector<int> into_;  ///< the point that has taken over the wall of each, itself if it is still there
  std::vector<double> mass_;
};

}  // namespace vasohex
