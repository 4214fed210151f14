#include "vasohex/skeleton/contacts.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <queue>

namespace vasohex {
namespace {

constexpr double kMargin = 0.1;    // gaps up to this part of the smaller radius join meetings to one contact
constexpr double kTurn = 1.9635;   // of the sum of radii: 1.25 times the half circle around which a tube turns back
constexpr double kReturn = 16.0;   // radii along the network that a vessel goes before it may come back to itself
constexpr double kParting = 48.0;  // radii along the network, 24 to each side of a junction: a fork of 5 degrees

/// A short piece of a branch, between two samples.
struct Stretch {
  int branch = 0;
  std::array<double, 2> arc{}, radius{};
  std::array<Vec3, 2> point{};
  double middle() const { return (arc[0] + arc[1]) / 2; }
};

struct Pair {
  int a = 0, b = 0;  // stretches, a <= b
  Meeting meeting;
  friend bool operator<(const Pair& p, const Pair& q) { return std::tie(p.a, p.b) < std::tie(q.a, q.b); }
};

/// Closest points of two segments, as fractions of each.
std::array<double, 2> closest(const Stretch& p, const Stretch& q) {
  const Vec3 u = p.point[1] - p.point[0], v = q.point[1] - q.point[0], w = p.point[0] - q.point[0];
  const double uu = u.squaredNorm(), uv = u.dot(v), vv = v.squaredNorm(), uw = u.dot(w), vw = v.dot(w);
  const double det = uu * vv - uv * uv;
  double s = det > 1e-12 * uu * vv ? std::clamp((uv * vw - vv * uw) / det, 0.0, 1.0) : 0.5;
  const double t = std::clamp((uv * s + vw) / vv, 0.0, 1.0);
  s = std::clamp((uv * t - uw) / uu, 0.0, 1.0);
  return {s, t};
}

Meeting meeting_of(const Stretch& p, const Stretch& q) {
  const std::array<double, 2> at = closest(p, q);
  Meeting m;
  std::array<Vec3, 2> x;
  for (int k = 0; k < 2; ++k) {
    const Stretch& s = k == 0 ? p : q;
    m.branches[k] = s.branch;
    m.arcs[k] = (1 - at[k]) * s.arc[0] + at[k] * s.arc[1];
    m.radii[k] = (1 - at[k]) * s.radius[0] + at[k] * s.radius[1];
    x[k] = (1 - at[k]) * s.point[0] + at[k] * s.point[1];
  }
  m.gap = (x[0] - x[1]).norm() - m.radii[0] - m.radii[1];
  return m;
}

/// The stretches of a network, which of them follow each other, and how far apart they are along it.
class Stretches {
 public:
  explicit Stretches(const Network& network) : network_(network), ends_(branch_ends(network)) {
    for (std::size_t b = 0; b < network.branches.size(); ++b) {
      const Branch& branch = network.branches[b];
      first_.push_back(static_cast<int>(all_.size()));
      const std::size_t last = branch.points.size() - 1;
      for (std::size_t i = 0, k = 1; k <= last; ++k) {  // sharp bends have far more samples than are needed here
        const bool long_enough = branch.arc[k] - branch.arc[i] >= 0.25 * std::min(branch.radii[i], branch.radii[k]);
        if (k == last || long_enough) {
          all_.push_back({static_cast<int>(b),
                          {branch.arc[i], branch.arc[k]},
                          {branch.radii[i], branch.radii[k]},
                          {branch.points[i], branch.points[k]}});
          i = k;
        }
      }
    }
    first_.push_back(static_cast<int>(all_.size()));
  }

  const std::vector<Stretch>& all() const { return all_; }

  /// The stretches that follow one, through nodes too.
  std::vector<int> neighbours(int s) const {
    std::vector<int> found;
    const int b = all_[s].branch;
    for (int end = 0; end < 2; ++end) {
      const int next = end == 0 ? s - 1 : s + 1;
      if (next >= first_[b] && next < first_[b + 1]) {
        found.push_back(next);
        continue;
      }
      for (const BranchEnd& e : ends_[network_.branches[b].nodes[end]]) {
        const int other = e.end == 0 ? first_[e.branch] : first_[e.branch + 1] - 1;
        if (other != s) {
          found.push_back(other);
        }
      }
    }
    return found;
  }

