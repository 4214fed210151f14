#include "vasohex/skeleton/vessel_graph.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <queue>
#include <set>

#include "vasohex/core/short_text.h"

namespace vasohex {
namespace {

constexpr double kMergeJunctions = 0.2;  ///< local widths
constexpr double kLeastReach = 1.5;      ///< of dead ends out of their vessel, in its radii
constexpr double kThinReach = 4;  ///< the same of those thinner than kThin of it: a bump of the wall, not a vessel
constexpr double kThin = 0.3;
/// Of the volume of dead ends: below it they taper. A cone has 1/3, half an ellipsoid 2/3, vessels and sacs about 1.
constexpr double kLeastFullness = 0.6;
constexpr double kTipLeft = 1.0 / 3;  ///< radii between a dead end and the wall: keeps the volume of a round one

constexpr int kNoEnd = -1, kDeadEnd = -2;

/// Points along the graph, from a node to the next one; first and last may be the same.
using Chain = std::vector<int>;

/// Where the ray from `origin` leaves the lumen; infinity if it does not.
double distance_to_wall(const ClosedLumen& lumen, const Vec3& origin, const Vec3& direction) {
  double nearest = std::numeric_limits<double>::infinity();
  for (const auto& t : lumen.surface.triangles) {
    const Vec3 &a = lumen.surface.points[t[0]], e1 = lumen.surface.points[t[1]] - a,
               e2 = lumen.surface.points[t[2]] - a;
    const Vec3 normal = e1.cross(e2);
    const double along = normal.dot(direction);
    if (along <= 0) {
      continue;
    }
    const Vec3 d = origin - a;
    const double distance = -normal.dot(d) / along;
    const Vec3 hit = d + distance * direction;
    const double u = hit.cross(e2).dot(normal), v = e1.cross(hit).dot(normal);
    if (distance > 0 && distance < nearest && u >= 0 && v >= 0 && u + v <= normal.squaredNorm()) {
      nearest = distance;
    }
  }
  return nearest;
}

/// Shortest ways along the graph to one of several points.
struct Ways {
  std::vector<int> before;        ///< [points] the next point on the way; -1: there, or not connected
  std::vector<double> distances;  ///< [points]
  std::vector<int> order;         ///< the points that are connected, ascending by distance

  int farthest() const { return order.back(); }
};

/// The graph while it is being cleaned.
class Graph {
 public:
  Graph(const CurveGraph& graph, const SizedLumen& sized)
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

  std::vector<Vec3> points;
  std::vector<double> widths;
  std::vector<std::set<int>> neighbours;
  std::vector<int> end_of;  ///< index of the SurfaceEnd, kNoEnd or kDeadEnd

  int degree(int i) const { return static_cast<int>(neighbours[i].size()); }
  int root(int i) const { return into_[i] == i ? i : root(into_[i]); }
  bool is_gone(int i) const { return into_[i] != i; }
  void join(int a, int b) {
    neighbours[a].insert(b);
    neighbours[b].insert(a);
  }

  int add(const Vec3& position, double width) {
    points.push_back(position);
    widths.push_back(width);
    neighbours.emplace_back();
    end_of.push_back(kNoEnd);
    into_.push_back(static_cast<int>(into_.size()));
    mass_.push_back(0);
    return static_cast<int>(points.size()) - 1;
  }

