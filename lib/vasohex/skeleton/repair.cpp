#include "vasohex/skeleton/repair.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <queue>
#include <set>

#include "vasohex/core/short_text.h"
#include "vasohex/core/smooth_step.h"
#include "vasohex/skeleton/clean.h"
#include "vasohex/skeleton/contacts.h"
#include "vasohex/skeleton/diagnose.h"
#include "vasohex/skeleton/straighten.h"

namespace vasohex {
namespace {

// of the smaller radius; with 0.06, one of 15 pairs of crossing tubes still got invalid blocks, with 0.12 none
constexpr double kAimedGap = 0.12;
constexpr double kThinnerOver = 3;  // radii of arc over which a change of the radius runs out
constexpr double kMovedOver = 4;    // radii of arc over which a displacement runs out
constexpr double kLeastRoom = 3;    // radii of arc to the next node that a displacement needs
constexpr double kContinues = 0.7;  // thinning goes on, through a node, into branches at least that wide
constexpr int kAttempts = 4;

/// What is to become of a branch around a place on it. Beyond an end of the branch if the place is on another one.
struct Change {
  double arc = 0, core = 0, reach = 0;  ///< full up to `core` from `arc`, none from core + reach on
  double factor = 1;                    ///< of the radius
  Vec3 move = Vec3::Zero();
  double weight(double s) const { return smooth_step(1 - (std::abs(s - arc) - core) / reach); }
};

double factor_at(const std::vector<Change>& changes, double s) {
  double factor = 1;
  for (const Change& c : changes) {
    factor = std::min(factor, 1 - (1 - c.factor) * c.weight(s));
  }
  return factor;
}

Vec3 move_at(const std::vector<Change>& changes, const Branch& branch, double s) {
  Vec3 move = Vec3::Zero();
  for (const Change& c : changes) {
    const double room = std::min({c.reach, c.arc, branch.length() - c.arc});  // nodes stay where they are
    if (room > 0) {
      move += smooth_step(1 - std::abs(s - c.arc) / room) * c.move;
    }
  }
  return move;
}

/// The branch with its changes, sampled as densely as its new radii ask for.
Branch changed(const Branch& old, const std::vector<Change>& changes) {
  Branch b;
  b.nodes = old.nodes;
  const auto add = [&](double s) {
    const AxisPoint p = axis_point(old, s);
    const double h = 1e-3 * p.radius;
    const double low = std::max(s - h, 0.0), high = std::min(s + h, old.length());
    const Vec3 slope = (move_at(changes, old, high) - move_at(changes, old, low)) / (high - low);
    b.points.push_back(p.position + move_at(changes, old, s));
    b.radii.push_back(p.radius * factor_at(changes, s));
    b.tangents.push_back((p.tangent + slope).normalized());
  };
  for (std::size_t i = 0; i + 1 < old.points.size(); ++i) {
    const double s = old.arc[i], h = old.arc[i + 1] - s;
    double radius = std::min(old.radii[i], old.radii[i + 1]);
    double factor = 1;
    for (int k = 0; k <= 4; ++k) {
      factor = std::min(factor, factor_at(changes, s + h * k / 4));
    }
    radius *= factor;
    const int pieces = std::max(1, static_cast<int>(std::ceil(h / (0.4 * radius) * (1 - 1e-9))));
    for (int k = 0; k < (factor < 1 ? pieces : 1); ++k) {
      add(s + h * k / (factor < 1 ? pieces : 1));
    }
  }
  add(old.length());
  b.points.front() = old.points.front();
  b.points.back() = old.points.back();
  b.arc.push_back(0);
  for (std::size_t i = 0; i + 1 < b.points.size(); ++i) {
    // chord and turn of a short arc; exact to fourth order in the angle
    const double turn = (b.tangents[i + 1] - b.tangents[i]).norm();
    b.arc.push_back(b.arc.back() + (b.points[i + 1] - b.points[i]).norm() * (1 + turn * turn / 24));
  }
  return b;
}

/// A network whose branches are changed, always from what they were at first.
class Parting {
 public:
  explicit Parting(const Network& network)
      : original_(network), changes_(network.branches.size()), ends_(branch_ends(network)) {}

  /// Thinner around a place, through nodes into the branches beyond.
  void thin(int branch, double arc, double core, double radius, double factor) {
    const double reach = kThinnerOver * radius;
    changes_[branch].push_back({arc, core, reach, factor, Vec3::Zero()});
    std::priority_queue<std::pair<double, int>, std::vector<std::pair<double, int>>, std::greater<>> open;
    std::set<int> done;
    const Branch& start = original_.branches[branch];
    open.push({arc, start.nodes[0]});
    open.push({start.length() - arc, start.nodes[1]});
    while (!open.empty()) {
      const auto [d, node] = open.top();
      open.pop();
      if (d >= core + reach || !done.insert(node).second || original_.nodes[node].seam) {
        continue;
      }
      for (const BranchEnd& e : ends_[node]) {
        const Branch& next = original_.branches[e.branch];
        const double there = e.end == 0 ? next.radii.front() : next.radii.back();
        if (e.branch == branch || there < kContinues * radius) {
          continue;
        }
        changes_[e.branch].push_back({e.end == 0 ? -d : next.length() + d, core, reach, factor, Vec3::Zero()});
        open.push({d + next.length(), next.nodes[1 - e.end]});
      }
    }
  }

