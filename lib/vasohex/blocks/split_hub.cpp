#include "vasohex/blocks/split_hub.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <optional>
#include <utility>

namespace vasohex {
namespace {

using Group = std::vector<int>;  ///< arms that share a cube
constexpr int kMostOfGroup = 4;

/// The widest angle between two arms of a group.
double spread(const Hub& hub, const Group& group) {
  double widest = 0;
  for (std::size_t a = 0; a < group.size(); ++a) {
    for (std::size_t b = a + 1; b < group.size(); ++b) {
      widest = std::max(widest, angle_between(hub.arms[group[a]].direction, hub.arms[group[b]].direction));
    }
  }
  return widest;
}

/// All pairs, triples and, of many arms, quadruples that might share a cube, the narrowest first.
std::vector<std::pair<double, Group>> groups_of(const Hub& hub) {
  constexpr double kWidest = 100 * std::numbers::pi / 180;
  const int arms = static_cast<int>(hub.arms.size());
  std::vector<std::pair<double, Group>> all;
  const auto add = [&](const Group& group) {
    // rounded: of equal angles, rounding must not decide
    const double angle = std::round(spread(hub, group) * 1e6) / 1e6;
    if (angle < kWidest || arms > kCubeArms) {
      // four on a cube's sides, around the one that leads to the others, are as well placed as two at half the angle
      all.emplace_back(group.size() == 4 ? 0.5 * angle : angle, group);
    }
  };
  for (int i = 0; i < arms; ++i) {
    for (int j = i + 1; j < arms; ++j) {
      add({i, j});
      for (int k = j + 1; k < arms; ++k) {
        add({i, j, k});
        for (int l = k + 1; l < arms && arms > kCubeArms; ++l) {
          add({i, j, k, l});
        }
      }
    }
  }
  std::stable_sort(all.begin(), all.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  return all;
}

/// Ways of grouping the arms that leave a cube no more than it can take; those with the narrowest groups first.
std::vector<std::vector<Group>> groupings(const Hub& hub) {
  constexpr std::size_t kMost = 96;  // enough: the good ones are among the narrow ones
  const int arms = static_cast<int>(hub.arms.size());
  const std::vector<std::pair<double, Group>> groups = groups_of(hub);
  const std::size_t most_groups = arms <= 9 ? 3 : (arms - kCubeArms + 1) / 2 + 1;
  std::vector<std::vector<Group>> all;
  std::vector<char> used(arms, 0);
  std::vector<Group> chosen;
  // groups are taken in descending order: the first one of a choice is its widest
  std::function<void(std::size_t, int)> choose = [&](std::size_t g, int left) {
    const Group& group = groups[g].second;
    if (all.size() >= kMost || std::any_of(group.begin(), group.end(), [&](int a) { return used[a]; })) {
      return;
    }
    const int now = left - static_cast<int>(group.size()) + 1;
    const int groups_left = static_cast<int>(most_groups - chosen.size()) - 1;
    if (now - groups_left * (kMostOfGroup - 1) > kCubeArms) {
      return;
    }
    for (const int a : group) {
      used[a] = 1;
    }
    chosen.push_back(group);
    if (now <= kCubeArms) {
      all.push_back(chosen);
    }
    for (std::size_t narrower = 0; narrower < g && chosen.size() < most_groups; ++narrower) {
      choose(narrower, now);
    }
    chosen.pop_back();
    for (const int a : group) {
      used[a] = 0;
    }
  };
  for (std::size_t widest = 0; widest < groups.size(); ++widest) {
    choose(widest, arms);
  }
  return all;
}

/// The way from the hub to the cube of a group, in the middle of its arms, as far as where the first two of them
/// part: measured on junctions of 6 to 8 branches, cubes half as far are too near that in the middle. Empty if the
/// arms have no middle.
ArmAxis way_to_cube(const Hub& hub, const Group& group) {
  double end = 1e300, radius = 0;
  for (std::size_t a = 0; a < group.size(); ++a) {
    radius = std::max(radius, hub.arms[group[a]].radius);
    for (std::size_t b = a + 1; b < group.size(); ++b) {
      end = std::min(end, parting_length(hub.arms[group[a]].axis, hub.arms[group[b]].axis));
    }
  }
  const int pieces = std::max(2, static_cast<int>(std::ceil(end / (0.25 * radius))));
  ArmAxis way;
  for (int i = 0; i <= pieces; ++i) {
    std::vector<ArmPoint> places;
    for (const int a : group) {
      places.push_back(arm_point(hub.arms[a].axis, end * i / pieces));
    }
    way.points.push_back(middle_of(places).position);
    way.radii.push_back(1.15 * radius);
  }
  return (way.points.back() - hub.centre).norm() > 0.05 * end ? way : ArmAxis{};
}

ArmAxis straight(const Vec3& from, const Vec3& to, double radius) {
  ArmAxis axis;
  const int pieces = std::max(1, static_cast<int>(std::ceil((to - from).norm() / (0.25 * radius))));
  for (int i = 0; i <= pieces; ++i) {
    axis.points.push_back(from + static_cast<double>(i) / pieces * (to - from));
    axis.radii.push_back(radius);
  }
  return axis;
}

/// The axis, started from another point: what lies behind or beside it is left out.
ArmAxis started_from(const ArmAxis& axis, const Vec3& start) {
  std::size_t nearest = 0;
  for (std::size_t i = 1; i < axis.points.size(); ++i) {
    if ((axis.points[i] - start).norm() < (axis.points[nearest] - start).norm()) {
      nearest = i;
    }
  }
  ArmAxis out{{start}, {axis.radii[nearest]}};
  double on = 0;
  for (std::size_t i = nearest + 1; i < axis.points.size(); ++i) {
    on += (axis.points[i] - axis.points[i - 1]).norm();
    if (on > 0.5 * axis.radii[i] || i + 1 == axis.points.size()) {
      out.points.push_back(axis.points[i]);
      out.radii.push_back(axis.radii[i]);
    }
  }
  return out;
}

/// Adds a link between two hubs of the cluster; `id` < 0 names it, as branches are named by numbers >= 0.
void link(Cluster& cluster, int a, int b, int id, const ArmAxis& axis) {
  for (int end = 0; end < 2; ++end) {
    Arm arm;
    arm.branch = id;
    arm.end = end;
    arm.link = end == 0 ? b : a;
    arm.cap = length_of(axis);
    arm.radius = axis.radii.front();
    arm.axis = end == 0 ? axis : reversed(axis);
    cluster[end == 0 ? a : b].arms.push_back(arm);
  }
}

std::optional<Cluster> split(const Cluster& cluster, int h, const std::vector<Group>& groups) {
  const Hub& hub = cluster[h];
  std::vector<char> grouped(hub.arms.size(), 0);
  std::vector<Hub> subs;
  std::vector<ArmAxis> ways;
  double mean_radius = 0;
  for (const Arm& arm : hub.arms) {
    mean_radius += arm.radius / hub.arms.size();
  }
  for (const Group& group : groups) {
    Hub sub;
    sub.node = hub.node;
    for (const int a : group) {
      grouped[a] = 1;
      sub.arms.push_back(hub.arms[a]);
    }
    ways.push_back(way_to_cube(hub, group));
    if (ways.back().points.empty()) {
      return {};
    }
    sub.centre = ways.back().points.back();
    subs.push_back(sub);
  }
  const int rest = static_cast<int>(std::count(grouped.begin(), grouped.end(), 0));
  Hub main;
  main.node = hub.node;
  main.centre = hub.centre;
  for (std::size_t a = 0; a < hub.arms.size(); ++a) {
    if (!grouped[a]) {
      main.arms.push_back(hub.arms[a]);
    }
  }
  Cluster out = cluster;
  // numbers below those of the links that are there already
  int id = -1;
  for (const Hub& other : cluster) {
    for (const Arm& arm : other.arms) {
      id = std::min(id, arm.branch - 1);
    }
  }
  if (rest + static_cast<int>(groups.size()) >= 3) {
    // the middle cube gives way to those near it
    Vec3 away = Vec3::Zero();
    for (const Hub& sub : subs) {
      const Vec3 d = sub.centre - hub.centre;
      away -= 0.5 * std::max(0.0, 1.6 * mean_radius - d.norm()) * d.normalized();
    }
    const double most = 0.6 * mean_radius;
    main.centre += away.norm() > most ? Vec3(most * away.normalized()) : away;
    out[h] = main;
    for (std::size_t g = 0; g < subs.size(); ++g) {
      out.push_back(subs[g]);
      link(out, h, static_cast<int>(out.size()) - 1, id--, ways[g]);
    }
  } else if (groups.size() == 2 && rest == 0) {
    out[h] = subs[0];
    out.push_back(subs[1]);
    link(out, h, static_cast<int>(out.size()) - 1, id--, straight(subs[0].centre, subs[1].centre, 1.2 * mean_radius));
  } else if (groups.size() == 1 && rest <= 1) {
    out[h] = subs[0];  // one cube, moved towards the crotch
    out[h].arms.insert(out[h].arms.end(), main.arms.begin(), main.arms.end());
  } else {
    return {};
  }
  // links from other hubs follow their arms; directions are seen from the new centres
  for (int s = 0; s < static_cast<int>(out.size()); ++s) {
    for (Arm& arm : out[s].arms) {
      if (arm.link >= 0) {
        for (Arm& back : out[arm.link].arms) {
          if (back.branch == arm.branch && back.end != arm.end) {
            back.link = s;
          }
        }
      }
    }
  }
  if (!renew_axes(out)) {
    return {};
  }
  return out;
}

}  // namespace

bool renew_axes(Cluster& cluster) {
  for (Hub& changed : cluster) {
    for (Arm& arm : changed.arms) {
      if (arm.axis.points.front() != changed.centre) {
        arm.axis = started_from(arm.axis, changed.centre);
      }
      if (arm.link >= 0 && arm.axis.points.back() != cluster[arm.link].centre) {
        arm.axis = reversed(started_from(reversed(arm.axis), cluster[arm.link].centre));
      }
      if (arm.axis.points.size() < 2) {
        return false;
      }
      arm.direction = direction_of(arm);
    }
  }
  return true;
}

std::vector<Cluster> split_hub(const Cluster& cluster, int h) {
  std::vector<Cluster> all;
  for (const std::vector<Group>& groups : groupings(cluster[h])) {
    if (auto c = split(cluster, h, groups)) {
      all.push_back(std::move(*c));
    }
  }
  return all;
}

std::vector<std::pair<Cluster, int>> merge_hub(const Cluster& cluster, int h) {
  std::vector<std::pair<Cluster, int>> all;
  for (const Arm& short_link : cluster[h].arms) {
    const int other = short_link.link;
    if (other < 0) {
      continue;
    }
    double widest = short_link.radius;  // a link may lie within a wider vessel
    for (const int hub : {h, other}) {
      for (const Arm& arm : cluster[hub].arms) {
        widest = std::max(widest, arm.radius);
      }
    }
    if (length_of(short_link.axis) > 3 * widest) {
      continue;
    }
    const int kept = std::min(h, other), gone = std::max(h, other);
    Hub merged = cluster[kept];
    merged.centre = 0.5 * (cluster[h].centre + cluster[other].centre);
    merged.arms.insert(merged.arms.end(), cluster[gone].arms.begin(), cluster[gone].arms.end());
    std::erase_if(merged.arms, [&](const Arm& arm) { return arm.link == kept || arm.link == gone; });
    const bool share_neighbour = std::any_of(merged.arms.begin(), merged.arms.end(), [&](const Arm& a) {
      return a.link >= 0 && std::count_if(merged.arms.begin(), merged.arms.end(),
                                          [&](const Arm& b) { return b.link == a.link; }) > 1;
    });
    if (share_neighbour || merged.arms.size() < 3 || merged.arms.size() > kCubeArms) {
      continue;
    }
    Cluster out = cluster;
    out[kept] = merged;
    out.erase(out.begin() + gone);
    for (Hub& hub : out) {
      for (Arm& arm : hub.arms) {
        if (arm.link == gone) {
          arm.link = kept;
        } else if (arm.link > gone) {
          --arm.link;
        }
      }
    }
    if (renew_axes(out)) {
      all.emplace_back(std::move(out), kept);
    }
  }
  return all;
}

}  // namespace vasohex
