#include "vasohex/blocks/split_hub.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <tuple>

namespace vasohex {
namespace {

using Group = std::vector<int>;  ///< arms that share a cube

double angle(const Arm& a, const Arm& b) {
  return std::atan2(a.direction.cross(b.direction).norm(), a.direction.dot(b.direction));
}

/// Ways of grouping the arms, the gentlest first.
std::vector<std::vector<Group>> groupings(const Hub& hub) {
  const int arms = static_cast<int>(hub.arms.size());
  const double widest = arms > kCubeArms ? std::numbers::pi : 75 * std::numbers::pi / 180;
  std::vector<std::tuple<double, int, int>> pairs;
  for (int i = 0; i < arms; ++i) {
    for (int j = i + 1; j < arms; ++j) {
      const double a = angle(hub.arms[i], hub.arms[j]);
      if (a < widest) {
        pairs.emplace_back(a, i, j);
      }
    }
  }
  std::sort(pairs.begin(), pairs.end());
  std::vector<std::vector<Group>> all;
  std::vector<char> used(arms, 0);
  std::vector<Group> chosen;
  for (const auto& [a, i, j] : pairs) {
    if (!used[i] && !used[j]) {
      used[i] = used[j] = 1;
      chosen.push_back({i, j});
      // with fewer groups the middle cube would have too many arms
      if (arms - static_cast<int>(chosen.size()) <= kCubeArms) {
        all.push_back(chosen);
      }
    }
  }
  if (arms >= 5) {
    double least = 1.4;
    Group best;
    for (int i = 0; i < arms; ++i) {
      for (int j = i + 1; j < arms; ++j) {
        for (int k = j + 1; k < arms; ++k) {
          const double a = std::max(
              {angle(hub.arms[i], hub.arms[j]), angle(hub.arms[i], hub.arms[k]), angle(hub.arms[j], hub.arms[k])});
          if (a < least) {
            least = a;
            best = {i, j, k};
          }
        }
      }
    }
    if (!best.empty() && arms - 2 <= kCubeArms) {
      all.push_back({best});
    }
  }
  return all;
}

/// How far along their mean direction the walls of a group's arms part, for the two that part first.
double crotch_distance(const Hub& hub, const Group& group, const Vec3& mean) {
  double least = 1e300;
  for (std::size_t a = 0; a < group.size(); ++a) {
    for (std::size_t b = a + 1; b < group.size(); ++b) {
      const Arm &p = hub.arms[group[a]], &q = hub.arms[group[b]];
      const double blend = 0.14 * std::min(p.radius, q.radius);
      const double cosine = p.direction.dot(q.direction);
      const double sine = std::sqrt(std::max(1e-4, 1 - cosine * cosine));
      // the point at the distance of the radii from both axes, in their plane
      const Vec3 crotch = (q.radius + blend) / sine * p.direction + (p.radius + blend) / sine * q.direction;
      least = std::min(least, crotch.dot(mean));
    }
  }
  return least;
}

Vec3 target(const Cluster& cluster, const Arm& arm) {
  return arm.link >= 0 ? cluster[arm.link].centre : arm.axis.back();
}

/// Adds a straight link between two hubs of the cluster; `id` < 0 names it, as branches are named by numbers >= 0.
void link(Cluster& cluster, int a, int b, int id, double radius) {
  const Vec3 along = cluster[b].centre - cluster[a].centre;
  for (int end = 0; end < 2; ++end) {
    Hub& from = cluster[end == 0 ? a : b];
    Arm arm;
    arm.branch = id;
    arm.end = end;
    arm.link = end == 0 ? b : a;
    arm.cap = along.norm();
    arm.direction = (end == 0 ? along : Vec3(-along)).normalized();
    arm.radius = radius;
    arm.axis = {from.centre, cluster[arm.link].centre};
    from.arms.push_back(arm);
  }
}

std::optional<Cluster> split(const Cluster& cluster, int h, const std::vector<Group>& groups) {
  const Hub& hub = cluster[h];
  std::vector<char> grouped(hub.arms.size(), 0);
  std::vector<Hub> subs;
  double mean_radius = 0;
  for (const Arm& arm : hub.arms) {
    mean_radius += arm.radius / hub.arms.size();
  }
  for (const Group& group : groups) {
    Hub sub;
    sub.node = hub.node;
    Vec3 mean = Vec3::Zero();
    for (const int a : group) {
      mean += hub.arms[a].direction;
      grouped[a] = 1;
      sub.arms.push_back(hub.arms[a]);
    }
    if (mean.norm() < 0.1) {
      return {};
    }
    mean.normalize();
    sub.centre = hub.centre + 0.5 * crotch_distance(hub, group, mean) * mean;
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
  const auto radius_of = [](const Hub& sub) {
    double r = 0;
    for (const Arm& arm : sub.arms) {
      r = std::max(r, arm.radius);
    }
    return 1.15 * r;
  };
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
    for (const Hub& sub : subs) {
      out.push_back(sub);
      link(out, h, static_cast<int>(out.size()) - 1, id--, radius_of(sub));
    }
  } else if (groups.size() == 2 && rest == 0) {
    out[h] = subs[0];
    out.push_back(subs[1]);
    link(out, h, static_cast<int>(out.size()) - 1, id--, 1.2 * mean_radius);
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
  for (Hub& changed : out) {
    for (Arm& arm : changed.arms) {
      const Vec3 d = target(out, arm) - changed.centre;
      if (d.norm() < 1e-3 * arm.radius) {
        return {};
      }
      arm.direction = d.normalized();
    }
  }
  return out;
}

}  // namespace

std::vector<Cluster> split_hub(const Cluster& cluster, int h) {
  std::vector<Cluster> all;
  for (const std::vector<Group>& groups : groupings(cluster[h])) {
    if (auto c = split(cluster, h, groups)) {
      all.push_back(std::move(*c));
    }
  }
  return all;
}

}  // namespace vasohex
