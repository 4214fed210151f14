#include "vasohex/skeleton/collapse_to_graph.h"

#include <algorithm>
#include <limits>
#include <numeric>
#include <queue>
#include <set>
#include <tuple>

#include "vasohex/core/disjoint_sets.h"

namespace vasohex {
namespace {

using Triangle = std::array<int, 3>;

/// A simplicial complex of points, edges and triangles, in which edges can be collapsed whatever the topology.
class Complex {
 public:
  Complex(const SizedLumen& lumen, const std::vector<Vec3>& contracted)
      : points_(contracted),
        widths_(lumen.widths),
        mass_(contracted.size(), 1),
        anchor_(contracted.size(), false),
        changes_(contracted.size(), 0),
        into_(contracted.size()),
        neighbours_(contracted.size()),
        triangles_(contracted.size()) {
    std::iota(into_.begin(), into_.end(), 0);
    for (const int a : lumen.anchors) {
      anchor_[a] = true;
    }
    for (Triangle t : lumen.surface.triangles) {
      std::sort(t.begin(), t.end());
      for (int k = 0; k < 3; ++k) {
        triangles_[t[k]].insert(t);
        neighbours_[t[k]].insert({t[(k + 1) % 3], t[(k + 2) % 3]});
      }
    }
  }

  void collapse_all_triangles() {
    for (int a = 0; a < static_cast<int>(points_.size()); ++a) {
      enqueue(a, a);
    }
    while (!queue_.empty()) {
      const auto [cost, a, b, changes] = queue_.top();
      queue_.pop();
      if (into_[a] == a && into_[b] == b && changes == changes_[a] + changes_[b] && in_triangle(a, b)) {
        const int kept = collapse(a, b);
        enqueue(kept, -1);
      }
    }
  }

  /// Makes the shortest cycle a point, in terms of the local width; false if there is none.
  bool collapse_shortest_cycle() {
    std::vector<int> best;
    double least = std::numeric_limits<double>::infinity();
    for (int a = 0; a < static_cast<int>(points_.size()); ++a) {
      for (const int b : neighbours_[a]) {
        if (a < b) {
          double length = least;
          if (std::vector<int> way = way_around(a, b, length); !way.empty()) {
            least = length;
            best = std::move(way);
          }
        }
      }
    }
    int kept = best.empty() ? -1 : best[0];
    for (std::size_t i = 1; i < best.size(); ++i) {
      if (const int next = into_[best[i]] == best[i] ? best[i] : -1; next >= 0 && next != kept) {
        kept = collapse(kept, next);
      }
    }
    return kept >= 0;
  }

  CurveGraph graph(const std::vector<int>& anchors) const {
    CurveGraph graph;
    std::vector<int> number(points_.size(), -1);
    for (std::size_t i = 0; i < points_.size(); ++i) {
      if (into_[i] == static_cast<int>(i)) {
        number[i] = static_cast<int>(graph.points.size());
        graph.points.push_back(points_[i]);
      }
    }
    for (std::size_t a = 0; a < points_.size(); ++a) {
      for (const int b : neighbours_[a]) {
        if (static_cast<int>(a) < b) {
          graph.edges.push_back({number[a], number[b]});
        }
      }
      graph.node_of.push_back(number[root(static_cast<int>(a))]);
    }
    for (const int a : anchors) {
      graph.anchors.push_back(graph.node_of[a]);
    }
    return graph;
  }

 private:
  std::vector<Vec3> points_;
  std::vector<double> widths_, mass_;
  std::vector<bool> anchor_;
  std::vector<int> changes_;  ///< how often a point was moved: older entries of the queue are void
  std::vector<int> into_;     ///< the point that it was collapsed into, itself if it is still there
  std::vector<std::set<int>> neighbours_;
  std::vector<std::set<Triangle>> triangles_;
  using Entry = std::tuple<double, int, int, int>;  // relative length, points, changes_ of both
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue_;

  int root(int i) const {
    while (into_[i] != i) {
      i = into_[i];
    }
    return i;
  }

