#include "vasohex/skeleton/chain_graph.h"

#include <functional>
#include <limits>
#include <queue>

namespace vasohex {

ChainGraph::ChainGraph(const CurveGraph& graph, const SizedLumen& sized)
    : points(graph.points),
      widths(graph.points.size(), 0),
      neighbours(graph.points.size()),
      end_of(graph.points.size(), kNoEnd),
      into_(graph.points.size()),
      mass_(graph.points.size(), 0) {
  for (std::size_t i = 0; i < into_.size(); ++i) {
    into_[i] = static_cast<int>(i);
  }
  for (const auto& [a, b] : graph.edges) {
    join(a, b);
  }
  for (std::size_t i = 0; i < sized.widths.size(); ++i) {
    widths[graph.node_of[i]] += sized.widths[i];
    mass_[graph.node_of[i]] += 1;
  }
  for (std::size_t i = 0; i < widths.size(); ++i) {
    widths[i] /= mass_[i];
  }
}

void ChainGraph::join(int a, int b) {
  neighbours[a].insert(b);
  neighbours[b].insert(a);
}

int ChainGraph::add(const Vec3& position, double width) {
  points.push_back(position);
  widths.push_back(width);
  neighbours.emplace_back();
  end_of.push_back(kNoEnd);
  into_.push_back(static_cast<int>(into_.size()));
  mass_.push_back(0);
  return size() - 1;
}

void ChainGraph::merge(int a, int b) {
  into_[b] = a;
  mass_[a] += mass_[b];
  for (const int c : neighbours[b]) {
    neighbours[c].erase(b);
    if (c != a) {
      join(a, c);
    }
  }
  neighbours[b].clear();
}

void ChainGraph::unite(int a, int b) {
  points[a] = (mass_[a] * points[a] + mass_[b] * points[b]) / std::max(mass_[a] + mass_[b], 1.0);
  widths[a] = std::max(widths[a], widths[b]);
  merge(a, b);
}

double ChainGraph::length(const Chain& chain) const {
  double sum = 0;
  for (std::size_t i = 1; i < chain.size(); ++i) {
    sum += (points[chain[i]] - points[chain[i - 1]]).norm();
  }
  return sum;
}

Chain ChainGraph::chain_from(int node, int next) const {
  Chain chain{node, next};
  while (degree(chain.back()) == 2 && chain.back() != node) {
    const int last = chain.back(), before = chain[chain.size() - 2];
    const auto& both = neighbours[last];
    chain.push_back(*both.begin() == before ? *both.rbegin() : *both.begin());
  }
  return chain;
}

std::vector<Chain> ChainGraph::chains() const {
  std::vector<Chain> result;
  std::vector<bool> seen(points.size(), false);
  const auto leave = [&](int i) {
    seen[i] = true;
    for (const int next : neighbours[i]) {
      Chain chain = chain_from(i, next);
      const bool is_first =
          chain.front() < chain.back() || (chain.front() == chain.back() && chain[1] <= chain[chain.size() - 2]);
      if (is_first) {
        for (const int p : chain) {
          seen[p] = true;
        }
        result.push_back(std::move(chain));
      }
    }
  };
  for (int i = 0; i < size(); ++i) {
    if (degree(i) == 1 || degree(i) > 2) {
      leave(i);
    }
  }
  for (int i = 0; i < size(); ++i) {
    if (degree(i) == 2 && !seen[i]) {
      leave(i);  // a closed vessel
    }
  }
  return result;
}

Ways ChainGraph::ways_from(const std::vector<int>& starts) const {
  Ways ways{std::vector<int>(points.size(), -1),
            std::vector<double>(points.size(), std::numeric_limits<double>::infinity()),
            {}};
  using Entry = std::pair<double, int>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> open;
  for (const int i : starts) {
    ways.distances[i] = 0;
    open.emplace(0, i);
  }
  while (!open.empty()) {
    const auto [d, i] = open.top();
    open.pop();
    if (d != ways.distances[i]) {
      continue;
    }
    ways.order.push_back(i);
    for (const int j : neighbours[i]) {
      if (const double next = d + (points[i] - points[j]).norm(); next < ways.distances[j]) {
        ways.distances[j] = next;
        ways.before[j] = i;
        open.emplace(next, j);
      }
    }
  }
  return ways;
}

}  // namespace vasohex
