#include "vasohex/surface/ragged_ends.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <numbers>
#include <optional>
#include <unordered_set>

#include "vasohex/core/short_text.h"
#include "vasohex/surface/half_edges.h"
#include "vasohex/surface/surface_ends.h"

namespace vasohex {
namespace {

constexpr double kTurnBack = 0.2;       // radians
constexpr double kTurnBackLeft = 0.02;  // the same of the new rim
constexpr double kDeepest = 1;          // radii that an end is cut back
constexpr double kBevelled = 0.9;       // steepness
constexpr double kSteep = 0.985;         // the same of the new rim
constexpr double kDeepestBevel = 0.5;   // radii
constexpr int kDepths = 20;
constexpr double kFurthest = 4;     // radii around the end that the cut may touch
constexpr double kSnap = 0.2;       // of an edge: nearer to the cut plane than that a point is moved onto it
constexpr double kLeastArea = 0.4;  // of the new rim, in terms of the old one's

/// How far a rim turns back around its middle, in radians; 2 pi if it does not go around it once.
double turn_back(const TriSurface& surface, const std::vector<int>& rim, const SurfaceEnd& end) {
  double angle = 0, furthest = 0, back = 0;
  for (int round = 0; round < 2; ++round) {  // the second time around from the furthest that was met
    for (std::size_t i = 0; i < rim.size(); ++i) {
      const Vec3 a = surface.points[rim[i]] - end.centre, b = surface.points[rim[(i + 1) % rim.size()]] - end.centre;
      angle += std::atan2(a.cross(b).dot(end.normal), a.dot(b) - a.dot(end.normal) * b.dot(end.normal));
      furthest = std::max(furthest, angle);
      back = std::max(back, furthest - angle);
    }
  }
  return std::abs(angle - 4 * std::numbers::pi) < 1 ? back : 2 * std::numbers::pi;
}

/// How steeply the wall meets the plane of a rim, on average: 1 if it comes straight out of the lumen, 0 within the
/// plane.
double steepness(const TriSurface& surface, const std::vector<int>& rim, const SurfaceEnd& end) {
  std::vector<int> before(surface.points.size(), -1);  // along the rim; the wall's triangles run the other way
  for (std::size_t i = 0; i < rim.size(); ++i) {
    before[rim[(i + 1) % rim.size()]] = rim[i];
  }
  double sum = 0, length = 0;
  for (int h = 0; h < 3 * static_cast<int>(surface.triangles.size()); ++h) {
    const int a = start_point(surface, h), b = end_point(surface, h);
    if (before[a] != b) {
      continue;
    }
    const Vec3 along = surface.points[b] - surface.points[a];
    const Vec3 out = along.cross(area_normal(surface, h / 3));
    if (out.norm() > 0) {
      sum += along.norm() * end.normal.dot(out.normalized());
      length += along.norm();
    }
  }
  return length > 0 ? sum / length : 0;
}

/// The wall without what lies beyond a plane around a rim.
class Cut {
 public:
  Cut(const TriSurface& surface, const std::vector<int>& opposite, const std::vector<int>& rim, const SurfaceEnd& end,
      double depth)
      : out_(surface), opposite_(opposite), end_(end), depth_(depth) {
    ok_ = find_members(rim);
    if (ok_) {
      snap();
      clip();
      ok_ = follow_rim();
    }
  }

  bool ok() const { return ok_; }
  const std::vector<int>& rim() const { return rim_; }
  TriSurface& surface() { return out_; }

 private:
  double height_of(int point) const { return end_.normal.dot(out_.points[point] - end_.centre) + depth_; }
  double height(int point) const { return snapped_.contains(point) ? 0 : height_of(point); }
  bool is_above(int point) const { return height(point) > 0; }

  /// The triangles that reach beyond the plane and hang together with the rim there.
  bool find_members(const std::vector<int>& rim) {
    std::vector<char> of_rim(out_.points.size(), 0), seen(out_.triangles.size(), 0);
    for (const int p : rim) {
      of_rim[p] = 1;
      if (!is_above(p)) {
        return false;
      }
    }
    for (int t = 0; t < static_cast<int>(out_.triangles.size()); ++t) {
      const auto& corners = out_.triangles[t];
      if (std::any_of(corners.begin(), corners.end(), [&](int p) { return of_rim[p] != 0; })) {
        seen[t] = 1;
        members_.push_back(t);
      }
    }
    for (std::size_t m = 0; m < members_.size(); ++m) {
      for (int h = 3 * members_[m]; h < 3 * members_[m] + 3; ++h) {
        const int a = start_point(out_, h), b = end_point(out_, h);
        if (!is_above(a) && !is_above(b)) {
          continue;
        }
        const bool is_other_rim = opposite_[h] < 0 && !(of_rim[a] && of_rim[b]);
        if (is_other_rim || (out_.points[a] - end_.centre).norm() > kFurthest * end_.radius) {
          return false;
        }
        if (const int t = opposite_[h] / 3; opposite_[h] >= 0 && !seen[t]) {
          seen[t] = 1;
          members_.push_back(t);
        }
      }
    }
    std::sort(members_.begin(), members_.end());
    return true;
  }