  void move(int branch, double arc, double radius, const Vec3& by) {
    changes_[branch].push_back({arc, 0, kMovedOver * radius, 1, by});
  }

  Network network() const {
    Network n = original_;
    for (std::size_t b = 0; b < changes_.size(); ++b) {
      if (!changes_[b].empty()) {
        n.branches[b] = changed(original_.branches[b], changes_[b]);
      }
    }
    for (NetworkNode& node : n.nodes) {
      node.radius = 0;
    }
    for (const Branch& b : n.branches) {
      n.nodes[b.nodes[0]].radius = std::max(n.nodes[b.nodes[0]].radius, b.radii.front());
      n.nodes[b.nodes[1]].radius = std::max(n.nodes[b.nodes[1]].radius, b.radii.back());
    }
    return n;
  }

 private:
  const Network& original_;
  std::vector<std::vector<Change>> changes_;
  std::vector<std::vector<BranchEnd>> ends_;
};

std::string vessels(const Network& network, const Meeting& m) {
  return who_meet(network, m) + " at " + short_text(place_of(network, m));
}

std::string percent(double part) { return short_text(std::round(1000 * part) / 10) + " %"; }

/// A contact that is to be parted.
struct Task {
  Contact contact;
  int attempt = 0;  // each asks for a little more
  bool given_up = false;
  std::string what;  // is done
};

/// Adds what would part a contact. False if the bounds do not allow it.
bool part(const Network& network, Task& task, Parting& parting) {
  const Meeting& worst = task.contact.worst;
  std::vector<Meeting> meetings = task.contact.meetings;
  meetings.push_back(worst);
  double thinnest = 1, missing = 0;
  std::vector<double> factors;
  for (const Meeting& m : meetings) {
    const auto [a, b] = m.radii;
    const double distance = m.gap + a + b, wanted = a + b + kAimedGap * std::min(a, b);
    const double factor = std::clamp(distance / wanted * std::pow(0.97, task.attempt), kLeastRadius, 1.0);
    factors.push_back(factor);
    thinnest = std::min(thinnest, factor);
    missing = std::max(missing, factor * wanted - distance);
  }
  std::array<Vec3, 2> moves{Vec3::Zero(), Vec3::Zero()};
  double share = 0;
  if (missing > 1e-9 * worst.radii[0]) {
    // one displacement for the whole contact, at its worst place
    std::array<AxisPoint, 2> x;
    double room = 0;
    std::array<bool, 2> moves_at_all{};
    for (int k = 0; k < 2; ++k) {
      const Branch& branch = network.branches[worst.branches[k]];
      x[k] = axis_point(branch, worst.arcs[k]);
      moves_at_all[k] = std::min(worst.arcs[k], branch.length() - worst.arcs[k]) >= kLeastRoom * worst.radii[k];
      room += moves_at_all[k] ? worst.radii[k] : 0;
    }
    share = room > 0 ? missing / room * (1.05 + 0.1 * task.attempt) : 1;
    Vec3 apart = x[0].position - x[1].position;
    if (apart.norm() < 1e-3 * std::min(worst.radii[0], worst.radii[1])) {
      apart = x[0].tangent.cross(x[1].tangent);
    }
    if (share > kLargestMove || apart.norm() < 1e-6 * std::min(worst.radii[0], worst.radii[1])) {
      return false;
    }
    apart.normalize();
    for (int k = 0; k < 2; ++k) {
      moves[k] = moves_at_all[k] ? ((k == 0 ? share : -share) * worst.radii[k] * apart).eval() : Vec3::Zero().eval();
    }
  }
  for (std::size_t i = 0; i < meetings.size(); ++i) {
    for (int k = 0; k < 2; ++k) {
      const Meeting& m = meetings[i];
      parting.thin(m.branches[k], m.arcs[k], 0.5 * m.radii[k], m.radii[k], factors[i]);
    }
  }
  for (int k = 0; k < 2; ++k) {
    if (moves[k] != Vec3::Zero()) {
      parting.move(worst.branches[k], worst.arcs[k], worst.radii[k], moves[k]);
    }
  }
  task.what = "thinner there by up to " + percent(1 - thinnest) +
              (share > 0 ? ", moved apart by " + hundredths(share) + " radii each" : "");
  return true;
}

/// The task that a contact of the changed network belongs to: the nearest between the same branches, or else at one
/// of them.
Task* task_of(std::vector<Task>& tasks, const Network& network, const Contact& contact) {
  const auto position = [&](const Meeting& m, int k) {
    const Branch& branch = network.branches[m.branches[k]];
    return axis_point(branch, m.arcs[k]).position;
  };
  Task* best = nullptr;
  std::pair<int, double> least{0, 0};  // branches that are not the same, distance
  for (Task& task : tasks) {
    int same = 0;
    double distance = std::numeric_limits<double>::infinity();
    for (int i = 0; i < 2; ++i) {
      for (int k = 0; k < 2; ++k) {
        if (task.contact.worst.branches[i] == contact.worst.branches[k]) {
          ++same;
          distance = std::min(distance, (position(task.contact.worst, i) - position(contact.worst, k)).norm());
        }
      }
    }
    const std::pair<int, double> score{-std::min(same, 2), distance};
    if (same > 0 && (best == nullptr || score < least)) {
      best = &task;
      least = score;
    }
  }
  return best;
}

/// Points of the skeleton from an end of a vessel up to the next node, that node not included.
std::set<int> dead_end(const Skeleton& skeleton, int end) {
  for (const PointChain& chain : split(skeleton)) {
    if (chain.front() == end) {
      return {chain.begin(), chain.end() - 1};
    }
    if (chain.back() == end) {
      return {chain.begin() + 1, chain.end()};
    }
  }
  return {};
}

/// All points that hang together with one.
std::set<int> piece(const Skeleton& skeleton, int point) {
  std::set<int> found{point};
  for (std::size_t before = 0; before != found.size();) {
    before = found.size();
    for (const auto& [a, b] : skeleton.segments) {
      if (found.contains(a) || found.contains(b)) {
        found.insert({a, b});
      }
    }
  }
  return found;
}

/// Leaves out stubs and stray pieces. False if there are none.
bool prune(Skeleton& skeleton, const NetworkOptions& options, const std::vector<Finding>& findings,
           std::vector<std::string>& repairs) {
  std::vector<std::string> ignored;
  const Skeleton plain = straighten(clean(skeleton, ignored), ignored);
  bool changed = false;
  for (const Finding& f : findings) {
    if (f.kind != FindingKind::stub && f.kind != FindingKind::fragment) {
      continue;
    }
    const std::set<int> gone = f.kind == FindingKind::stub ? dead_end(plain, f.point) : piece(plain, f.point);
    const auto named = [&](int p) {
      return skeleton.names.contains(p) || options.names.contains(p) || options.inlet == p;
    };
    if (gone.empty() || std::any_of(gone.begin(), gone.end(), named)) {
      continue;
    }
    std::erase_if(skeleton.segments, [&](const auto& s) { return gone.contains(s[0]) || gone.contains(s[1]); });
    repairs.push_back("left out: " + f.text.substr(0, f.text.find(": ")));
    changed = true;
  }
  return changed;
}

}  // namespace

void part_vessels(Network& network) {
  std::vector<Task> tasks;
  for (Contact& contact : find_contacts(network)) {
    if (contact.kind == ContactKind::passing) {
      tasks.push_back({std::move(contact), 0, false, {}});
    }
  }
  Network parted = network;
  for (bool again = !tasks.empty(); again;) {
    Parting parting(network);
    for (Task& task : tasks) {
      task.given_up = task.given_up || !part(network, task, parting);
    }
    parted = parting.network();
    again = false;
    for (const Contact& contact : find_contacts(parted)) {
      if (contact.kind != ContactKind::passing) {
        continue;
      }
      Task* task = task_of(tasks, network, contact);
      if (task != nullptr && !task->given_up) {
        task->given_up = ++task->attempt == kAttempts;
        again = true;
      }
    }
  }
  for (const Task& task : tasks) {
    const std::string who = vessels(network, task.contact.worst);
    const double gap = task.contact.worst.relative();
    const std::string met = gap < 0 ? "overlap by " + hundredths(-gap) + " of the smaller radius" : "nearly touch";
    parted.repairs.push_back(task.given_up ? "note: " + who + " " + met +
                                                 " and could not be parted within 60 % of the radii and 0.5 radii of "
                                                 "displacement: left as they are"
                                           : who + " " + met + ": " + task.what);
  }
  network = std::move(parted);
}

Network build_repaired_network(const Skeleton& input, const NetworkOptions& options, const Run& run) {
  Skeleton skeleton = input;
  std::vector<std::string> pruned;
  Network network = build_network(skeleton, options, run);
  const std::vector<std::string> before = network.repairs;
  constexpr int rounds = 10;  // what is left when a stub goes may be one in its turn
  for (int round = 0; round < rounds && prune(skeleton, options, diagnose(network), pruned); ++round) {
    network = build_network(skeleton, options, run);
  }
  // the points that were left out have no segment: told already
  std::erase_if(network.repairs, [&](const std::string& line) {
    return line.ends_with("has no segment: dropped") && std::find(before.begin(), before.end(), line) == before.end();
  });
  network.repairs.insert(network.repairs.begin(), pruned.begin(), pruned.end());
  part_vessels(network);
  return network;
}

}  // namespace vasohex
