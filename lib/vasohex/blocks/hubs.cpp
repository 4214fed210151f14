#include "vasohex/blocks/hubs.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>

#include "vasohex/core/disjoint_sets.h"
#include "vasohex/skeleton/limit_bends.h"
#include "vasohex/surface/project.h"

namespace vasohex {
namespace {

/// Point of a branch at arc length `s` from one of its ends, its tangent leading away from that end.
AxisPoint from_end(const Branch& branch, int end, double s) {
  AxisPoint p = axis_point(branch, end == 0 ? s : branch.length() - s);
  if (end == 1) {
    p.tangent = -p.tangent;
  }
  return p;
}

SectionFrame frame_at(const AxisPoint& p) {
  SectionFrame f;
  f.origin = p.position;
  f.x = p.tangent.unitOrthogonal();
  f.y = p.tangent.cross(f.x);
  f.radius = p.radius;
  return f;
}

/// How far the surface around the branch end's axis at arc length s is from a tube's, in radii; infinity where it is
/// not one at all, or there is no wall. Seen along rays in its normal plane, so many that a vessel of an eighth of
/// the radius does not pass between them: where vessels are round, beside their radius, where they are not, beside
/// the shape that it has a radius further on.
double unlike_tube(const ImplicitSurface& surface, const Branch& branch, int end, double s) {
  constexpr double kNone = std::numeric_limits<double>::infinity();
  const AxisPoint p = from_end(branch, end, s);
  const SectionFrame f = frame_at(p);
  const bool round = surface.is_round() || s + p.radius > branch.length();
  const AxisPoint q = from_end(branch, end, s + p.radius);
  const auto wall = [&](const AxisPoint& from, const Vec3& direction, double most) {
    return shoot(surface, from.position, direction, from.radius, most * from.radius);
  };
  constexpr int kRays = 24;
  double worst = 0;
  for (int ray = 0; ray < kRays; ++ray) {
    const double angle = ray * 2 * std::numbers::pi / kRays;
    const Vec3 direction = std::cos(angle) * f.x + std::sin(angle) * f.y;
    if (round) {
      const auto t = wall(p, direction, 1.3);
      if (!t || *t > (surface.is_round() ? 1.05 : 1.3) * p.radius || *t < 0.7 * p.radius) {
        return kNone;
      }
    } else {
      const auto t = wall(p, direction, 3);
      const auto further_on = wall(q, (direction - q.tangent.dot(direction) * q.tangent).normalized(), 3);
      if (!t || !further_on) {
        return kNone;
      }
      worst = std::max(worst, std::abs(*t - *further_on) / p.radius);
    }
  }
  return worst;
}

/// How a branch leaves a cube: a way that is its own, from the centre to arc length `start` of the branch.
struct Departure {
  ArmAxis way;
  double start = 0;
};

/// The pieces of the branch end's axis between arc lengths `from` and `to`.
ArmAxis sample(const Branch& branch, int end, double from, double to) {
  ArmAxis axis;
  double s = from;
  while (true) {
    const AxisPoint p = from_end(branch, end, s);
    axis.points.push_back(p.position);
    axis.radii.push_back(p.radius);
    if (s >= to) {
      return axis;
    }
    const double step = 0.2 * p.radius;
    s = to - s < 1.5 * step ? to : s + step;
  }
}

/// Ways from the hub's centre into its arms. Where two of three branches run side by side beyond the node the centre
/// moves on to so many radii before they part, and the third branch reaches it on the middle line between them: a
/// cube at the node would have to stretch as far.
std::vector<Departure> depart(const Network& network, double before_parting, Hub& hub) {
  std::vector<Departure> departures(hub.arms.size());
  for (std::size_t a = 0; a < hub.arms.size(); ++a) {
    const AxisPoint p = from_end(network.branches[hub.arms[a].branch], hub.arms[a].end, 0);
    departures[a] = {{{hub.centre}, {p.radius}}, 0};
  }
  if (hub.arms.size() != 3) {
    return departures;
  }
  std::array<ArmAxis, 3> axes;
  for (int a = 0; a < 3; ++a) {
    const Arm& arm = hub.arms[a];
    axes[a] = sample(network.branches[arm.branch], arm.end, 0, arm.link >= 0 ? 0.4 * arm.cap : arm.cap);
  }
  int third = 0;
  std::array<double, 3> parting{};  // of the two others
  for (int a = 0; a < 3; ++a) {
    parting[a] = parting_length(axes[(a + 1) % 3], axes[(a + 2) % 3]);
    third = parting[a] > parting[third] ? a : third;
  }
  const int i = (third + 1) % 3, j = (third + 2) % 3;
  const double at = std::max(arm_point(axes[i], parting[third]).radius, arm_point(axes[j], parting[third]).radius);
  const double room = std::min(length_of(axes[i]), length_of(axes[j])) - 0.5 * at;
  const double move = std::min(parting[third] - before_parting * at, room);
  // all three side by side: there is no middle line to come back on
  if (move < 0.25 * at || std::max(parting[i], parting[j]) > 0.6 * parting[third]) {
    return departures;
  }
  const auto middle = [&](double s) { return middle_of({arm_point(axes[i], s), arm_point(axes[j], s)}); };
  ArmAxis back;
  for (double s = move; s > 0.1 * at; s -= 0.2 * at) {
    back.points.push_back(middle(s).position);
    back.radii.push_back(middle(s).radius);
  }
  back.points.push_back(hub.centre);
  back.radii.push_back(departures[third].way.radii.front());
  departures[third] = {back, 0};
  hub.centre = middle(move).position;
  for (const int a : {i, j}) {
    departures[a] = {{{hub.centre}, {arm_point(axes[a], move).radius}}, move + 0.3 * at};
  }
  return departures;
}

void append(ArmAxis& axis, const ArmAxis& more) {
  for (std::size_t i = 0; i < more.points.size(); ++i) {
    if (axis.points.empty() || (more.points[i] - axis.points.back()).norm() > 0.02 * more.radii[i]) {
      axis.points.push_back(more.points[i]);
      axis.radii.push_back(more.radii[i]);
    }
  }
}

/// The axis of an arm: departure, branch and, of a link, the other hub's departure backwards.
ArmAxis axis_between(const Branch& branch, int end, double cap, const std::array<Departure, 2>& departures,
                     bool is_link) {
  const Departure &here = departures[end], &there = departures[1 - end];
  ArmAxis axis = here.way;
  const double last = is_link ? cap - there.start : cap;
  if (last > here.start) {
    append(axis, sample(branch, end, here.start, last));
  }
  if (is_link) {
    append(axis, reversed(there.way));
  }
  if (axis.points.size() < 2) {
    append(axis, sample(branch, end, cap, cap));
  }
  if (axis.points.size() > 2) {
    limit_bends(axis.points, axis.radii);
  }
  return axis;
}

std::vector<double> cap_distances_of(const Network& network, const std::vector<BranchEnd>& ends) {
  std::vector<double> distance(ends.size());
  std::vector<Vec3> directions(ends.size());
  std::vector<double> radii(ends.size());
  // directions depend on how far away the caps are, and the other way round
  for (int round = 0; round < 3; ++round) {
    for (std::size_t a = 0; a < ends.size(); ++a) {
      const Branch& branch = network.branches[ends[a].branch];
      const double reach = round == 0 ? network.nodes[branch.nodes[ends[a].end]].radius : distance[a];
      const AxisPoint p = from_end(branch, ends[a].end, std::min(reach, 0.9 * branch.length()));
      directions[a] = (p.position - from_end(branch, ends[a].end, 0).position).normalized();
      radii[a] = p.radius;
    }
    for (std::size_t a = 0; a < ends.size(); ++a) {
      distance[a] = cap_distance(directions, radii, static_cast<int>(a));
    }
  }
  return distance;
}

/// Where the branch ends within .4 radii beyond the arm's cap, the end itself becomes the cap.
void stop_at_end(const Network& network, Arm& arm) {
  const Branch& branch = network.branches[arm.branch];
  const NetworkNode& other_end = network.nodes[branch.nodes[1 - arm.end]];
  const bool leads_to_end = other_end.degree == 1 && !other_end.blind;
  if (leads_to_end && arm.cap > branch.length() - 0.4 * branch.radii.back()) {
    arm.cap = branch.length();
  }
}

/// Moves the arm's cap on until the surface around its branch is a tube there, by 3 radii at most; if it is not one
/// anywhere, to where it is least unlike one. True if it was not one before and is now.
bool move_to_tube(const Network& network, const ImplicitSurface& surface, Arm& arm) {
  constexpr double kTube = 0.2;
  const Branch& branch = network.branches[arm.branch];
  int step = 0;
  double least = std::numeric_limits<double>::infinity(), best = arm.cap;
  for (; step < 12 && arm.cap < branch.length() && least > kTube; ++step) {
    const double unlike = unlike_tube(surface, branch, arm.end, arm.cap);
    if (unlike < least) {
      least = unlike;
      best = arm.cap;
    }
    arm.cap += 0.25 * from_end(branch, arm.end, arm.cap).radius;
  }
  if (std::isfinite(least)) {
    arm.cap = best;
  }
  stop_at_end(network, arm);
  return least <= kTube && step > 1;
}

/// A hub for each junction, its caps where the surface around it alone leaves room for them.
std::vector<Hub> lone_hubs(const Network& network, const ImplicitSurface& surface) {
  const auto ends = branch_ends(network);
  std::vector<Hub> hubs;
  for (int n = 0; n < static_cast<int>(network.nodes.size()); ++n) {
    const NetworkNode& node = network.nodes[n];
    if (node.seam || (node.degree < 2 && !node.blind)) {
      continue;
    }
    Hub hub;
    hub.node = n;
    hub.centre = node.position;
    const std::vector<double> distance = cap_distances_of(network, ends[n]);
    for (std::size_t a = 0; a < ends[n].size(); ++a) {
      Arm arm;
      arm.branch = ends[n][a].branch;
      arm.end = ends[n][a].end;
      arm.cap = std::min(distance[a], network.branches[arm.branch].length());
      hub.arms.push_back(arm);
    }
    const std::shared_ptr<const ImplicitSurface> around = surface.part(stretches_of(network, {hub}));
    for (std::size_t a = 0; a < ends[n].size(); ++a) {
      hub.arms[a].cap = distance[a];
      move_to_tube(network, *around, hub.arms[a]);  // the formula knows straight tubes only
    }
    hubs.push_back(hub);
  }
  return hubs;
}

/// Links hubs whose caps leave no room between them: arm.link is the number among all hubs. Returns the groups of
/// hubs that hang together, each in ascending order.
std::vector<std::vector<int>> link_hubs(const Network& network, std::vector<Hub>& hubs) {
  std::vector<std::array<int, 2>> hub_at(network.branches.size(), {-1, -1});
  std::vector<std::array<double, 2>> cap(network.branches.size(), {0, 0});
  for (int h = 0; h < static_cast<int>(hubs.size()); ++h) {
    for (const Arm& arm : hubs[h].arms) {
      hub_at[arm.branch][arm.end] = h;
      cap[arm.branch][arm.end] = arm.cap;
    }
  }
  // Branches too short for two caps become links, the shortest of those between the same two hubs: a second one would
  // share faces with it.
  std::map<std::array<int, 2>, int> link_between;
  const auto key = [&](int b) {
    return std::array{std::min(hub_at[b][0], hub_at[b][1]), std::max(hub_at[b][0], hub_at[b][1])};
  };
  for (int b = 0; b < static_cast<int>(network.branches.size()); ++b) {
    const Branch& branch = network.branches[b];
    const auto [first, last] = hub_at[b];
    const double radius = from_end(branch, 0, 0.5 * branch.length()).radius;
    if (first >= 0 && last >= 0 && first != last && cap[b][0] + cap[b][1] + 0.75 * radius > branch.length()) {
      const auto [it, is_new] = link_between.try_emplace(key(b), b);
      if (!is_new && branch.length() < network.branches[it->second].length()) {
        it->second = b;
      }
    }
  }
  DisjointSets linked(static_cast<int>(hubs.size()));
  for (int h = 0; h < static_cast<int>(hubs.size()); ++h) {
    for (Arm& arm : hubs[h].arms) {
      const int other = hub_at[arm.branch][1 - arm.end];
      arm.link = -1;
      const auto link = link_between.find(key(arm.branch));
      if (link != link_between.end() && link->second == arm.branch) {
        arm.link = other;
        linked.join(h, other);
      }
    }
  }
  std::map<int, std::vector<int>> members;
  for (int h = 0; h < static_cast<int>(hubs.size()); ++h) {
    members[linked.find(h)].push_back(h);
  }
  std::vector<std::vector<int>> groups;
  for (auto& [first, list] : members) {
    groups.push_back(std::move(list));
  }
  return groups;
}

/// Moves caps on that the other hubs of their group leave no room for: a hub alone does not know the vessel that it
/// stands within. True if any was moved; caps may then be too near each other.
bool clear_of_groups(const Network& network, const ImplicitSurface& surface,
                     const std::vector<std::vector<int>>& groups, std::vector<Hub>& hubs) {
  bool moved = false;
  for (const std::vector<int>& group : groups) {
    if (group.size() < 2) {
      continue;
    }
    Cluster further;
    for (const int h : group) {
      further.push_back(hubs[h]);
      for (Arm& arm : further.back().arms) {
        const Branch& branch = network.branches[arm.branch];
        const double beyond = arm.cap + 1.5 * from_end(branch, arm.end, arm.cap).radius;
        arm.cap = arm.link >= 0 ? branch.length() : std::min(branch.length(), beyond);
      }
    }
    const std::shared_ptr<const ImplicitSurface> around = surface.part(stretches_of(network, further));
    for (const int h : group) {
      for (Arm& arm : hubs[h].arms) {
        const double before = arm.cap;
        if (arm.link < 0 && move_to_tube(network, *around, arm)) {
          moved = true;
        } else if (arm.link < 0) {
          arm.cap = before;  // side by side with another: nothing is gained
        }
      }
    }
  }
  return moved;
}

/// What is left to know of the arms: where caps lie that share a short branch, cross-sections, axes.
void finish_arms(const Network& network, const Placement& placement, std::vector<Hub>& hubs) {
  std::vector<double> both(network.branches.size(), 0.0);
  std::vector<int> ends_at_hubs(network.branches.size(), 0);
  for (const Hub& hub : hubs) {
    for (const Arm& arm : hub.arms) {
      both[arm.branch] += arm.cap;
      ++ends_at_hubs[arm.branch];
    }
  }
  for (Hub& hub : hubs) {
    for (Arm& arm : hub.arms) {
      const Branch& branch = network.branches[arm.branch];
      const double length = branch.length(), middle_radius = from_end(branch, arm.end, 0.5 * length).radius;
      if (arm.link >= 0) {
        arm.cap = length;
      } else if (ends_at_hubs[arm.branch] == 2 && both[arm.branch] + 0.3 * middle_radius > length) {
        arm.cap *= (length - 0.3 * middle_radius) / both[arm.branch];  // a tight loop
      } else if (ends_at_hubs[arm.branch] == 2) {
        arm.cap += std::min(placement.beyond * from_end(branch, arm.end, arm.cap).radius,
                            0.5 * (length - 0.3 * middle_radius - both[arm.branch]));
      } else if (arm.cap < length) {
        arm.cap += placement.beyond * from_end(branch, arm.end, arm.cap).radius;
        stop_at_end(network, arm);
      }
      arm.at_end = arm.link < 0 && arm.cap >= length;
      const AxisPoint p = from_end(branch, arm.end, arm.cap);
      arm.radius = arm.link >= 0 ? middle_radius : p.radius;
      arm.section = frame_at(p);
    }
  }
  std::vector<std::array<Departure, 2>> departures(network.branches.size());
  for (Hub& hub : hubs) {
    const std::vector<Departure> of_arms = depart(network, placement.before_parting, hub);
    for (std::size_t a = 0; a < hub.arms.size(); ++a) {
      departures[hub.arms[a].branch][hub.arms[a].end] = of_arms[a];
    }
  }
  for (Hub& hub : hubs) {
    for (Arm& arm : hub.arms) {
      arm.axis = axis_between(network.branches[arm.branch], arm.end, arm.cap, departures[arm.branch], arm.link >= 0);
      arm.direction = direction_of(arm);
    }
  }
}

}  // namespace

std::vector<double> cap_distances(const Network& network, int node) {
  return cap_distances_of(network, branch_ends(network)[node]);
}

std::vector<Stretch> stretches_of(const Network& network, const Cluster& cluster) {
  std::vector<Stretch> stretches;
  for (const Hub& hub : cluster) {
    for (const Arm& arm : hub.arms) {
      const double length = network.branches[arm.branch].length();
      stretches.push_back({arm.branch, arm.end == 0 ? 0.0 : length - arm.cap, arm.end == 0 ? arm.cap : length});
    }
  }
  return stretches;
}

std::vector<Cluster> find_clusters(const Network& network, const ImplicitSurface& surface,
                                   const Placement& placement) {
  std::vector<Hub> hubs = lone_hubs(network, surface);
  std::vector<std::vector<int>> groups = link_hubs(network, hubs);
  for (int round = 0; round < 4 && clear_of_groups(network, surface, groups, hubs); ++round) {
    groups = link_hubs(network, hubs);
  }
  finish_arms(network, placement, hubs);
  std::vector<Cluster> clusters;
  for (const std::vector<int>& list : groups) {
    std::map<int, int> position;
    for (std::size_t i = 0; i < list.size(); ++i) {
      position[list[i]] = static_cast<int>(i);
    }
    Cluster cluster;
    for (const int h : list) {
      cluster.push_back(hubs[h]);
      for (Arm& arm : cluster.back().arms) {
        if (arm.link >= 0) {
          arm.link = position[arm.link];
        }
      }
    }
    clusters.push_back(std::move(cluster));
  }
  return clusters;
}

}  // namespace vasohex