  /// Whether the way along the network between two places explains that they meet; `within`: along one vessel.
  bool explained(const Meeting& m, bool& within) const {
    const double radii = m.radii[0] + m.radii[1], larger = std::max(m.radii[0], m.radii[1]);
    within = m.branches[0] == m.branches[1];
    if (within && std::abs(m.arcs[0] - m.arcs[1]) <= kTurn * radii) {
      return true;
    }
    for (int e = 0; e < 2; ++e) {
      for (int f = 0; f < 2; ++f) {
        const int from = node(m, 0, e), to = node(m, 1, f);
        const double at_nodes = 2 * std::max(network_.nodes[from].radius, network_.nodes[to].radius);
        const double limit = (within ? kReturn : kParting) * larger + at_nodes;
        const double rest = limit - to_node(m, 0, e) - to_node(m, 1, f);
        // out of a branch and back into it by the same end is no way
        if (rest >= 0 && !(within && e == f) && (from == to || distance(from, to, rest) <= rest)) {
          return true;
        }
      }
    }
    return false;
  }

 private:
  int node(const Meeting& m, int k, int end) const { return network_.branches[m.branches[k]].nodes[end]; }
  double to_node(const Meeting& m, int k, int end) const {
    return end == 0 ? m.arcs[k] : network_.branches[m.branches[k]].length() - m.arcs[k];
  }

  /// Along the network, if it is at most `bound`.
  double distance(int from, int to, double bound) const {
    Reached& reached = reached_[from];
    if (reached.bound < bound) {
      reached = {2 * bound, {}};
      using Entry = std::pair<double, int>;
      std::priority_queue<Entry, std::vector<Entry>, std::greater<>> open;
      open.push({0, from});
      while (!open.empty()) {
        const auto [d, n] = open.top();
        open.pop();
        if (!reached.distance.emplace(n, d).second) {
          continue;
        }
        for (const BranchEnd& e : ends_[n]) {
          const Branch& branch = network_.branches[e.branch];
          if (d + branch.length() <= reached.bound) {
            open.push({d + branch.length(), branch.nodes[1 - e.end]});
          }
        }
      }
    }
    const auto found = reached.distance.find(to);
    return found == reached.distance.end() ? std::numeric_limits<double>::infinity() : found->second;
  }

  struct Reached {
    double bound = -1;
    std::map<int, double> distance;
  };

  const Network& network_;
  std::vector<std::vector<BranchEnd>> ends_;
  std::vector<Stretch> all_;
  std::vector<int> first_;
  mutable std::map<int, Reached> reached_;
};

/// A tree of boxes around the tubes of stretches, split at the middle.
class BoxTree {
 public:
  explicit BoxTree(const std::vector<Stretch>& stretches) : order_(stretches.size()) {
    for (const Stretch& s : stretches) {
      Box box;
      const double r = (1 + kMargin) * std::max(s.radius[0], s.radius[1]);
      for (const Vec3& p : s.point) {
        box.add(p - Vec3::Constant(r));
        box.add(p + Vec3::Constant(r));
      }
      boxes_.push_back(box);
    }
    std::iota(order_.begin(), order_.end(), 0);
    build(0, static_cast<int>(order_.size()));
  }

  /// Calls `found` with all stretches >= s whose box meets that of s.
  template <class Found>
  void partners(int s, const Found& found) const {
    visit(0, s, found);
  }

 private:
  struct Node {
    Box box;
    int begin = 0, end = 0;
    int right = -1;  // the left child follows its parent; -1: a leaf
  };

