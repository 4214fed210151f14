#include "vasohex/skeleton/through_vessel.h"

#include <cmath>
#include <limits>
#include <numbers>

namespace vasohex {
namespace {

constexpr double kAlike = 0.7;    ///< least ratio of the radii of two vessels that are one
constexpr double kSide = 0.7;     ///< radius of side branches in terms of the vessel they branch off, at most
constexpr double kLeastTurn = 1;  ///< least angle between two vessels that are one
constexpr double kAside = 0.5;    ///< radii at which a side branch may miss the axis
constexpr double kLeastAngle = 70 * std::numbers::pi / 180;  ///< between a side branch and the axis it meets
constexpr double kAlong = 2;    ///< radii along the vessel that runs through in which side branches may meet it
constexpr double kTrunk = 1;    ///< radii of the branches that leave a node: so far outside it has a trunk
constexpr double kClear = 0.5;  ///< own radii outside of the vessel it branches off where a section counts
constexpr double kApart = 0.3;  ///< radii between two junctions
constexpr double kLeastOwn = 0.8, kWhole = 0.97;  ///< part of the way around that is own wall
constexpr int kCirclePasses = 3;
constexpr double kCircles = 0.3;  ///< widths between two circles
constexpr int kSmoothings = 2;
constexpr double kFine = 0.1;  ///< widths between two stations

/// The two arms that are one vessel, if any: much wider than all others, and not side by side.
std::optional<std::array<Arrival, 2>> through_pair(const Cluster& cluster) {
  std::vector<Arrival> arms = cluster.arms;
  std::stable_sort(arms.begin(), arms.end(),
                   [](const Arrival& a, const Arrival& b) { return a.calibre > b.calibre; });
  if (arms.size() < 4 || arms[1].calibre < kAlike * arms[0].calibre || arms[2].calibre > kSide * arms[1].calibre ||
      angle_between(arms[0].outward, arms[1].outward) < kLeastTurn) {
    return {};
  }
  return std::array{arms[0], arms[1]};
}

/// The section around a station of the vessel that runs through. A whole one says most, then a circle past openings.
std::optional<Section> through_section(const std::array<Arrival, 2>& pair, const std::vector<int>& vessels,
                                       const PartedLumen& lumen, const Station& at, const Vec3& direction,
                                       double radius) {
  std::optional<Section> best;
  for (const Arrival& arm : pair) {
    const auto section = section_of(lumen, arm.vessel, at.point, direction);
    if (section && section->area > 0 && (section->centre - at.point).norm() < at.width &&
        section->own > (best ? best->own : kLeastOwn)) {
      best = section;
    }
  }
  if (best && best->own > kWhole) {
    return best;
  }
  const auto circle = circle_of(lumen, vessels, at.point, direction, radius);
  return circle ? circle : best;
}

/// The axis of the vessel that runs through, over its last stations before and after the junctions too.
Path through_axis(const std::array<Arrival, 2>& pair, const Cluster& cluster, const PartedLumen& lumen,
                  const std::vector<Path>& paths) {
  const auto leg = [&](const Arrival& arm) {
    Path stations = counted(paths[arm.vessel], arm.back);
    stations.resize(leg_size(stations, arm.radius));
    return arm.is_end ? Path{{arm.point, arm.radius, arm.radius}} : stations;
  };
  Path axis = leg(pair[0]);
  std::reverse(axis.begin(), axis.end());
  const Path other = leg(pair[1]);
  bridge(axis, axis.back(), -pair[0].outward, other.front(), pair[1].outward, kFine);
  axis.insert(axis.end(), other.begin(), other.end());
  const Vec3 start = pair[0].is_end ? Vec3(-pair[0].outward) : Vec3((axis[1].point - axis[0].point).normalized());
  const Vec3 goal =
      pair[1].is_end ? Vec3(-pair[1].outward) : Vec3((axis[axis.size() - 2].point - axis.back().point).normalized());
  std::vector<int> vessels = cluster.inner;
  for (const Arrival& arm : cluster.arms) {
    vessels.push_back(arm.vessel);
  }
  for (int pass = 0; pass < kCirclePasses; ++pass) {
    const Path ends{axis.front(), axis.back()};
    axis = resample(axis, kCircles, [](const Station& s) { return s.width; });
    Path moved = axis;
    for (std::size_t i = 1; i + 1 < axis.size(); ++i) {
      const double u = static_cast<double>(i) / static_cast<double>(axis.size() - 1);
      const double radius = (1 - u) * ends[0].radius + u * ends[1].radius;
      const auto section = through_section(pair, vessels, lumen, axis[i], direction_at(axis, i), radius);
      moved[i].point = section ? section->centre : axis[i].point;
      moved[i].radius = section ? std::sqrt(section->area / std::numbers::pi) : 0;
    }
    for (int k = 0; k < kSmoothings; ++k) {
      const Path rough = moved;
      for (std::size_t i = 1; i + 1 < moved.size(); ++i) {
        if (rough[i].radius > 0 && rough[i - 1].radius > 0 && rough[i + 1].radius > 0) {
          moved[i].point = (rough[i - 1].point + 2 * rough[i].point + rough[i + 1].point) / 4;
        }
      }
    }
    axis = joined(moved, ends[0], start, ends[1], goal, kFine);
  }
  fill_radii(axis, {0, 0});
  return axis;
}

/// The path of an arm, of which the first stations do not count: those within the vessel it branches off, or so near
/// to that one that sections are open to it.
Path clear_of(const Path& axis, Path path, bool back) {
  for (std::size_t k = 0; k < path.size(); ++k) {
    Station& s = path[back ? path.size() - 1 - k : k];
    const Station foot = station_at(axis, foot_of(axis, s.point));
    if (s.radius > 0 && (s.point - foot.point).norm() > foot.radius + kClear * s.radius) {
      break;
    }
    s.radius = 0;
  }
  return path;
}

struct Meeting {
  double at = 0;     ///< place on the axis
  double aside = 0;  ///< distance of the line there
};

/// Where an arm meets an axis: where its line comes nearest, but at no angle below kLeastAngle. An arm that bends
/// into the other vessel at its mouth has a line that misses the wall around it.
Meeting meeting_of(const Path& axis, const Arrival& arm) {
  const double foot = foot_of(axis, arm.point), near = (station_at(axis, foot).point - arm.point).norm();
  Meeting best{0, std::numeric_limits<double>::infinity()};
  for (std::size_t i = 0; i + 1 < axis.size(); ++i) {
    const Vec3 &a = axis[i].point, d = axis[i + 1].point - a;
    // nearest points of the piece a + t d and the line: least squares across the line
    const auto across = [&](const Vec3& x) -> Vec3 { return x - x.dot(arm.outward) * arm.outward; };
    const Vec3 e = across(d), f = across(a - arm.point);
    const double t = e.squaredNorm() > 0 ? std::clamp(-e.dot(f) / e.squaredNorm(), 0.0, 1.0) : 0;
    if (const double aside = (f + t * e).norm(); aside < best.aside) {
      best = {static_cast<double>(i) + t, aside};
    }
  }
  const double most = near / std::tan(kLeastAngle);
  const double sign = best.at < foot ? -1 : 1;
  if (sign * length_along(axis, foot, best.at) > most) {
    best.at = foot;  // and on from there
    double left = most;
    while (left > 0 && best.at > 0 && best.at < static_cast<double>(axis.size() - 1)) {
      const double next = sign > 0 ? std::floor(best.at) + 1 : std::ceil(best.at) - 1;
      const double step = std::abs(length_along(axis, best.at, next));
      best.at += (next - best.at) * std::min(1.0, left / std::max(step, 1e-300));
      left -= step;
    }
  }
  return best;
}

/// A short vessel between a node within the one that runs through and another node outside, as an arm.
Arrival link_arm(const VesselGraph& graph, const Arrivals& arrivals, const Path& axis, int link, bool back) {
  if (arrivals[link][back]) {
    return *arrivals[link][back];
  }
  const VesselNode& far = graph.nodes[graph.vessels[link].nodes[!back]];
  const Vec3 foot = station_at(axis, foot_of(axis, far.position)).point;
  return {link, back, far.position, (far.position - foot).normalized(), far.width, far.width, false};
}

/// The nodes of a cluster that lie within the vessel that runs through, and all arms that leave those.
void gather(const Cluster& cluster, const VesselGraph& graph, const Arrivals& arrivals, ThroughVessel& vessel,
            std::vector<Arrival>& arms) {
  const auto is_in = [](const std::vector<int>& all, int i) {
    return std::find(all.begin(), all.end(), i) != all.end();
  };
  const auto is_inside = [&](int node) {
    double widest = 0;  // of the vessels that leave: a trunk shorter than that is none
    for (const Arrival& a : cluster.arms) {
      widest = graph.vessels[a.vessel].nodes[a.back] == node ? std::max(widest, a.calibre) : widest;
    }
    const Vec3& x = graph.nodes[node].position;
    const Station foot = station_at(vessel.axis, foot_of(vessel.axis, x));
    return (x - foot.point).norm() < foot.radius + kTrunk * widest;
  };
  vessel.nodes = {graph.vessels[vessel.arms[0].vessel].nodes[vessel.arms[0].back]};
  for (std::size_t i = 0; i < vessel.nodes.size(); ++i) {
    for (const int v : cluster.inner) {
      const auto [a, b] = graph.vessels[v].nodes;
      const int other = a == vessel.nodes[i] ? b : b == vessel.nodes[i] ? a : -1;
      if (other < 0 || is_in(vessel.inner, v)) {
        continue;
      }
      if (is_inside(other)) {
        vessel.nodes.push_back(other);
        vessel.inner.push_back(v);
      } else {
        arms.push_back(link_arm(graph, arrivals, vessel.axis, v, b == vessel.nodes[i]));
      }
    }
  }
  for (const Arrival& arm : cluster.arms) {
    const int node = graph.vessels[arm.vessel].nodes[arm.back];
    if (is_in(vessel.nodes, node)) {
      arms.push_back(arm);
    }
  }
}

}  // namespace

std::size_t leg_size(const Path& stations, double radius) {
  std::size_t n = std::min<std::size_t>(1, stations.size());
  while (n < stations.size() && (stations[n].point - stations[0].point).norm() < kAlong * radius) {
    ++n;
  }
  return n;
}

std::optional<ThroughVessel> through_vessel(const Cluster& cluster, const VesselGraph& graph,
                                            const Arrivals& arrivals, const PartedLumen& lumen,
                                            const std::vector<Path>& paths) {
  const auto pair = through_pair(cluster);
  if (!pair || !cluster.is_complete || cluster.inner.size() + 1 != cluster.nodes.size()) {
    return {};
  }
  ThroughVessel vessel{through_axis(*pair, cluster, lumen, paths), *pair, {}, {}, {}, {}};
  std::vector<Arrival> arms;
  gather(cluster, graph, arrivals, vessel, arms);
  std::vector<std::pair<double, SideBranch>> sides;
  int throughs = 0;
  for (const Arrival& arm : arms) {
    const auto is = [&](const Arrival& a) { return a.vessel == arm.vessel && a.back == arm.back; };
    if (is((*pair)[0]) || is((*pair)[1])) {
      ++throughs;
      continue;
    }
    SideBranch side{arm, clear_of(vessel.axis, paths[arm.vessel], arm.back)};
    if (const auto arrival = arrival_of(side.path, arm.vessel, arm.back)) {
      side.arm = *arrival;
    } else {
      side.path = paths[arm.vessel];
    }
    const Meeting meeting = meeting_of(vessel.axis, side.arm);
    const bool is_outside = meeting.at <= 0 || meeting.at >= static_cast<double>(vessel.axis.size() - 1);
    if (is_outside || meeting.aside > kAside * station_at(vessel.axis, meeting.at).radius) {
      return {};
    }
    sides.emplace_back(meeting.at, std::move(side));
  }
  if (throughs != 2 || sides.empty()) {
    return {};
  }
  std::stable_sort(sides.begin(), sides.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  for (std::size_t i = 0; i < sides.size();) {
    // those that follow within kApart of the first one share its junction, at their mean
    std::size_t n = i;
    double sum = 0;
    for (; n < sides.size() && length_along(vessel.axis, sides[i].first, sides[n].first) <=
                                   kApart * station_at(vessel.axis, sides[i].first).radius;
         ++n) {
      sum += sides[n].first;
      vessel.sides.push_back(std::move(sides[n].second));
      vessel.sides.back().junction = static_cast<int>(vessel.junctions.size());
    }
    vessel.junctions.push_back(sum / static_cast<double>(n - i));
    i = n;
  }
  return vessel;
}

}  // namespace vasohex
