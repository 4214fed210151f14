#pragma once
/// \file Which of n things hang together.

#include <algorithm>
#include <numeric>
#include <vector>

namespace vasohex {

/// n things, each alone at first. A set is known by its least member, so the order of joining does not matter.
class DisjointSets {
 public:
  explicit DisjointSets(int n) : parent_(n) { std::iota(parent_.begin(), parent_.end(), 0); }

  /// The least member of the set that i is in.
  int find(int i) {
    while (parent_[i] != i) {
      i = parent_[i] = parent_[parent_[i]];
    }
    return i;
  }

  void join(int i, int j) {
    const int a = find(i), b = find(j);
    parent_[std::max(a, b)] = std::min(a, b);
  }

 private:
  std::vector<int> parent_;
};

}  // namespace vasohex