  void build(int begin, int end) {
    const int self = static_cast<int>(nodes_.size());
    nodes_.push_back({{}, begin, end, -1});
    Box middles;
    for (int k = begin; k < end; ++k) {
      nodes_[self].box.add(boxes_[order_[k]].min);
      nodes_[self].box.add(boxes_[order_[k]].max);
      middles.add(boxes_[order_[k]].min + boxes_[order_[k]].max);
    }
    if (end - begin <= 8) {
      return;
    }
    int axis = 0;
    (middles.max - middles.min).maxCoeff(&axis);
    const int half = (begin + end) / 2;
    std::nth_element(order_.begin() + begin, order_.begin() + half, order_.begin() + end, [&](int a, int b) {
      return boxes_[a].min[axis] + boxes_[a].max[axis] < boxes_[b].min[axis] + boxes_[b].max[axis];
    });
    build(begin, half);
    nodes_[self].right = static_cast<int>(nodes_.size());
    build(half, end);
  }

  static bool meet(const Box& a, const Box& b) {
    return (a.min.array() <= b.max.array()).all() && (b.min.array() <= a.max.array()).all();
  }

  template <class Found>
  void visit(int n, int s, const Found& found) const {
    const Node& node = nodes_[n];
    if (!meet(node.box, boxes_[s])) {
      return;
    }
    if (node.right >= 0) {
      visit(n + 1, s, found);
      visit(node.right, s, found);
      return;
    }
    for (int k = node.begin; k < node.end; ++k) {
      if (order_[k] >= s && meet(boxes_[order_[k]], boxes_[s])) {
        found(order_[k]);
      }
    }
  }

