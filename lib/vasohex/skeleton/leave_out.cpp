#include "vasohex/skeleton/leave_out.h"

#include <algorithm>
#include <limits>
#include <numeric>
#include <set>

namespace vasohex {
namespace {

constexpr double kFarBend = 1.0;  // a bend rounded by more radii than that may be better off without a point
constexpr double kFarthestLeftOut = 4.0;  // from the curve, in radii
constexpr double kWorthLeavingOut = 0.5;  // least gain: see cost_of
constexpr int kMostLeftOut = 40;          // of one path

/// A path, its radii, and a curve near it without some of the points.
struct Simplified {
  PathCurve curve;
  std::vector<std::size_t> kept;  ///< points, ascending
  double cost = 0;                ///< of two curves near one path the better one has less
};

/// What a curve costs: radii that it is moved by, radians that it turns by, and ten times those by which it bends
/// within its radius.
double cost_of(const PathCurve& curve, const std::vector<double>& radii) {
  constexpr double kTooTight = 10;
  double cost = 0;
  for (const PathBend& bend : curve.bends) {
    cost += bend.moved;
  }
  for (const PathBend& point : curve.left_out) {
    cost += point.moved;
  }
  std::size_t i = 0;
  Vec3 before = curve.spline.at(0, 0).first;
  for (std::size_t k = 0; k + 1 < curve.spline.t.size(); ++k) {
    constexpr int steps = 4;
    const double h = (curve.spline.t[k + 1] - curve.spline.t[k]) / steps;
    for (int step = 1; step <= steps; ++step) {
      const double t = curve.spline.t[k] + step * h;
      const Vec3 tangent = curve.spline.at(k, t).first;
      const double turn = angle_between(before, tangent);
      while (i + 2 < curve.t.size() && curve.t[i + 1] < t) {
        ++i;
      }
      const double u = std::clamp((t - curve.t[i]) / (curve.t[i + 1] - curve.t[i]), 0.0, 1.0);
      const double radius = (1 - u) * radii[i] + u * radii[i + 1];
      cost += turn + kTooTight * std::max(0.0, turn - h / radius);
      before = tangent;
    }
  }
  return cost;
}

/// The distance of a point from the stretch of a spline between two of its knots.
double distance(const SpaceSpline& spline, std::size_t first, std::size_t last, const Vec3& point) {
  double nearest = std::numeric_limits<double>::infinity();
  for (std::size_t k = first; k < last; ++k) {
    constexpr int steps = 16;
    for (int i = 0; i <= steps; ++i) {
      const double t = spline.t[k] + (spline.t[k + 1] - spline.t[k]) * i / steps;
      nearest = std::min(nearest, (spline.at(k, t).position - point).norm());
    }
  }
  return nearest;
}

Simplified without(const PathPoints& path, const std::vector<double>& radii, std::vector<std::size_t> kept) {
  PathPoints fewer;
  std::vector<double> fewer_radii;
  for (const std::size_t i : kept) {
    fewer.points.push_back(path.points[i]);
    fewer.fixed.push_back(path.fixed[i]);
    fewer_radii.push_back(radii[i]);
  }
  Simplified result{curve_near_all(fewer, fewer_radii), std::move(kept), 0};
  PathCurve& curve = result.curve;
  const std::vector<double> arc = polyline_length(path.points, false);
  std::vector<double> t, moved;
  for (std::size_t k = 0; k < result.kept.size(); ++k) {
    const std::size_t here = result.kept[k], next = k + 1 < result.kept.size() ? result.kept[k + 1] : here + 1;
    t.push_back(curve.t[k]);
    moved.push_back(curve.moved[k]);
    for (std::size_t i = here + 1; i < next; ++i) {
      t.push_back(curve.t[k] + (curve.t[k + 1] - curve.t[k]) * (arc[i] - arc[here]) / (arc[next] - arc[here]));
      const auto knot = [&](double at) {
        return static_cast<std::size_t>(std::upper_bound(curve.spline.t.begin(), curve.spline.t.end(), at) -
                                        curve.spline.t.begin());
      };
      const std::size_t first = knot(curve.t[k]) - 1, last = std::min(knot(curve.t[k + 1]), curve.spline.t.size() - 1);
      moved.push_back(0);
      curve.left_out.push_back({i, distance(curve.spline, first, last, path.points[i]) / radii[i]});
    }
  }
  curve.t = std::move(t);
  curve.moved = std::move(moved);
  for (PathBend& bend : curve.bends) {
    bend.point = result.kept[bend.point];
  }
  curve.off_edge_at = result.kept[curve.off_edge_at];
  result.cost = cost_of(curve, radii);
  return result;
}

}  // namespace

PathCurve curve_near(const PathPoints& path, const std::vector<double>& radii) {
  if (path.closed) {
    return curve_near_all(path, radii);
  }
  std::vector<std::size_t> all(path.points.size());
  std::iota(all.begin(), all.end(), std::size_t{0});
  Simplified best{curve_near_all(path, radii), all, 0};
  best.cost = cost_of(best.curve, radii);
  std::set<std::size_t> tried;  // points at bends
  for (int round = 0; round < kMostLeftOut; ++round) {
    const PathBend* worst = nullptr;
    for (const PathBend& bend : best.curve.bends) {
      if (bend.moved > kFarBend && !tried.contains(bend.point) && (worst == nullptr || bend.moved > worst->moved)) {
        worst = &bend;
      }
    }
    if (worst == nullptr) {
      break;
    }
    tried.insert(worst->point);
    const auto at = std::lower_bound(best.kept.begin(), best.kept.end(), worst->point) - best.kept.begin();
    const Simplified now = best;
    for (std::ptrdiff_t k = std::max<std::ptrdiff_t>(at - 1, 0);
         k <= at + 2 && k < static_cast<std::ptrdiff_t>(now.kept.size()); ++k) {
      if (path.fixed[now.kept[k]] || k == 0 || k + 1 == static_cast<std::ptrdiff_t>(now.kept.size())) {
        continue;
      }
      std::vector<std::size_t> kept = now.kept;
      kept.erase(kept.begin() + k);
      Simplified fewer = without(path, radii, std::move(kept));
      const bool far = std::any_of(fewer.curve.left_out.begin(), fewer.curve.left_out.end(),
                                   [](const PathBend& point) { return point.moved > kFarthestLeftOut; });
      if (!far && fewer.cost < std::min(best.cost, now.cost - kWorthLeavingOut)) {
        best = std::move(fewer);
      }
    }
  }
  return best.curve;
}

}  // namespace vasohex
