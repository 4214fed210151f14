#include "vasohex/skeleton/buried.h"

#include <algorithm>
#include <limits>
#include <set>
#include <tuple>
#include <utility>

#include "vasohex/core/short_text.h"

namespace vasohex {
namespace {

constexpr double kDeep = 0.75;  // of the radius from the axis; further out, narrow forks reach into each other too

/// The point of a branch at a distance from one of its ends.
Vec3 from_end(const Network& network, const BranchEnd& end, double s) {
  const Branch& branch = network.branches[end.branch];
  return axis_point(branch, end.end == 0 ? s : branch.length() - s).position;
}

/// Whether the axis of a branch lies in the tube of another at the same node, all along.
bool lies_in(const Network& network, const Branch& branch, const BranchEnd& other) {
  const Branch& host = network.branches[other.branch];
  for (const Vec3& p : branch.points) {
    double depth = std::numeric_limits<double>::infinity();  // distance from the wall, negative: inside
    for (std::size_t i = 0; i + 1 < host.points.size() && depth >= 0; ++i) {
      const double from = other.end == 0 ? host.arc[i] : host.length() - host.arc[i + 1];
      if (from > 2 * branch.length()) {
        continue;
      }
      const double t = nearest_on_segment(p, host.points[i], host.points[i + 1]);
      const Vec3 nearest = host.points[i] + t * (host.points[i + 1] - host.points[i]);
      depth = (nearest - p).norm() - ((1 - t) * host.radii[i] + t * host.radii[i + 1]);
    }
    if (depth >= 0) {
      return false;
    }
  }
  return true;
}

/// Of two branches that lie in each other the one that is the vessel: the wider, then the longer one.
bool is_rather_the_vessel(const Network& network, const BranchEnd& a, const BranchEnd& b) {
  const auto rank = [&](const BranchEnd& e) {
    const Branch& branch = network.branches[e.branch];
    return std::tuple(mean_radius(branch), branch.length(), e.branch);
  };
  return rank(a) > rank(b);
}

}  // namespace

void add_stubs(const Network& network, std::vector<Finding>& findings) {
  const auto ends = branch_ends(network);
  for (std::size_t n = 0; n < network.nodes.size(); ++n) {
    if (network.nodes[n].degree < 3) {
      continue;
    }
    const auto is_free = [&](const BranchEnd& e) {
      return network.nodes[network.branches[e.branch].nodes[1 - e.end]].degree == 1;
    };
    for (const BranchEnd& end : ends[n]) {
      const Branch& branch = network.branches[end.branch];
      if (!is_free(end)) {
        continue;
      }
      // a side branch: two others form a vessel that goes on, and it lies in one of them
      const BranchEnd* host = nullptr;
      bool goes_on = false;
      for (const BranchEnd& a : ends[n]) {
        if (a.branch == end.branch) {
          continue;
        }
        const double reach = network.nodes[n].radius;
        const Vec3 along = from_end(network, a, reach) - network.nodes[n].position;
        for (const BranchEnd& b : ends[n]) {
          goes_on |= b.branch != end.branch && b.branch != a.branch &&
                     along.dot(from_end(network, b, reach) - network.nodes[n].position) < 0;
        }
        if (host == nullptr && lies_in(network, branch, a)) {
          const bool mutual = is_free(a) && lies_in(network, network.branches[a.branch], end);
          host = !mutual || is_rather_the_vessel(network, a, end) ? &a : nullptr;
        }
      }
      if (host == nullptr || !goes_on) {
        continue;
      }
      const NetworkNode& tip = network.nodes[branch.nodes[1 - end.end]];
      Finding f;
      f.kind = FindingKind::stub;
      f.severity = Severity::warning;
      f.branches = {end.branch, host->branch};
      f.at = tip.position;
      f.point = tip.point;
      f.figure = branch.length() / network.nodes[n].radius;
      f.text = vessel_text(network, end.branch) + " ends at " + short_text(f.at) + " inside " +
               vessel_text(network, host->branch) + ", " + short_text(branch.length()) +
               " long where the parent's radius is " + short_text(network.nodes[n].radius) +
               ": the mesh lengthens it until it sticks out";
      f.cure = "leave it out (--repair does, unless it has a name), or lengthen it";
      findings.push_back(f);
    }
  }
}

void add_unjoined(const Network& network, const std::vector<Contact>& contacts, std::vector<Finding>& findings) {
  std::set<std::pair<int, int>> told;  // branches whose overlap is
  const auto tell = [&](const std::array<int, 2>& b) { told.insert(std::minmax(b[0], b[1])); };
  for (const Contact& contact : contacts) {
    for (const Meeting& m : contact.meetings) {
      tell(m.branches);
    }
  }
  for (const Finding& f : findings) {
    if (f.kind == FindingKind::stub) {
      tell(f.branches);
    }
  }
  const auto ends = branch_ends(network);
  std::vector<int> by_x;
  for (int n = 0; n < static_cast<int>(network.nodes.size()); ++n) {
    if (!network.nodes[n].seam) {
      by_x.push_back(n);
    }
  }
  const auto x = [&](int n) { return network.nodes[n].position.x(); };
  std::stable_sort(by_x.begin(), by_x.end(), [&](int a, int b) { return x(a) < x(b); });
  for (int b = 0; b < static_cast<int>(network.branches.size()); ++b) {
    const Branch& host = network.branches[b];
    Box box;  // of what is deep
    for (std::size_t i = 0; i < host.points.size(); ++i) {
      const Vec3 reach = Vec3::Constant(kDeep * host.radii[i]);
      box.add(host.points[i] - reach);
      box.add(host.points[i] + reach);
    }
    // an end of the vessel is no junction that it could be in
    std::array<double, 2> inside{};
    for (int end = 0; end < 2; ++end) {
      const NetworkNode& node = network.nodes[host.nodes[end]];
      inside[end] = node.degree > 2 ? node.radius : 0;
    }
    for (auto it = std::lower_bound(by_x.begin(), by_x.end(), box.min.x(), [&](int n, double v) { return x(n) < v; });
         it != by_x.end() && x(*it) <= box.max.x(); ++it) {
      const int n = *it;
      const NetworkNode& node = network.nodes[n];
      const bool meets = std::any_of(ends[n].begin(), ends[n].end(), [&](const BranchEnd& e) {
        return e.branch == b || told.contains(std::minmax(e.branch, b));
      });
      if (meets || (node.position.array() < box.min.array()).any() || (node.position.array() > box.max.array()).any()) {
        continue;
      }
      double distance = std::numeric_limits<double>::infinity(), arc = 0;
      for (std::size_t i = 0; i + 1 < host.points.size(); ++i) {
        const double d = distance_to_segment(node.position, host.points[i], host.points[i + 1]);
        if (d < distance) {
          const double t = nearest_on_segment(node.position, host.points[i], host.points[i + 1]);
          distance = d;
          arc = (1 - t) * host.arc[i] + t * host.arc[i + 1];
        }
      }
      const double radius = axis_point(host, arc).radius;
      if (distance >= kDeep * radius || arc <= inside[0] || host.length() - arc <= inside[1]) {
        continue;
      }
      Finding f;
      f.kind = FindingKind::unjoined;
      f.severity = Severity::warning;
      f.branches = {ends[n].front().branch, b};
      f.at = node.position;
      f.point = node.point;
      f.figure = distance / radius;
      f.text = "point " + std::to_string(node.point) + " at " + short_text(node.position) + " lies inside " +
               vessel_text(network, b) + ", " + short_text(distance) + " from its axis where its radius is " +
               short_text(radius) + ", and no junction joins them: both are meshed in the same space";
      f.cure =
          "make it a point of that vessel if blood flows between them; else move it out of there, or lower the radii";
      findings.push_back(f);
    }
  }
}

}  // namespace vasohex
