#include "vasohex/blocks/hubs.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>

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

/// Whether the surface around the axis point is a tube of about its radius, seen along 12 rays in the normal plane.
bool is_tube(const ImplicitSurface& surface, const AxisPoint& p) {
  const SectionFrame f = frame_at(p);
  for (int ray = 0; ray < 12; ++ray) {
    const double angle = ray * std::numbers::pi / 6;
    const Vec3 direction = std::cos(angle) * f.x + std::sin(angle) * f.y;
    const auto t = shoot(surface, f.origin, direction, f.radius, 1.3 * f.radius);
    if (!t || *t > 1.2 * f.radius || *t < 0.7 * f.radius) {
      return false;
    }
  }
  return true;
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

std::vector<Cluster> find_clusters(const Network& network, const ImplicitSurface& surface) {
  const auto ends = branch_ends(network);
  std::vector<int> hub_of_node(network.nodes.size(), -1);
  std::vector<Hub> hubs;
  std::vector<std::array<double, 2>> cap(network.branches.size(), {0, 0});
  for (int n = 0; n < static_cast<int>(network.nodes.size()); ++n) {
    const NetworkNode& node = network.nodes[n];
    if (node.seam || node.degree < 2) {
      continue;
    }
    hub_of_node[n] = static_cast<int>(hubs.size());
    Hub hub;
    hub.node = n;
    hub.centre = node.position;
    const std::vector<double> distance = cap_distances_of(network, ends[n]);
    for (std::size_t a = 0; a < ends[n].size(); ++a) {
      Arm arm;
      arm.branch = ends[n][a].branch;
      arm.end = ends[n][a].end;
      const Branch& branch = network.branches[arm.branch];
      arm.cap = std::min(distance[a], branch.length());
      hub.arms.push_back(arm);
    }
    const std::shared_ptr<const ImplicitSurface> around = surface.part(stretches_of(network, {hub}));
    for (std::size_t a = 0; a < ends[n].size(); ++a) {
      Arm& arm = hub.arms[a];
      const Branch& branch = network.branches[arm.branch];
      const bool leads_to_end = network.nodes[branch.nodes[1 - arm.end]].degree == 1;
      arm.cap = distance[a];
      // the formula knows straight tubes only: move on until the surface is a tube
      for (int step = 0; step < 12 && arm.cap < branch.length(); ++step) {
        const AxisPoint p = from_end(branch, arm.end, arm.cap);
        if (is_tube(*around, p)) {
          break;
        }
        arm.cap += 0.25 * p.radius;
      }
      if (leads_to_end && arm.cap > branch.length() - 0.4 * branch.radii.back()) {
        arm.cap = branch.length();  // the cap is the end itself
      }
      cap[arm.branch][arm.end] = arm.cap;
    }
    hubs.push_back(hub);
  }

  std::vector<int> leader(hubs.size());
  std::iota(leader.begin(), leader.end(), 0);
  const auto find = [&](int h) {
    while (leader[h] != h) {
      h = leader[h] = leader[leader[h]];
    }
    return h;
  };
  // Branches too short for two caps become links, the shortest of those between the same two hubs: a second one would
  // share faces with it.
  std::map<std::array<int, 2>, int> link_between;
  for (int b = 0; b < static_cast<int>(network.branches.size()); ++b) {
    const Branch& branch = network.branches[b];
    const int first = hub_of_node[branch.nodes[0]], last = hub_of_node[branch.nodes[1]];
    const double radius = from_end(branch, 0, 0.5 * branch.length()).radius;
    if (first >= 0 && last >= 0 && first != last && cap[b][0] + cap[b][1] + 0.75 * radius > branch.length()) {
      const auto [it, is_new] = link_between.try_emplace({std::min(first, last), std::max(first, last)}, b);
      if (!is_new && branch.length() < network.branches[it->second].length()) {
        it->second = b;
      }
    }
  }
  for (Hub& hub : hubs) {
    for (Arm& arm : hub.arms) {
      const Branch& branch = network.branches[arm.branch];
      const int other = hub_of_node[branch.nodes[1 - arm.end]];
      const double length = branch.length();
      const double middle_radius = from_end(branch, arm.end, 0.5 * length).radius;
      const int self = hub_of_node[hub.node];
      const double both = cap[arm.branch][0] + cap[arm.branch][1];
      const auto link = link_between.find({std::min(self, other), std::max(self, other)});
      if (link != link_between.end() && link->second == arm.branch) {
        arm.link = other;
        arm.cap = length;
        leader[std::max(find(self), find(other))] = std::min(find(self), find(other));
      } else if (other >= 0 && both + 0.3 * middle_radius > length) {
        arm.cap *= (length - 0.3 * middle_radius) / both;  // a tight loop
      }
      const AxisPoint p = from_end(branch, arm.end, arm.cap);
      arm.direction = (p.position - hub.centre).normalized();
      arm.radius = arm.link >= 0 ? middle_radius : p.radius;
      arm.section = frame_at(p);
      constexpr int kPieces = 24;
      for (int i = 0; i <= kPieces; ++i) {
        arm.axis.push_back(from_end(branch, arm.end, arm.cap * i / kPieces).position);
      }
    }
  }
  std::map<int, std::vector<int>> members;
  for (int h = 0; h < static_cast<int>(hubs.size()); ++h) {
    members[find(h)].push_back(h);
  }
  std::vector<Cluster> clusters;
  for (const auto& [first, list] : members) {
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