  std::vector<Box> boxes_;
  std::vector<int> order_;
  std::vector<Node> nodes_;
};

/// Moves both places, within a radius, to where the gap is least.
Meeting refined(const Network& network, const Meeting& start) {
  const auto at = [&](const std::array<double, 2>& arcs) {
    Meeting m = start;
    std::array<Vec3, 2> x;
    for (int k = 0; k < 2; ++k) {
      const Branch& branch = network.branches[m.branches[k]];
      m.arcs[k] = std::clamp(arcs[k], std::max(0.0, start.arcs[k] - start.radii[k]),
                             std::min(branch.length(), start.arcs[k] + start.radii[k]));
      const AxisPoint p = axis_point(branch, m.arcs[k]);
      m.radii[k] = p.radius;
      x[k] = p.position;
    }
    m.gap = (x[0] - x[1]).norm() - m.radii[0] - m.radii[1];
    return m;
  };
  Meeting best = at(start.arcs);
  for (double step = 0.25; step > 1e-3;) {
    Meeting better = best;
    for (int i = -1; i <= 1; ++i) {
      for (int k = -1; k <= 1; ++k) {
        const Meeting m = at({best.arcs[0] + i * step * start.radii[0], best.arcs[1] + k * step * start.radii[1]});
        if (m.gap < better.gap) {
          better = m;
        }
      }
    }
    if (better.gap < best.gap) {
      best = better;
    } else {
      step /= 2;
    }
  }
  return best;
}

std::string from_to(const Network& network, int branch) {
  const std::array<int, 2>& nodes = network.branches[branch].nodes;
  return "from point " + std::to_string(network.nodes[nodes[0]].point) + " to point " +
         std::to_string(network.nodes[nodes[1]].point);
}

}  // namespace

double Meeting::relative() const { return gap / std::min(radii[0], radii[1]); }

Vec3 place_of(const Network& network, const Meeting& m) {
  const Vec3 a = axis_point(network.branches[m.branches[0]], m.arcs[0]).position;
  const Vec3 b = axis_point(network.branches[m.branches[1]], m.arcs[1]).position;
  return (m.radii[1] * a + m.radii[0] * b) / (m.radii[0] + m.radii[1]);
}

std::string vessel_text(const Network& network, int branch) { return "the vessel " + from_to(network, branch); }

std::string who_meet(const Network& network, const Meeting& m) {
  const std::string first = from_to(network, m.branches[0]);
  return m.branches[0] == m.branches[1] ? "two turns of the vessel " + first
                                        : "the vessels " + first + " and " + from_to(network, m.branches[1]);
}

std::vector<Contact> find_contacts(const Network& network) {
  const Stretches stretches(network);
  const BoxTree tree(stretches.all());
  const int count = static_cast<int>(stretches.all().size());
  std::vector<Pair> pairs;
  std::vector<std::vector<int>> neighbours;
  for (int a = 0; a < count; ++a) {
    neighbours.push_back(stretches.neighbours(a));
    tree.partners(a, [&](int b) {
      const Meeting m = meeting_of(stretches.all()[a], stretches.all()[b]);
      if (a == b || m.relative() < kMargin) {
        pairs.push_back({a, b, m});
      }
    });
  }
  std::sort(pairs.begin(), pairs.end());
  std::vector<std::size_t> first(count + 1, 0);  // pair of each stretch
  for (const Pair& p : pairs) {
    ++first[p.a + 1];
  }
  std::partial_sum(first.begin(), first.end(), first.begin());
  const auto find = [&](int a, int b) {
    const auto begin = pairs.begin() + static_cast<std::ptrdiff_t>(first[std::min(a, b)]);
    const auto end = pairs.begin() + static_cast<std::ptrdiff_t>(first[std::min(a, b) + 1]);
    const int other = std::max(a, b);
    const auto it = std::lower_bound(begin, end, other, [](const Pair& p, int value) { return p.b < value; });
    return it != end && it->b == other ? static_cast<int>(it - pairs.begin()) : -1;
  };
  // Calls `step` with the pairs next to a pair: one or both of its stretches replaced by a neighbour
  const auto for_neighbours = [&](int pair, const auto& step) {
    const auto [a, b] = std::pair(pairs[pair].a, pairs[pair].b);
    const auto one = [&](int c, int d) {
      if (const int next = find(c, d); next >= 0) {
        step(next);
      }
    };
    for (const int d : neighbours[b]) {
      one(a, d);
    }
    for (const int c : neighbours[a]) {
      one(c, b);
      for (const int d : neighbours[b]) {
        one(c, d);
      }
    }
  };

  enum Class { unknown = -2, natural = -1 };  // from 0 on: a ContactKind
  std::vector<int> kind(pairs.size(), unknown);
  std::vector<int> open;
  for (std::size_t p = 0; p < pairs.size(); ++p) {
    if (pairs[p].a == pairs[p].b) {
      kind[p] = natural;
      open.push_back(static_cast<int>(p));
    }
  }
  while (!open.empty()) {
    const int p = open.back();
    open.pop_back();
    for_neighbours(p, [&](int next) {
      if (kind[next] == unknown) {
        kind[next] = natural;
        open.push_back(next);
      }
    });
  }
  for (std::size_t p = 0; p < pairs.size(); ++p) {
    bool within = false;
    if (kind[p] == unknown) {
      kind[p] = static_cast<int>(ContactKind::passing);
    } else if (pairs[p].a != pairs[p].b && pairs[p].meeting.gap < 0 &&
               !stretches.explained(pairs[p].meeting, within)) {
      kind[p] = static_cast<int>(within ? ContactKind::hairpin : ContactKind::side_by_side);
    }
  }

  std::vector<Contact> contacts;
  std::vector<bool> done(pairs.size(), false);
  for (std::size_t p = 0; p < pairs.size(); ++p) {
    if (kind[p] < 0 || done[p]) {
      continue;
    }
    Contact contact;
    contact.kind = static_cast<ContactKind>(kind[p]);
    done[p] = true;
    open.assign(1, static_cast<int>(p));
    for (std::size_t k = 0; k < open.size(); ++k) {
      contact.meetings.push_back(pairs[open[k]].meeting);
      for_neighbours(open[k], [&](int next) {
        if (kind[next] == kind[p] && !done[next]) {
          done[next] = true;
          open.push_back(next);
        }
      });
    }
    contact.worst = *std::min_element(contact.meetings.begin(), contact.meetings.end(),
                                      [](const Meeting& a, const Meeting& b) { return a.relative() < b.relative(); });
    if (contact.kind == ContactKind::passing) {
      contact.worst = refined(network, contact.worst);
    }
    if (contact.worst.relative() < kTouching) {
      contacts.push_back(std::move(contact));
    }
  }
  return contacts;
}

}  // namespace vasohex