  double relative_length(int a, int b) const {
    return (points_[a] - points_[b]).norm() / std::min(widths_[a], widths_[b]);
  }

  bool in_triangle(int a, int b) const {
    return std::any_of(triangles_[a].begin(), triangles_[a].end(),
                       [&](const Triangle& t) { return std::find(t.begin(), t.end(), b) != t.end(); });
  }

  /// Edges of a to the points above `above`.
  void enqueue(int a, int above) {
    for (auto b = neighbours_[a].upper_bound(above); b != neighbours_[a].end(); ++b) {
      if (!(anchor_[a] && anchor_[*b])) {
        queue_.emplace(relative_length(a, *b), std::min(a, *b), std::max(a, *b), changes_[a] + changes_[*b]);
      }
    }
  }

  /// Returns the one of both that is left.
  int collapse(int a, int b) {
    if (anchor_[b]) {
      std::swap(a, b);
    }
    if (!anchor_[a]) {
      points_[a] = (mass_[a] * points_[a] + mass_[b] * points_[b]) / (mass_[a] + mass_[b]);
    }
    widths_[a] = (mass_[a] * widths_[a] + mass_[b] * widths_[b]) / (mass_[a] + mass_[b]);
    mass_[a] += mass_[b];
    into_[b] = a;
    ++changes_[a];
    for (const Triangle& t : triangles_[b]) {
      Triangle moved = t;
      std::replace(moved.begin(), moved.end(), b, a);
      std::sort(moved.begin(), moved.end());
      const bool vanishes = moved[0] == moved[1] || moved[1] == moved[2];
      for (const int i : t) {
        if (i != b) {
          triangles_[i].erase(t);
          if (!vanishes) {
            triangles_[i].insert(moved);
          }
        }
      }
      if (!vanishes) {
        triangles_[a].insert(moved);
      }
    }
    triangles_[b].clear();
    for (const int c : neighbours_[b]) {
      neighbours_[c].erase(b);
      if (c != a) {
        neighbours_[c].insert(a);
        neighbours_[a].insert(c);
      }
    }
    neighbours_[b].clear();
    return a;
  }

  /// The shortest way from a to b without their edge, if the cycle is shorter than `length`, which becomes its
  /// length.
  std::vector<int> way_around(int a, int b, double& length) const {
    std::vector<double> distance(points_.size(), std::numeric_limits<double>::infinity());
    std::vector<int> before(points_.size(), -1);
    std::priority_queue<std::pair<double, int>, std::vector<std::pair<double, int>>, std::greater<>> open;
    distance[a] = relative_length(a, b);
    open.emplace(distance[a], a);
    while (!open.empty()) {
      const auto [d, i] = open.top();
      open.pop();
      if (d >= length) {
        return {};
      }
      if (i == b) {
        break;
      }
      for (const int j : neighbours_[i]) {
        const double next = d + relative_length(i, j);
        if (d == distance[i] && next < distance[j] && !(i == a && j == b)) {
          distance[j] = next;
          before[j] = i;
          open.emplace(next, j);
        }
      }
    }
    std::vector<int> way;
    if (before[b] >= 0) {
      length = distance[b];
      for (int i = b; i >= 0; i = before[i]) {
        way.push_back(i);
      }
    }
    return way;
  }
};

int cycles_of(const CurveGraph& graph) {
  DisjointSets sets(static_cast<int>(graph.points.size()));
  int cycles = 0;
  for (const auto& [a, b] : graph.edges) {
    cycles += sets.find(a) == sets.find(b);
    sets.join(a, b);
  }
  return cycles;
}

}  // namespace

CurveGraph collapse_to_graph(const SizedLumen& lumen, const std::vector<Vec3>& contracted, int genus) {
  Complex complex(lumen, contracted);
  complex.collapse_all_triangles();
  CurveGraph graph = complex.graph(lumen.anchors);
  graph.cycles = cycles_of(graph);
  while (graph.cycles > genus && complex.collapse_shortest_cycle()) {
    graph = complex.graph(lumen.anchors);
    graph.cycles = cycles_of(graph);
  }
  return graph;
}

}  // namespace vasohex
