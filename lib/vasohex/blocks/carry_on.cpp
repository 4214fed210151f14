#include "vasohex/blocks/carry_on.h"

#include <algorithm>
#include <optional>

#include "vasohex/blocks/split_hub.h"

namespace vasohex {
namespace {

/// Whether the tubes overlap all along the link, and the other arm goes on from there.
bool run_together(const Arm& link, const Arm& other) {
  const double length = length_of(link.axis);
  return length_of(other.axis) > length + other.radius && parting_length(link.axis, other.axis) >= length;
}

/// The line between the two axes, as long as the first.
ArmAxis middle_line(const ArmAxis& a, const ArmAxis& b) {
  ArmAxis line;
  double s = 0;
  for (std::size_t i = 0; i < a.points.size(); ++i) {
    s += i > 0 ? (a.points[i] - a.points[i - 1]).norm() : 0.0;
    const ArmPoint p = middle_of({{a.points[i], a.radii[i]}, arm_point(b, s)});
    line.points.push_back(p.position);
    line.radii.push_back(p.radius);
  }
  return line;
}

/// The other end of a link.
Arm& back_of(Cluster& cluster, const Arm& link) {
  std::vector<Arm>& arms = cluster[link.link].arms;
  return *std::find_if(arms.begin(), arms.end(),
                       [&](const Arm& a) { return a.branch == link.branch && a.end != link.end; });
}

bool share_neighbour(const Hub& hub) {
  return std::any_of(hub.arms.begin(), hub.arms.end(), [&](const Arm& a) {
    return a.link >= 0 &&
           std::count_if(hub.arms.begin(), hub.arms.end(), [&](const Arm& b) { return b.link == a.link; }) > 1;
  });
}

/// Hub `h` gone, which has a link, arm `l`, and one other arm: that one starts at the link's other end.
void join_two_arms(Cluster& cluster, int h, int l) {
  const Arm link = cluster[h].arms[l];
  Arm joined = cluster[h].arms[1 - l];
  ArmAxis axis = reversed(link.axis);
  axis.points.insert(axis.points.end(), joined.axis.points.begin() + 1, joined.axis.points.end());
  axis.radii.insert(axis.radii.end(), joined.axis.radii.begin() + 1, joined.axis.radii.end());
  joined.axis = axis;
  if (joined.link >= 0) {
    Arm& back = back_of(cluster, joined);
    back.axis = reversed(axis);
    back.link = link.link;
  }
  back_of(cluster, link) = joined;
  cluster.erase(cluster.begin() + h);
  for (Hub& hub : cluster) {
    for (Arm& arm : hub.arms) {
      arm.link -= arm.link > h ? 1 : 0;
    }
  }
}

/// Arm `a` of hub `h` carried on along its arm `l`, a link; and the hub it starts at then.
std::optional<std::pair<Cluster, int>> carried(const Cluster& cluster, int h, int l, int a) {
  Cluster out = cluster;
  int to = out[h].arms[l].link;
  const Arm other = out[h].arms[a];
  ArmAxis middle = middle_line(out[h].arms[l].axis, other.axis);
  middle.points.front() = out[h].centre;
  out[to].centre = middle.points.back();
  out[h].arms[l].axis = middle;
  back_of(out, out[h].arms[l]).axis = reversed(middle);
  if (other.link >= 0) {
    back_of(out, other).link = to;
  }
  out[to].arms.push_back(other);
  out[h].arms.erase(out[h].arms.begin() + a);
  if (out[h].arms.size() == 2) {
    join_two_arms(out, h, l > a ? l - 1 : l);
    to -= to > h ? 1 : 0;
  }
  const bool possible = out[to].arms.size() <= kCubeArms && std::none_of(out.begin(), out.end(), share_neighbour) &&
                        std::none_of(out[to].arms.begin(), out[to].arms.end(),
                                     [&](const Arm& arm) { return arm.link == to; });
  if (!possible || !renew_axes(out)) {
    return {};
  }
  return std::pair(out, to);
}

}  // namespace

std::vector<std::pair<Cluster, int>> carry_on(const Cluster& cluster, int h) {
  std::vector<std::pair<Cluster, int>> all;
  const auto carry_from = [&](const Cluster& now, int hub, int only) {
    std::vector<std::pair<Cluster, int>> found;
    const std::vector<Arm>& arms = now[hub].arms;
    for (int l = 0; l < static_cast<int>(arms.size()); ++l) {
      for (int a = 0; a < static_cast<int>(arms.size()); ++a) {
        if (a == l || arms[l].link < 0 || arms[a].link == arms[l].link || (only >= 0 && a != only) ||
            !run_together(arms[l], arms[a])) {
          continue;
        }
        if (auto c = carried(now, hub, l, a)) {
          found.push_back(std::move(*c));
        }
      }
    }
    return found;
  };
  for (auto& first : carry_from(cluster, h, -1)) {
    all.push_back(std::move(first));
    // an arm that was carried is the last one of its new hub
    for (std::size_t hubs = cluster.size(); hubs > 0; --hubs) {
      const auto [now, at] = all.back();
      auto next = carry_from(now, at, static_cast<int>(now[at].arms.size()) - 1);
      if (next.empty()) {
        break;
      }
      all.push_back(std::move(next.front()));
    }
  }
  return all;
}

}  // namespace vasohex
