#include "vasohex/skeleton/dead_ends.h"

#include <algorithm>
#include <limits>

#include "vasohex/core/short_text.h"

namespace vasohex {
namespace {

constexpr double kLeastReach = 1.5;  ///< of dead ends out of their vessel, in its radii
constexpr double kThinReach = 4;     ///< the same of those thinner than kThin of it: a bump of the wall, not a vessel
constexpr double kThin = 0.3;
constexpr double kTipLeft = 1.0 / 3;  ///< radii between a dead end and the wall: keeps the volume of a round one

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

/// A vessel that ends without a SurfaceEnd.
struct DeadEnd {
  Chain chain;        ///< from the tip to a point that stays
  double radius = 0;  ///< its own at the tip: of cones almost none
  double reach = 0;   ///< out of the vessel that it branches off
  double least = 0;   ///< reach that it needs to stay
};

/// From the tip of a dead end on, in its direction; at most its diameter.
double tip_to_wall(const ChainGraph& graph, const ClosedLumen& lumen, int tip) {
  const Vec3 direction = (graph.points[tip] - graph.points[*graph.neighbours[tip].begin()]).normalized();
  return std::min(distance_to_wall(lumen, graph.points[tip], direction), 2 * graph.widths[tip]);
}

/// The widest place of other vessels around the base of a chain; at the base itself the chain has a share.
double parent_width(const ChainGraph& graph, const Chain& chain) {
  const int base = chain.back();
  double widest = 0;
  for (int i = 0; i < graph.size(); ++i) {
    const bool is_own = std::find(chain.begin(), chain.end(), i) != chain.end();
    const bool is_near =
        graph.neighbours[base].contains(i) || (graph.points[i] - graph.points[base]).norm() < graph.widths[i];
    if (!is_own && !graph.is_gone(i) && is_near) {
      widest = std::max(widest, graph.widths[i]);
    }
  }
  return widest;
}

DeadEnd dead_end_at(const ChainGraph& graph, const ClosedLumen& lumen, const Chain& chain) {
  DeadEnd dead;
  dead.chain = chain;
  dead.radius = graph.widths[chain.front()];
  const double parent = parent_width(graph, chain);
  dead.reach = graph.length(chain) + tip_to_wall(graph, lumen, chain.front()) - parent;
  dead.least = std::max(dead.radius, (dead.radius < kThin * parent ? kThinReach : kLeastReach) * parent);
  return dead;
}

/// Which points of the graph lie between SurfaceEnds or on cycles. Of pieces with at most one SurfaceEnd and without
/// a cycle, those on the longest way, from that end if there is one.
std::vector<bool> trunk_of(const ChainGraph& graph) {
  const int n = graph.size();
  std::vector<bool> stays(n);
  std::vector<int> degree(n), tips;
  for (int i = 0; i < n; ++i) {
    stays[i] = !graph.is_gone(i);
    degree[i] = graph.degree(i);
    if (stays[i] && degree[i] <= 1 && graph.end_of[i] == ChainGraph::kNoEnd) {
      tips.push_back(i);
    }
  }
  while (!tips.empty()) {
    const int tip = tips.back();
    tips.pop_back();
    stays[tip] = false;
    for (const int j : graph.neighbours[tip]) {
      if (stays[j] && --degree[j] == 1 && graph.end_of[j] == ChainGraph::kNoEnd) {
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

}  // namespace

void treat_dead_ends(ChainGraph& graph, const ClosedLumen& lumen, std::vector<std::string>& notes) {
  const auto is_tip = [&](int i) { return graph.degree(i) == 1 && graph.end_of[i] == ChainGraph::kNoEnd; };
  std::vector<bool> stays = trunk_of(graph);
  const int n = graph.size();
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
        if (dead.reach >= dead.least &&
            (best < 0 || dead.reach * left_out[best].least > left_out[best].reach * dead.least)) {
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
    if (dead.reach > dead.radius) {
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
      graph.end_of[tip] = ChainGraph::kDeadEnd;
    }
  }
}

}  // namespace vasohex
