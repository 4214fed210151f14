#include "vasohex/skeleton/tie_ends.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "vasohex/core/short_text.h"

namespace vasohex {
namespace {

constexpr double kAside = 1.2;   // radii from an end's centre within which the axis may pass its plane
constexpr double kShort = 4;     // radii that the axis may stop short of an end
constexpr double kBending = 0.8;  // radii along which the axis turns into an end's normal
constexpr double kAhead = 2;      // radii from an end's axis within which a vessel is the one that ends there

/// Points from an end of the skeleton to the first junction or the other end.
std::vector<int> chain_from(int tip, const std::vector<std::vector<int>>& neighbours) {
  std::vector<int> chain{tip};
  int before = -1, at = tip;
  while (at == tip || neighbours[at].size() == 2) {
    const int next = neighbours[at][0] == before ? neighbours[at].back() : neighbours[at][0];
    before = at;
    at = next;
    chain.push_back(at);
  }
  return chain;
}

/// How badly a chain fits an end, in radii; nothing if it does not lead there.
std::optional<double> misfit(const Skeleton& skeleton, const std::vector<int>& chain, const SurfaceEnd& end) {
  const auto depth = [&](int point) { return (end.centre - skeleton.points[point]).dot(end.normal) / end.radius; };
  const auto aside = [&](const Vec3& p) {
    const Vec3 d = p - end.centre;
    return (d - d.dot(end.normal) * end.normal).norm() / end.radius;
  };
  const double of_tip = depth(chain[0]);
  if (of_tip >= 0) {
    const double a = aside(skeleton.points[chain[0]]);
    return of_tip <= kShort && a <= kAside ? std::optional(a + 0.5 * of_tip) : std::nullopt;
  }
  for (std::size_t i = 1; i < chain.size(); ++i) {
    const double outer = depth(chain[i - 1]), inner = depth(chain[i]);
    if (outer < 0 && inner >= 0) {
      const Vec3 crossing = (inner * skeleton.points[chain[i - 1]] - outer * skeleton.points[chain[i]]) / (inner - outer);
      const double a = aside(crossing);
      if (a <= kAside) {
        return a;
      }
    }
  }
  return std::nullopt;
}

/// Moves the chain's first points onto a curve that arrives at the end along its normal.
void lead_to(Skeleton& skeleton, const std::vector<int>& chain, const SurfaceEnd& end) {
  std::size_t kept = 1;
  // the last point that is so far out and ahead of the end: a chain may come back, but a vessel may also turn round
  // further on
  bool behind = true;  // all points so far lie behind the end
  for (std::size_t i = 1; i + 1 < chain.size(); ++i) {
    const Vec3 d = skeleton.points[chain[i]] - end.centre;
    const double along = d.dot(end.normal);
    behind &= along > 0;
    const bool is_ahead = (d - along * end.normal).norm() < kAhead * end.radius;
    if (along > -kBending * end.radius && d.norm() < 3 * kShort * end.radius && (behind || is_ahead)) {
      kept = i + 1;
    }
  }
  const Vec3 from = skeleton.points[chain[kept]];
  const double length = (end.centre - from).norm();
  const Vec3 towards = kept + 1 < chain.size() ? Vec3(from - skeleton.points[chain[kept + 1]]) : end.centre - from;
  const Vec3 leaves = length * towards.normalized(), arrives = length * end.normal;
  const double radius = skeleton.radii[chain[kept]];
  for (std::size_t i = 0; i < kept; ++i) {
    const double u = 1 - static_cast<double>(i) / kept;
    skeleton.points[chain[i]] = (1 + 2 * u) * (1 - u) * (1 - u) * from + u * (1 - u) * (1 - u) * leaves +
                                u * u * (3 - 2 * u) * end.centre + u * u * (u - 1) * arrives;
    skeleton.radii[chain[i]] = (1 - u) * radius + u * end.radius;
  }
}

std::string described(const SurfaceEnd& end) {
  return "the lumen's end at " + short_text(end.centre) + " of radius " + short_text(end.radius);
}

}  // namespace

std::vector<int> tie_ends(Skeleton& skeleton, const std::vector<SurfaceEnd>& ends, std::vector<std::string>& repairs) {
  std::vector<std::vector<int>> neighbours(skeleton.points.size());
  for (const auto& [a, b] : skeleton.segments) {
    neighbours[a].push_back(b);
    neighbours[b].push_back(a);
  }
  struct Pair {
    double misfit;
    int end, tip;
  };
  std::vector<std::vector<int>> chains;
  std::vector<Pair> pairs;
  for (std::size_t point = 0; point < neighbours.size(); ++point) {
    if (neighbours[point].size() != 1) {
      continue;
    }
    chains.push_back(chain_from(static_cast<int>(point), neighbours));
    for (std::size_t e = 0; e < ends.size(); ++e) {
      if (const auto cost = misfit(skeleton, chains.back(), ends[e])) {
        pairs.push_back({*cost, static_cast<int>(e), static_cast<int>(chains.size()) - 1});
      }
    }
  }
  std::stable_sort(pairs.begin(), pairs.end(), [](const Pair& a, const Pair& b) { return a.misfit < b.misfit; });
  std::vector<int> points(ends.size(), -1);
  std::vector<char> taken(chains.size(), 0);
  for (const Pair& pair : pairs) {
    if (points[pair.end] < 0 && !taken[pair.tip]) {
      taken[pair.tip] = 1;
      points[pair.end] = chains[pair.tip][0];
      lead_to(skeleton, chains[pair.tip], ends[pair.end]);
    }
  }
  for (std::size_t e = 0; e < ends.size(); ++e) {
    if (points[e] < 0) {
      repairs.push_back("note: no vessel of the skeleton leads to " + described(ends[e]) + ": it is not meshed");
    }
  }
  return points;
}

void face_ends(Network& network, const std::vector<SurfaceEnd>& ends, const std::vector<int>& points) {
  for (Branch& branch : network.branches) {
    for (int side = 0; side < 2; ++side) {
      const NetworkNode& node = network.nodes[branch.nodes[side]];
      const auto tied = std::find(points.begin(), points.end(), node.point);
      if (node.degree != 1 || tied == points.end()) {
        continue;
      }
      const SurfaceEnd& end = ends[tied - points.begin()];
      Vec3& tangent = side == 0 ? branch.tangents.front() : branch.tangents.back();
      const Vec3 along = side == 0 ? Vec3(-end.normal) : end.normal;
      if (angle_between(tangent, along) < std::numbers::pi / 4) {
        tangent = along;
      } else {
        network.repairs.push_back("note: the axis arrives askew at " + described(end) +
                                  ": the mesh ends there at right angles to the axis");
      }
    }
  }
}

}  // namespace vasohex
