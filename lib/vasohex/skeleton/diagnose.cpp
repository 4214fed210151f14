#include "vasohex/skeleton/diagnose.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "vasohex/core/disjoint_sets.h"
#include "vasohex/core/short_text.h"
#include "vasohex/skeleton/buried.h"
#include "vasohex/skeleton/contacts.h"

namespace vasohex {
namespace {

constexpr double kSharpBend = 1 / 1.1;
constexpr double kSteepTaper = 0.6;
constexpr double kThin = 30;    // radius of a junction over its branch's; blocks get from 1 to 28 at 30 to 90 degrees
constexpr double kTiny = 0.01;  // part of the largest component's volume

/// Components of a network.
struct Component {
  std::vector<int> branches;
  double length = 0, volume = 0, radius = 0;  // mean
};

std::vector<Component> components_of(const Network& network, std::vector<int>& component_of_branch) {
  DisjointSets joined(static_cast<int>(network.nodes.size()));
  for (const Branch& b : network.branches) {
    joined.join(b.nodes[0], b.nodes[1]);
  }
  std::map<int, int> index;
  std::vector<Component> components;
  for (std::size_t b = 0; b < network.branches.size(); ++b) {
    const Branch& branch = network.branches[b];
    const auto [it, is_new] = index.emplace(joined.find(branch.nodes[0]), static_cast<int>(components.size()));
    if (is_new) {
      components.emplace_back();
    }
    component_of_branch.push_back(it->second);
    Component& c = components[it->second];
    const double radius = mean_radius(branch), length = branch.length();
    c.branches.push_back(static_cast<int>(b));
    c.radius = (c.radius * c.length + radius * length) / (c.length + length);
    c.length += length;
    c.volume += std::numbers::pi * radius * radius * length;
  }
  return components;
}

/// Whether the axis of a branch lies in other vessels all along: the gaps between its places that do are short.
bool is_covered(const Branch& branch, std::vector<double> inside) {
  std::sort(inside.begin(), inside.end());
  inside.push_back(branch.length());
  double before = 0;
  for (const double s : inside) {
    if (s - before > 0.6 * axis_point(branch, s).radius) {
      return false;
    }
    before = s;
  }
  return inside.size() > 1;
}

Finding contact_finding(const Network& network, const Contact& contact) {
  const Meeting& m = contact.worst;
  Finding f;
  f.branches = m.branches;
  f.at = place_of(network, m);
  f.figure = std::abs(m.relative());
  const std::string radii = short_text(m.radii[0]) + " and " + short_text(m.radii[1]);
  const std::string who = who_meet(network, m);
  const std::string depth = " by " + hundredths(f.figure) + " of the smaller radius at " + short_text(f.at) +
                            " (radii " + radii + ", axes " + short_text(m.gap + m.radii[0] + m.radii[1]) + " apart)";
  switch (contact.kind) {
    case ContactKind::passing:
      if (m.gap < 0) {
        f.kind = FindingKind::overlap;
        f.text = who + " overlap" + depth + ": both are meshed, and their meshes overlap there";
        f.cure =
            "join them with a junction if blood flows between them; else smaller radii there or axes farther "
            "apart: --repair does that as far as 40 % of the radii and .5 radii of displacement allow";
      } else {
        f.kind = FindingKind::touch;
        f.severity = Severity::warning;
        f.text = who + " nearly touch at " + short_text(f.at) + ": the gap is " + hundredths(f.figure) +
                 " of the smaller radius (radii " + radii + ")";
        f.cure = "nothing, if the gap is meant; else as for overlaps, or --repair";
      }
      // a broken connection, more often than not
      for (int k = 0; k < 2; ++k) {
        const Branch& branch = network.branches[m.branches[k]];
        for (int end = 0; end < 2; ++end) {
          const NetworkNode& node = network.nodes[branch.nodes[end]];
          const double to_end = end == 0 ? m.arcs[k] : branch.length() - m.arcs[k];
          if (node.degree == 1 && to_end < 1.5 * m.radii[k]) {
            f.point = node.point;
            f.cure = "a vessel ends there, at point " + std::to_string(node.point) +
                     ": join it to the other one if blood flows between them, or shorten it";
          }
        }
      }
      break;
    case ContactKind::hairpin:
      f.kind = FindingKind::hairpin;
      f.text = vessel_text(network, m.branches[0]) + " turns back and overlaps itself" + depth;
      f.cure = "leave out the points of the detour, or give the bend a radius larger than the vessel's";
      break;
    case ContactKind::side_by_side:
      f.kind = FindingKind::side_by_side;
      f.text = who + " leave neighbouring junctions side by side and still overlap" + depth +
               ": both are meshed, and their meshes overlap there";
      f.cure = "move the junction to where the vessels part, or lower their radii up to there";
      break;
  }
  return f;
}

void add_contacts(const Network& network, const std::vector<Contact>& contacts, std::vector<Finding>& findings) {
  std::vector<int> component_of;
  const std::vector<Component> components = components_of(network, component_of);

  double largest = 0;
  for (const Component& c : components) {
    largest = std::max(largest, c.volume);
  }
  // Places of the axes that lie in another, larger component
  std::vector<std::vector<double>> inside(network.branches.size());
  std::vector<int> host(network.branches.size(), -1);
  for (const Contact& contact : contacts) {
    for (const Meeting& m : contact.meetings) {
      for (int k = 0; k < 2; ++k) {
        const int own = m.branches[k], other = m.branches[1 - k];
        if (components[component_of[own]].volume < components[component_of[other]].volume && m.gap + m.radii[k] < 0) {
          inside[own].push_back(m.arcs[k]);
          host[own] = other;
        }
      }
    }
  }
  std::vector<bool> swallowed(components.size(), false);
  for (std::size_t c = 0; c < components.size() && components.size() > 1; ++c) {
    const Component& part = components[c];
    const Branch& first = network.branches[part.branches[0]];
    swallowed[c] = std::all_of(part.branches.begin(), part.branches.end(),
                               [&](int b) { return is_covered(network.branches[b], inside[b]); });
    const bool tiny = part.length < 2 * part.radius && part.volume < kTiny * largest;
    if (!swallowed[c] && !tiny) {
      continue;
    }
    Finding f;
    f.kind = FindingKind::fragment;
    f.severity = swallowed[c] ? Severity::error : Severity::warning;
    f.branches = {part.branches[0], swallowed[c] ? host[part.branches[0]] : -1};
    f.at = axis_point(first, first.length() / 2).position;
    f.point = network.nodes[first.nodes[0]].point;
    f.figure = part.length / (2 * part.radius);
    f.text = "a separate piece of length " + short_text(part.length) + " and radius " + short_text(part.radius) +
             " at " + short_text(f.at) +
             (swallowed[c] ? " lies inside " + vessel_text(network, f.branches[1]) +
                                 ": both are meshed, and their meshes overlap there"
                           : " is shorter than its diameter");
    f.cure = "leave it out (--repair does), or join it to its vessel";
    findings.push_back(f);
  }
  for (const Contact& contact : contacts) {
    const std::array<int, 2>& b = contact.worst.branches;
    if (!swallowed[component_of[b[0]]] && !swallowed[component_of[b[1]]]) {
      findings.push_back(contact_finding(network, contact));
    }
  }
}

/// One finding per run of samples of a branch where a figure is above a limit.
template <class Figure, class Make>
void add_runs(const Branch& branch, double limit, const Figure& figure, const Make& make) {
  double worst = limit;
  int at = -1;
  for (std::size_t i = 0; i + 1 < branch.points.size(); ++i) {
    const double f = figure(i);
    if (f > worst) {
      worst = f;
      at = static_cast<int>(i);
    }
    if (at >= 0 && (f <= limit || i + 2 == branch.points.size())) {
      make(worst, ((branch.points[at] + branch.points[at + 1]) / 2).eval());
      worst = limit;
      at = -1;
    }
  }
}

void add_bends_and_tapers(const Network& network, std::vector<Finding>& findings) {
  for (std::size_t b = 0; b < network.branches.size(); ++b) {
    const Branch& branch = network.branches[b];
    // within a junction the axis alone says nothing about the shape
    std::array<double, 2> inside{};
    for (int end = 0; end < 2; ++end) {
      const NetworkNode& node = network.nodes[branch.nodes[end]];
      inside[end] = node.degree > 2 ? node.radius : 0;
    }
    const auto radius = [&](std::size_t i) { return (branch.radii[i] + branch.radii[i + 1]) / 2; };
    const auto step = [&](std::size_t i) { return branch.arc[i + 1] - branch.arc[i]; };
    add_runs(
        branch, kSharpBend,
        [&](std::size_t i) {
          const bool counts = branch.arc[i] >= inside[0] && branch.arc[i + 1] <= branch.length() - inside[1];
          return counts ? radius(i) * (branch.tangents[i + 1] - branch.tangents[i]).norm() / step(i) : 0;
        },
        [&](double figure, const Vec3& at) {
          Finding f;
          f.kind = FindingKind::sharp_bend;
          f.severity = figure > 1 ? Severity::error : Severity::warning;
          f.branches = {static_cast<int>(b), -1};
          f.at = at;
          f.figure = figure;
          f.text = vessel_text(network, static_cast<int>(b)) + " bends with " + hundredths(1 / figure) +
                   " times its radius at " + short_text(at) +
                   (figure > 1 ? ": its cross-sections overlap on the inner side" : "");
          f.cure = "a smaller radius there, or points along a wider bend";
          findings.push_back(f);
        });
    add_runs(
        branch, kSteepTaper, [&](std::size_t i) { return std::abs(branch.radii[i + 1] - branch.radii[i]) / step(i); },
        [&](double figure, const Vec3& at) {
          Finding f;
          f.kind = FindingKind::steep_taper;
          f.severity = Severity::warning;
          f.branches = {static_cast<int>(b), -1};
          f.at = at;
          f.figure = figure;
          f.text = "the radius of " + vessel_text(network, static_cast<int>(b)) + " changes by " + hundredths(figure) +
                   " per length at " + short_text(at);
          f.cure = "check the radii of the points there";
          findings.push_back(f);
        });
  }
}

void add_thin_branches(const Network& network, std::vector<Finding>& findings) {
  for (std::size_t b = 0; b < network.branches.size(); ++b) {
    const Branch& branch = network.branches[b];
    for (int end = 0; end < 2; ++end) {
      const NetworkNode& node = network.nodes[branch.nodes[end]];
      const double own = end == 0 ? branch.radii.front() : branch.radii.back();
      if (node.degree < 3 || node.radius < kThin * own) {
        continue;
      }
      Finding f;
      f.kind = FindingKind::thin_branch;
      f.severity = Severity::warning;
      f.branches = {static_cast<int>(b), -1};
      f.at = node.position;
      f.point = node.point;
      f.figure = node.radius / own;
      f.text = vessel_text(network, static_cast<int>(b)) + " has the radius " + short_text(own) +
               " at the junction at " + short_text(f.at) + ", whose radius is " + short_text(node.radius) + ": " +
               hundredths(f.figure) + " times as much";
      f.cure = "check the radii of the points there; leave the branch out if it does not matter";
      findings.push_back(f);
    }
  }
}

void add_near_junctions(const Network& network, std::vector<Finding>& findings) {
  for (std::size_t b = 0; b < network.branches.size(); ++b) {
    const Branch& branch = network.branches[b];
    const NetworkNode &first = network.nodes[branch.nodes[0]], &last = network.nodes[branch.nodes[1]];
    const double radius = std::max(first.radius, last.radius);
    if (first.degree < 3 || last.degree < 3 || branch.nodes[0] == branch.nodes[1] || branch.length() >= radius) {
      continue;
    }
    Finding f;
    f.kind = FindingKind::near_junctions;
    f.severity = Severity::note;
    f.branches = {static_cast<int>(b), -1};
    f.at = axis_point(branch, branch.length() / 2).position;
    f.point = first.point;
    f.figure = branch.length() / radius;
    f.text = "the junctions at points " + std::to_string(first.point) + " and " + std::to_string(last.point) +
             " are " + hundredths(f.figure) + " radii apart at " + short_text(f.at);
    f.cure = "nothing, if that is meant; if it is one junction that was traced as two, make it one point";
    findings.push_back(f);
  }
}

/// Larger is worse.
double badness(const Finding& f) {
  switch (f.kind) {
    case FindingKind::touch:
    case FindingKind::stub:
    case FindingKind::unjoined:
    case FindingKind::near_junctions:
    case FindingKind::fragment:
      return -f.figure;
    default:
      return f.figure;
  }
}

}  // namespace

std::string_view name_of(FindingKind kind) {
  constexpr std::string_view names[]{"overlap",    "touch",       "hairpin", "side_by_side",
                                     "sharp_bend", "steep_taper", "thin_branch", "stub",    "fragment",
                                     "unjoined",   "near_junctions"};
  return names[static_cast<int>(kind)];
}

std::string_view name_of(Severity severity) {
  constexpr std::string_view names[]{"error", "warning", "note"};
  return names[static_cast<int>(severity)];
}

std::vector<Finding> diagnose(const Network& network) {
  std::vector<Finding> findings;
  const std::vector<Contact> contacts = find_contacts(network);
  add_contacts(network, contacts, findings);
  add_bends_and_tapers(network, findings);
  add_thin_branches(network, findings);
  add_stubs(network, findings);
  add_unjoined(network, contacts, findings);
  add_near_junctions(network, findings);
  std::stable_sort(findings.begin(), findings.end(), [](const Finding& a, const Finding& b) {
    return a.kind != b.kind ? a.kind < b.kind : badness(a) > badness(b);
  });
  return findings;
}

}  // namespace vasohex