  /// Moves points close to the plane onto it, along an edge: no slivers.
  void snap() {
    for (const int t : members_) {
      for (int h = 3 * t; h < 3 * t + 3; ++h) {
        const int a = start_point(out_, h), b = end_point(out_, h);
        if (is_above(a) == is_above(b) || height(a) == 0 || height(b) == 0) {
          continue;
        }
        const double s = height(a) / (height(a) - height(b));
        if (s < kSnap || s > 1 - kSnap) {
          const Vec3 at = (1 - s) * out_.points[a] + s * out_.points[b];
          const int point = s < kSnap ? a : b;
          out_.points[point] = at;
          snapped_.insert(point);
        }
      }
    }
  }

  int cut_point(int a, int b) {
    const auto [at, is_new] = cuts_.try_emplace(std::minmax(a, b), static_cast<int>(out_.points.size()));
    if (is_new) {
      const double s = height(a) / (height(a) - height(b));
      out_.points.push_back((1 - s) * out_.points[a] + s * out_.points[b]);
    }
    return at->second;
  }

  void clip() {
    std::vector<char> gone(out_.triangles.size(), 0);
    std::vector<std::array<int, 3>> parts;
    for (const int t : members_) {
      gone[t] = 1;
      const std::array<int, 3> corners = out_.triangles[t];
      // what is below, in order
      std::vector<int> below;
      for (int k = 0; k < 3; ++k) {
        const int a = corners[k], b = corners[(k + 1) % 3];
        if (!is_above(a)) {
          below.push_back(a);
        }
        if (is_above(a) != is_above(b) && height(a) != 0 && height(b) != 0) {
          below.push_back(cut_point(a, b));
        }
      }
      for (std::size_t k = 2; k < below.size(); ++k) {
        parts.push_back({below[0], below[k - 1], below[k]});
      }
    }
    std::size_t kept = 0;
    for (std::size_t t = 0; t < gone.size(); ++t) {
      if (!gone[t]) {
        out_.triangles[kept++] = out_.triangles[t];
      }
    }
    out_.triangles.resize(kept);
    out_.triangles.insert(out_.triangles.end(), parts.begin(), parts.end());
  }

  /// The new rim is one loop.
  bool follow_rim() {
    const auto is_on_plane = [&](int p) {
      return snapped_.contains(p) ||
             std::any_of(cuts_.begin(), cuts_.end(), [&](const auto& c) { return c.second == p; });
    };
    for (const std::vector<int>& rim : open_rims(out_)) {
      if (std::all_of(rim.begin(), rim.end(), is_on_plane)) {
        if (!rim_.empty()) {
          return false;
        }
        rim_ = rim;
      }
    }
    return !rim_.empty();
  }

  TriSurface out_;
  const std::vector<int>& opposite_;
  const SurfaceEnd& end_;
  double depth_;
  std::vector<int> members_;
  std::unordered_set<int> snapped_;
  std::map<std::pair<int, int>, int> cuts_;
  std::vector<int> rim_;
  bool ok_ = false;
};

using IsGood = std::function<bool(const TriSurface& surface, const std::vector<int>& rim, const SurfaceEnd& end)>;

/// Cuts an end back by up to `deepest` radii, as little as it takes for its rim to be good; how far, if any is.
std::optional<double> cut_back(TriSurface& surface, const std::vector<int>& rim, const SurfaceEnd& end,
                               double deepest, const IsGood& is_good) {
  const std::vector<int> opposite = pair_half_edges(surface);
  for (int i = 1; i <= kDepths; ++i) {
    const double depth = deepest * i / kDepths * end.radius;
    Cut cut(surface, opposite, rim, end, depth);
    if (!cut.ok()) {
      continue;
    }
    const SurfaceEnd now = rim_end(cut.surface(), cut.rim());
    if (now.radius * now.radius > kLeastArea * end.radius * end.radius && now.normal.dot(end.normal) > 0 &&
        is_good(cut.surface(), cut.rim(), now)) {
      surface = std::move(cut.surface());
      return depth;
    }
  }
  return {};
}

}  // namespace

void cut_ragged_ends(TriSurface& surface, std::vector<std::string>& repairs) {
  for (const std::vector<int>& rim : open_rims(surface)) {
    const SurfaceEnd end = rim_end(surface, rim);
    const bool ragged = turn_back(surface, rim, end) > kTurnBack;
    if (!ragged && steepness(surface, rim, end) >= kBevelled) {
      continue;
    }
    const IsGood turns_one_way = [](const auto& cut, const auto& points, const auto& now) {
      return turn_back(cut, points, now) < kTurnBackLeft;
    };
    const IsGood is_straight = [&](const auto& cut, const auto& points, const auto& now) {
      return turns_one_way(cut, points, now) && steepness(cut, points, now) > kSteep;
    };
    auto depth = cut_back(surface, rim, end, kDeepestBevel, is_straight);
    if (!depth && ragged) {
      depth = cut_back(surface, rim, end, kDeepest, turns_one_way);
    }
    const std::string done = depth ? "cut back by " + short_text(*depth) : std::string();
    const std::string place = " end at " + short_text(end.centre) + ", radius " + short_text(end.radius) + ": ";
    if (ragged) {
      repairs.push_back("ragged" + place + "its rim turns back; " +
                        (depth ? done : "it cannot be cut back by less than a radius, and stays"));
    } else if (depth) {
      repairs.push_back("bevelled" + place + done);
    }
  }
}

}  // namespace vasohex