  /// The wall of b becomes that of a, its edges too.
  void merge(int a, int b) {
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

  /// Both at their common middle.
  void unite(int a, int b) {
    points[a] = (mass_[a] * points[a] + mass_[b] * points[b]) / std::max(mass_[a] + mass_[b], 1.0);
    widths[a] = std::max(widths[a], widths[b]);
    merge(a, b);
  }

  double length(const Chain& chain) const {
    double sum = 0;
    for (std::size_t i = 1; i < chain.size(); ++i) {
      sum += (points[chain[i]] - points[chain[i - 1]]).norm();
    }
    return sum;
  }

  /// The chain that leaves `node` for `next`, up to the next node.
  Chain chain_from(int node, int next) const {
    Chain chain{node, next};
    while (degree(chain.back()) == 2 && chain.back() != node) {
      const int last = chain.back(), before = chain[chain.size() - 2];
      const auto& both = neighbours[last];
      chain.push_back(*both.begin() == before ? *both.rbegin() : *both.begin());
    }
    return chain;
  }

  Ways ways_from(const std::vector<int>& starts) const {
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

  /// All chains once, ascending by their first node.
  std::vector<Chain> chains() const {
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
    for (int i = 0; i < static_cast<int>(points.size()); ++i) {
      if (degree(i) == 1 || degree(i) > 2) {
        leave(i);
      }
    }
    for (int i = 0; i < static_cast<int>(points.size()); ++i) {
      if (degree(i) == 2 && !seen[i]) {
        leave(i);  // a closed vessel
      }
    }
    return result;
  }

 private:
  std::vector<int> into_;  ///< the point that has taken over the wall of each, itself if it is still there
  std::vector<double> mass_;
};

/// Every end becomes a point with one edge.
void free_ends(Graph& graph, const CurveGraph& curves, const std::vector<SurfaceEnd>& ends) {
  for (std::size_t e = 0; e < ends.size(); ++e) {
    int anchor = curves.anchors[e];
    const bool is_taken = graph.end_of[anchor] >= 0;
    if (graph.degree(anchor) > 1 || is_taken) {
      // a stub so short that its end fell together with the vessel: that one passes a radius behind the end
      const int tip = graph.add(ends[e].centre, ends[e].radius);
      if (!is_taken) {
        graph.points[anchor] -= ends[e].radius * ends[e].normal;
      }
      graph.join(anchor, tip);
      anchor = tip;
    }
    graph.points[anchor] = ends[e].centre;
    graph.widths[anchor] = std::max(graph.widths[anchor], ends[e].radius);
    graph.end_of[anchor] = static_cast<int>(e);
  }
}

/// A vessel that ends without a SurfaceEnd.
struct DeadEnd {
  Chain chain;          ///< from the tip to a point that stays
  double radius = 0;    ///< its own
  double reach = 0;     ///< out of the vessel that it branches off
  double least = 0;     ///< reach that it needs to stay
  double fullness = 0;  ///< its volume outside of that vessel in terms of a tube as wide as it is where it leaves it

  bool is_vessel() const { return reach >= least && fullness >= kLeastFullness; }
};

/// From the tip of a dead end on, in its direction; at most its diameter.
double tip_to_wall(const Graph& graph, const ClosedLumen& lumen, int tip) {
  const Vec3 direction = (graph.points[tip] - graph.points[*graph.neighbours[tip].begin()]).normalized();
  return std::min(distance_to_wall(lumen, graph.points[tip], direction), 2 * graph.widths[tip]);
}

/// The widest place of other vessels around the base of a chain; at the base itself the chain has a share.
double parent_width(const Graph& graph, const Chain& chain) {
  const int base = chain.back();
  double widest = 0;
  for (int i = 0; i < static_cast<int>(graph.points.size()); ++i) {
    const bool is_own = std::find(chain.begin(), chain.end(), i) != chain.end();
    const bool is_near =
        graph.neighbours[base].contains(i) || (graph.points[i] - graph.points[base]).norm() < graph.widths[i];
    if (!is_own && !graph.is_gone(i) && is_near) {
      widest = std::max(widest, graph.widths[i]);
    }
  }
  return widest;
}

DeadEnd dead_end_at(const Graph& graph, const ClosedLumen& lumen, const Chain& chain) {
  DeadEnd dead;
  dead.chain = chain;
  dead.radius = graph.widths[chain.front()];
  const double parent = parent_width(graph, chain), to_wall = tip_to_wall(graph, lumen, chain.front());
  dead.reach = graph.length(chain) + to_wall - parent;
  dead.least = std::max(dead.radius, (dead.radius < kThin * parent ? kThinReach : kLeastReach) * parent);
  double along = 0, first = 0, volume = 0;
  for (std::size_t k = chain.size() - 1; k-- > 0;) {
    const double width = graph.widths[chain[k]];
    const double step = (graph.points[chain[k]] - graph.points[chain[k + 1]]).norm() + (k == 0 ? to_wall : 0);
    along += step;
    if (const double outside = std::min(step, along - parent); outside > 0) {
      first = first > 0 ? first : width;
      volume += outside * width * width;
    }
  }
  dead.fullness = dead.reach > 0 ? volume / (dead.reach * first * first) : 0;
  return dead;
}

/// Which points of the graph lie between SurfaceEnds or on cycles. Of pieces with at most one SurfaceEnd and without
/// a cycle, those on the longest way, from that end if there is one.
std::vector<bool> trunk_of(const Graph& graph) {
  const int n = static_cast<int>(graph.points.size());
  std::vector<bool> stays(n);
  std::vector<int> degree(n), tips;
  for (int i = 0; i < n; ++i) {
    stays[i] = !graph.is_gone(i);
    degree[i] = graph.degree(i);
    if (stays[i] && degree[i] <= 1 && graph.end_of[i] == kNoEnd) {
      tips.push_back(i);
    }
  }
  while (!tips.empty()) {
    const int tip = tips.back();
    tips.pop_back();
    stays[tip] = false;
    for (const int j : graph.neighbours[tip]) {
      if (stays[j] && --degree[j] == 1 && graph.end_of[j] == kNoEnd) {
        tips.push_back(j);
      }
    }
  }
  std::vector<bool> seen(n, false);
  for (int i = 0; i < n; ++i) {
    if (seen[i] || graph.is_gone(i)) {
      continue;
    }
    const auto way = [&](int from) { return graph.ways_from({from}); };
    const Ways first = way(i);
    int kept = 0, end = -1;
    for (const int j : first.order) {
      seen[j] = true;
      kept += stays[j];
      end = graph.end_of[j] >= 0 ? j : end;
    }
    if (kept > 1) {
      continue;
    }
    const Ways ways = way(end >= 0 ? end : first.farthest());
    for (int j = ways.farthest(); j >= 0; j = ways.before[j]) {
      stays[j] = true;
    }
  }
  return stays;
}

/// Leaves out dead ends that hardly leave their vessel; the one that reaches most stays first. Prolongs the others.
void treat_dead_ends(Graph& graph, const ClosedLumen& lumen, std::vector<std::string>& notes) {
  const auto is_tip = [&](int i) { return graph.degree(i) == 1 && graph.end_of[i] == kNoEnd; };
  std::vector<bool> stays = trunk_of(graph);
  const int n = static_cast<int>(graph.points.size());
  std::vector<DeadEnd> left_out;
  for (;;) {
    std::vector<int> from;
    for (int i = 0; i < n; ++i) {
      if (stays[i]) {
        from.push_back(i);
      }
    }
    const Ways ways = graph.ways_from(from);
    left_out.clear();
    int best = -1;
    for (int i = 0; i < n; ++i) {
      if (is_tip(i) && !stays[i]) {
        Chain chain{i};
        while (!stays[chain.back()]) {
          chain.push_back(ways.before[chain.back()]);
        }
        left_out.push_back(dead_end_at(graph, lumen, chain));
        const DeadEnd& dead = left_out.back();
        if (dead.is_vessel() && (best < 0 || dead.reach * left_out[best].least > left_out[best].reach * dead.least)) {
          best = static_cast<int>(left_out.size()) - 1;
        }
      }
    }
    if (best < 0) {
      break;
    }
    for (const int i : left_out[best].chain) {
      stays[i] = true;
    }
  }
  for (const DeadEnd& dead : left_out) {
    if (dead.reach >= dead.least) {
      notes.push_back("bump of the wall at " + short_text(graph.points[dead.chain.front()]) + ": it reaches " +
                      short_text(dead.reach) +
                      " out of the vessel that it is on, but tapers like a cone: no vessel of its own");
    } else if (dead.reach > dead.radius) {
      notes.push_back("dead end at " + short_text(graph.points[dead.chain.front()]) + " left out: it reaches only " +
                      short_text(dead.reach) + " out of the vessel that it branches off");
    }
    for (std::size_t k = dead.chain.size() - 1; k-- > 0;) {
      if (!graph.is_gone(dead.chain[k])) {
        graph.merge(dead.chain.back(), dead.chain[k]);
      }
    }
  }
  for (int i = 0; i < n; ++i) {
    if (is_tip(i)) {
      const int next = *graph.neighbours[i].begin();
      const Vec3 direction = (graph.points[i] - graph.points[next]).normalized();
      const double width = graph.widths[i];
      const double further = std::max(tip_to_wall(graph, lumen, i) - kTipLeft * width, 0.0);
      const Chain chain = graph.chain_from(i, next);
      const int tip = graph.add(graph.points[i] + further * direction, width);
      graph.join(i, tip);
      notes.push_back("dead end at " + short_text(graph.points[tip]) + ": a vessel of radius " +
                      short_text(graph.widths[chain[chain.size() / 2]]) +
                      " ends there without an opening or a flat cap");
      graph.end_of[tip] = kDeadEnd;
    }
  }
}

void merge_near_junctions(Graph& graph) {
  for (;;) {
    Chain best;
    double least = kMergeJunctions;
    const std::vector<Chain> chains = graph.chains();
    for (const Chain& chain : chains) {
      const int a = chain.front(), b = chain.back();
      if (a == b || graph.degree(a) < 3 || graph.degree(b) < 3) {
        continue;
      }
      const auto links = std::count_if(chains.begin(), chains.end(), [&](const Chain& c) {
        return (c.front() == a && c.back() == b) || (c.front() == b && c.back() == a);
      });
      const double apart = graph.length(chain) / std::max(graph.widths[a], graph.widths[b]);
      if (links == 1 && apart < least) {
        least = apart;
        best = chain;
      }
    }
    if (best.empty()) {
      return;
    }
    for (std::size_t k = 1; k < best.size(); ++k) {
      graph.unite(best[0], best[k]);
    }
  }
}

double distance_to_segment(const Vec3& x, const Vec3& a, const Vec3& b) {
  return (a + nearest_on_segment(x, a, b) * (b - a) - x).norm();
}

}  // namespace

VesselGraph split_into_vessels(const CurveGraph& curves, const SizedLumen& sized, const ClosedLumen& lumen,
                               const std::vector<SurfaceEnd>& ends, std::vector<std::string>& notes) {
  Graph graph(curves, sized);
  free_ends(graph, curves, ends);
  treat_dead_ends(graph, lumen, notes);
  merge_near_junctions(graph);

  VesselGraph result;
  std::vector<int> node(graph.points.size(), -1), vessel(graph.points.size(), -1);
  std::vector<std::vector<std::pair<int, int>>> leaving(graph.points.size());  // of nodes: vessel, first point
  for (const Chain& chain : graph.chains()) {
    Vessel v;
    const int index = static_cast<int>(result.vessels.size());
    for (const bool last : {false, true}) {
      const int i = last ? chain.back() : chain.front();
      if (node[i] < 0) {
        node[i] = static_cast<int>(result.nodes.size());
        const int end = graph.end_of[i];
        result.nodes.push_back({graph.points[i], graph.widths[i], std::max(end, -1), end == kDeadEnd});
      }
      v.nodes[last] = node[i];
      leaving[i].emplace_back(index, last ? chain[chain.size() - 2] : chain[1]);
    }
    for (const int i : chain) {
      v.points.push_back(graph.points[i]);
      v.widths.push_back(graph.widths[i]);
      vessel[i] = index;
    }
    result.vessels.push_back(std::move(v));
  }
  for (std::size_t i = 0; i < graph.points.size(); ++i) {
    if (!graph.is_gone(static_cast<int>(i)) && graph.degree(static_cast<int>(i)) == 0) {
      notes.push_back("the piece of the lumen around " + short_text(graph.points[i]) +
                      " is no longer than wide: left out");
    }
  }
  for (std::size_t p = 0; p < sized.surface.points.size(); ++p) {
    const int i = graph.root(curves.node_of[p]);
    int own = vessel[i];
    double least = std::numeric_limits<double>::infinity();
    for (const auto& [v, next] : leaving[i]) {
      if (const double d = distance_to_segment(sized.surface.points[p], graph.points[i], graph.points[next]);
          d < least) {
        least = d;
        own = v;
      }
    }
    result.vessel_of.push_back(own);
  }
  return result;
}

}  // namespace vasohex
