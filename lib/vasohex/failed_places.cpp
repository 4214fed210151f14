#include "vasohex/failed_places.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>

#include "vasohex/blocks/arm_axis.h"
#include "vasohex/core/short_text.h"

namespace vasohex {
namespace {

constexpr double kNear = 6;       // radii from an element to the finding that is its reason
constexpr double kNearOther = 2;  // the same of findings about other branches
constexpr double kNearCut = 2;    // radii of an end around it

std::string name_of_place(const Network& network, int place) {
  if (place < 0) {
    const NetworkNode& node = network.nodes[-1 - place];
    return "the junction at point " + std::to_string(node.point) + " " + short_text(node.position);
  }
  const std::array<int, 2>& nodes = network.branches[place].nodes;
  return "the vessel from point " + std::to_string(network.nodes[nodes[0]].point) + " to point " +
         std::to_string(network.nodes[nodes[1]].point);
}

double radius_at(const Network& network, int place) {
  return place < 0 ? network.nodes[-1 - place].radius : mean_radius(network.branches[place]);
}

/// The branch that ends next to x before it has left its junction; -1: none.
int cut_at_junction(const Network& network, const Vec3& x) {
  for (std::size_t b = 0; b < network.branches.size(); ++b) {
    const Branch& branch = network.branches[b];
    for (int side = 0; side < 2; ++side) {
      const NetworkNode &end = network.nodes[branch.nodes[side]], &junction = network.nodes[branch.nodes[1 - side]];
      if (end.degree == 1 && junction.degree > 2 && branch.length() < end.radius + junction.radius &&
          (x - end.position).norm() < kNearCut * end.radius) {
        return static_cast<int>(b);
      }
    }
  }
  return -1;
}

/// The finding nearest to the place's worst element, one about a branch of the place if there is one; -1: none.
int nearest_finding(const Network& network, const std::vector<Finding>& findings, const FailedPlace& failed) {
  int nearest = -1;
  std::pair<bool, double> least{true, kNear * radius_at(network, failed.place)};
  for (std::size_t i = 0; i < findings.size(); ++i) {
    const Finding& f = findings[i];
    if (f.severity == Severity::note) {
      continue;
    }
    bool own = false;
    for (const int b : f.branches) {
      own |= b >= 0 && (failed.place >= 0 ? b == failed.place
                                          : network.branches[b].nodes[0] == -1 - failed.place ||
                                                network.branches[b].nodes[1] == -1 - failed.place);
    }
    const double distance = (f.at - failed.at).norm();
    if (distance < (own ? kNear : kNearOther) * radius_at(network, failed.place) &&
        std::pair(!own, distance) < least) {
      least = {!own, distance};
      nearest = static_cast<int>(i);
    }
  }
  return nearest;
}

constexpr double kPartLate = 4;  // radii: block layouts whose cubes stand at the junction have to reach as far

/// The axis of the branch from one of its ends on.
ArmAxis axis_from(const Branch& branch, int end) {
  const ArmAxis axis{branch.points, branch.radii};
  return end == 0 ? axis : reversed(axis);
}

/// How far from the junction, in its radii, the tubes of two of its branches still overlap, at most.
double latest_parting(const Network& network, int n, const std::vector<BranchEnd>& ends) {
  double latest = 0;
  for (std::size_t i = 0; i < ends.size(); ++i) {
    const ArmAxis axis = axis_from(network.branches[ends[i].branch], ends[i].end);
    for (std::size_t j = i + 1; j < ends.size(); ++j) {
      latest = std::max(latest, parting_length(axis, axis_from(network.branches[ends[j].branch], ends[j].end)));
    }
  }
  return latest / network.nodes[n].radius;
}

/// What a junction looks like: of its branches the narrowest angle and the radii, where the last two part, at
/// `parting`, and how near the next junction is.
std::string shape_of(const Network& network, int n, const std::vector<BranchEnd>& ends, double parting) {
  const NetworkNode& node = network.nodes[n];
  std::vector<Vec3> directions;
  double thin = std::numeric_limits<double>::infinity(), wide = 0, near = std::numeric_limits<double>::infinity();
  for (const BranchEnd& end : ends) {
    const Branch& b = network.branches[end.branch];
    const double s = std::min(2 * node.radius, b.length());
    const AxisPoint p = axis_point(b, end.end == 0 ? s : b.length() - s);
    directions.push_back(p.position - node.position);
    thin = std::min(thin, p.radius);
    wide = std::max(wide, p.radius);
    if (network.nodes[b.nodes[1 - end.end]].degree > 2) {
      near = std::min(near, b.length() / node.radius);
    }
  }
  double narrowest = std::numbers::pi;
  for (std::size_t i = 0; i < directions.size(); ++i) {
    for (std::size_t j = i + 1; j < directions.size(); ++j) {
      narrowest = std::min(narrowest, angle_between(directions[i], directions[j]));
    }
  }
  std::string text = "no arrangement of blocks came out valid for " + std::to_string(directions.size()) +
                     " branches, two radii from the junction " +
                     short_text(std::round(narrowest * 180 / std::numbers::pi)) + " degrees apart at least, radii " +
                     short_text(thin) + " to " + short_text(wide);
  if (parting > kPartLate) {
    text += ", two of them in one tube up to " + hundredths(parting) + " radii from it";
  }
  if (std::isfinite(near)) {
    text += ", the next junction " + hundredths(near) + " radii away";
  }
  return text;
}

}  // namespace

std::vector<FailedPlace> failed_places(const Network& network, const std::vector<Finding>& findings,
                                       const HexMesh& mesh, const QualityReport& quality) {
  std::map<int, FailedPlace> by_place;
  for (int e = 0; e < mesh.element_count(); ++e) {
    if (quality.element_validity[e].state == ValidityState::certified) {
      continue;
    }
    const int place = mesh.element_branch.at(e);
    const auto [it, is_new] = by_place.try_emplace(place);
    FailedPlace& failed = it->second;
    ++failed.elements;
    if (is_new || quality.element_scaled_jacobian[e] < failed.scaled_jacobian) {
      failed.place = place;
      failed.scaled_jacobian = quality.element_scaled_jacobian[e];
      failed.at = Vec3::Zero();
      const int n = mesh.nodes_per_element();
      for (int i = 0; i < n; ++i) {
        failed.at += mesh.nodes[mesh.elements[static_cast<std::size_t>(e) * n + i]] / n;
      }
    }
  }
  const std::vector<std::vector<BranchEnd>> ends = branch_ends(network);
  std::vector<FailedPlace> all;
  for (auto& [place, failed] : by_place) {
    failed.text = name_of_place(network, place) + ": " + std::to_string(failed.elements) +
                  (failed.elements == 1 ? " element is" : " elements are") +
                  " not certified, least scaled Jacobian " + hundredths(failed.scaled_jacobian) + " at " +
                  short_text(failed.at);
    const int cut = cut_at_junction(network, failed.at);
    failed.finding = cut >= 0 ? -1 : nearest_finding(network, findings, failed);
    if (cut >= 0) {
      failed.reason =
          name_of_place(network, cut) + " is cut " + short_text(network.branches[cut].length()) +
          " from its junction, before its wall has left the other vessels': some of it meets the cut at a "
          "flat angle";
      failed.cure = "cut the vessel two radii or more from the junction";
    } else if (failed.finding >= 0) {
      failed.reason = findings[failed.finding].text;
      failed.cure = findings[failed.finding].cure;
    } else if (place < 0) {
      const int node = -1 - place;
      const double parting = latest_parting(network, node, ends[node]);
      failed.reason = shape_of(network, node, ends[node], parting);
      failed.cure = parting > kPartLate
                        ? "move the junction to where its branches part, or lower their radii up to there"
                        : "check the points and radii there; junctions that are one make one point";
    } else {
      failed.reason = "its blocks follow points and radii that change too fast there";
      failed.cure = "check the points and radii there, or smooth them";
    }
    all.push_back(std::move(failed));
  }
  std::stable_sort(all.begin(), all.end(),
                   [](const FailedPlace& a, const FailedPlace& b) { return a.scaled_jacobian < b.scaled_jacobian; });
  return all;
}

}  // namespace vasohex
