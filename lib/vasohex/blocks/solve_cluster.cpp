#include "vasohex/blocks/solve_cluster.h"

#include <algorithm>
#include <array>
#include <optional>
#include <set>
#include <utility>

#include "vasohex/blocks/carry_on.h"
#include "vasohex/blocks/split_hub.h"
#include "vasohex/core/cpu_time.h"
#include "vasohex/core/error.h"

namespace vasohex {
namespace {

/// Where the best arrangement so far has a lesser scaled Jacobian, or is not certified, the search looks at
/// three times as many.
constexpr double kFairJacobian = 0.5;
constexpr int kLongSearch = 3;
/// Placing arrangements, to tell which are promising, takes longer than some attempts: this many first, the best of
/// which are attempted before all are placed.
constexpr int kFewPlaced = 5;
constexpr int kFewAttempts = 2;
/// Below this so many arrangements are not given up before their end,
constexpr double kPatientBelow = 0.4;
constexpr int kMostPatient = 3;
/// unless the first of them ends as folded as this: the next ones did, too, and they take longest.
constexpr double kHopeless = -0.5;

/// So many of the attempts are refined where the best is not good even then.
constexpr int kMostRefined = 6;
/// Below it blocks are worth refining. Those of several cubes gain more.
constexpr double kWeak = 0.65;
constexpr double kWeakOfSeveral = 0.7;

/// Hubs and how the arms of each are assigned to its cube's faces.
struct Arrangement {
  Cluster cluster;
  std::vector<CubeAssignment> assignments;  ///< [hubs]
  double energy = 0;                        ///< how folded its blocks are before anything moves
};

/// Equal for arrangements that give the same blocks.
std::vector<double> key_of(const Arrangement& arrangement) {
  std::vector<double> key;
  for (std::size_t h = 0; h < arrangement.cluster.size(); ++h) {
    const Hub& hub = arrangement.cluster[h];
    key.insert(key.end(), hub.centre.begin(), hub.centre.end());
    for (std::size_t a = 0; a < hub.arms.size(); ++a) {
      const Arm& arm = hub.arms[a];
      for (const int part : {arm.branch, arm.end, arm.link, arrangement.assignments[h].face[a]}) {
        key.push_back(part);
      }
    }
  }
  return key;
}

std::vector<CubeAssignment> assignments_of(const Hub& hub, int count) {
  std::vector<Vec3> directions;
  for (const Arm& arm : hub.arms) {
    directions.push_back(arm.direction);
  }
  return cube_assignments(directions, count);
}

/// The least scaled Jacobian of each hub's blocks.
std::vector<double> least_of_hubs(const ClusterResult& r) {
  std::vector<double> least(r.cluster.size(), 2.0);
  for (std::size_t b = 0; b < r.blocks.problem.blocks.size(); ++b) {
    const auto nodes = r.solution.nodes.begin() + static_cast<std::ptrdiff_t>(b) * kBlockNodes;
    double& of_hub = least[r.blocks.block_hub[b]];
    of_hub = std::min(of_hub, least_jacobian(std::vector<Vec3>(nodes, nodes + kBlockNodes)));
  }
  return least;
}

/// Keeps the `count` arrangements of least energy, in that order.
void keep_best(std::vector<Arrangement>& all, std::size_t count) {
  std::stable_sort(all.begin(), all.end(),
                   [](const Arrangement& a, const Arrangement& b) { return a.energy < b.energy; });
  all.resize(std::min(all.size(), count));
}

/// The same after a closer look, at blocks whose walls are in place.
void keep_best_placed(const ImplicitSurface& surface, std::vector<Arrangement>& all, std::size_t count) {
  for (Arrangement& a : all) {
    a.energy = placed_energy(cluster_blocks(surface, a.cluster, a.assignments).problem);
  }
  keep_best(all, count);
}

/// All ways to divide the arrangement's hub `h` among cubes.
std::vector<Arrangement> divided(const Arrangement& a, int h) {
  std::vector<Arrangement> all;
  if (a.cluster[h].arms.size() <= 3) {
    return all;
  }
  for (const Cluster& cluster : split_hub(a.cluster, h)) {
    Arrangement d{cluster, a.assignments};
    for (std::size_t s = a.cluster.size(); s < cluster.size(); ++s) {
      d.assignments.push_back(assignments_of(cluster[s], 1).front());
    }
    all.push_back(std::move(d));
  }
  return all;
}

/// Arrangements of hub `h`, as one cube, a tree of cubes or one cube with a hub that is near, with the other hubs as
/// they are; by how folded they are with straight edges, at least one.
std::vector<Arrangement> straight_arrangements(const ImplicitSurface& surface, const Arrangement& now, int h) {
  // with more branches there are more ways to go wrong
  const std::size_t first_choice = now.cluster[h].arms.size() > kCubeArms ? 64 : 20;
  std::vector<Arrangement> all;
  // `a` with each of the `most` best ways to assign the arms of hub `changed`
  const auto add = [&](Arrangement a, int changed, int most) {
    for (const CubeAssignment& assignment : assignments_of(a.cluster[changed], most)) {
      a.assignments[changed] = assignment;
      a.energy = straight_energy(cluster_blocks(surface, a.cluster, a.assignments).problem);
      all.push_back(a);
    }
  };
  if (now.cluster[h].arms.size() <= kCubeArms) {
    add(now, h, 6);
  }
  // `a` with its hub `changed` divided in all ways
  const auto add_divided = [&](const Arrangement& a, int changed) {
    for (const Arrangement& d : divided(a, changed)) {
      add(d, changed, 1);
    }
  };
  add_divided(now, h);
  const auto add_all = [&](const std::vector<std::pair<Cluster, int>>& changed) {
    for (const auto& [cluster, at] : changed) {
      Arrangement a{cluster, {}};
      for (const Hub& hub : cluster) {
        a.assignments.push_back(assignments_of(hub, 1).front());
      }
      add(a, at, 6);
      add_divided(a, at);  // branches of two junctions may run side by side
    }
  };
  add_all(merge_hub(now.cluster, h));
  add_all(carry_on(now.cluster, h));
  for (const Arm& arm : now.cluster[h].arms) {
    if (arm.link >= 0) {
      add_all(carry_on(now.cluster, arm.link));
    }
  }
  if (all.empty()) {
    throw Error(ErrorCode::internal, "a junction of more than 6 branches could not be divided among cubes");
  }
  keep_best(all, first_choice);
  return all;
}

/// The `count` most promising of them, those first.
std::vector<Arrangement> arrangements(const ImplicitSurface& surface, const Arrangement& now, int h,
                                      std::size_t count) {
  std::vector<Arrangement> all = straight_arrangements(surface, now, h);
  keep_best_placed(surface, all, count);
  return all;
}

/// Trees of cubes one deeper: hub `h` divided, what is left of it divided again; the most promising first. What one
/// division leaves at the centre may be too much for a cube: six of eight branches in a half-sphere.
std::vector<Arrangement> deeper_arrangements(const ImplicitSurface& surface, const Arrangement& now, int h,
                                             std::size_t count) {
  constexpr std::size_t kOnceDivided = 24;
  constexpr std::size_t kTwiceDivided = 64;
  const auto most_promising = [&](std::vector<Arrangement> all, std::size_t most) {
    for (Arrangement& a : all) {
      a.assignments[h] = assignments_of(a.cluster[h], 1).front();
      a.energy = straight_energy(cluster_blocks(surface, a.cluster, a.assignments).problem);
    }
    keep_best(all, most);
    return all;
  };
  std::vector<Arrangement> all;
  for (const Arrangement& once : most_promising(divided(now, h), kOnceDivided)) {
    for (Arrangement& twice : divided(once, h)) {
      all.push_back(std::move(twice));
    }
  }
  all = most_promising(std::move(all), kTwiceDivided);
  keep_best_placed(surface, all, count);
  return all;
}

/// One cube a hub; those of too many arms divided in the most promising way.
Arrangement first_arrangement(const ImplicitSurface& surface, const Cluster& cluster) {
  Arrangement first{cluster, {}};
  for (const Hub& hub : cluster) {
    first.assignments.push_back(hub.arms.size() > kCubeArms ? CubeAssignment{} : assignments_of(hub, 1).front());
  }
  for (int h = 0; h < static_cast<int>(cluster.size()); ++h) {
    if (cluster[h].arms.size() > kCubeArms) {
      first = arrangements(surface, first, h, 1).front();
    }
  }
  return first;
}

/// The best arrangement found so far, and the steps that look for a better one.
class Search {
 public:
  Search(const ImplicitSurface& surface, const BlockOptions& options) : surface_(surface), options_(options) {}

  /// Optimises the arrangement, once; unless `patient`, only while it looks promising. Returns the least scaled
  /// Jacobian that it came to, if any.
  std::optional<double> attempt(const Arrangement& arrangement, bool patient) {
    if (!attempted_[patient].insert(key_of(arrangement)).second) {
      return {};
    }
    ClusterResult r;
    r.cluster = arrangement.cluster;
    r.assignments = arrangement.assignments;
    r.blocks = cluster_blocks(surface_, r.cluster, r.assignments);
    r.blocks.problem.may_change_sides = may_change_sides_;
    ++tried_;
    if (patient) {
      r.solution = optimise_blocks(r.blocks.problem);
    } else if (auto solution = try_blocks(r.blocks.problem)) {
      r.solution = std::move(*solution);
    } else {
      return {};
    }
    const double least = r.solution.min_jacobian;
    keep(std::move(r));
    return least;
  }

  /// All attempts from now on, those made before too, with walls that may change sides while folded.
  void let_walls_change_sides() {
    may_change_sides_ = true;
    attempted_ = {};
  }

  /// Whether the best is one that is kept without more patience.
  bool is_fair() const { return reached(kPatientBelow); }

  /// Other arrangements of a junction alone; while none is fair, up to `most_patient` of them to their end.
  void arrange_alone(const Cluster& cluster, int most_patient) {
    if (cluster.size() > 1 || is_good()) {
      return;
    }
    std::vector<Arrangement> all = straight_arrangements(surface_, {cluster, {{}}}, 0);
    std::vector<Arrangement> few(all.begin(), all.begin() + std::min<std::ptrdiff_t>(all.size(), kFewPlaced));
    keep_best_placed(surface_, few, kFewAttempts);
    attempt_all(few);
    if (is_good()) {
      return;
    }
    keep_best_placed(surface_, all, kLongSearch * std::max(1, options_.candidates));
    attempt_all(all);
    const int most = std::min(static_cast<int>(all.size()), most_patient);
    for (int i = 0; i < most && !is_fair(); ++i) {
      const std::optional<double> least = attempt(all[i], true);
      if (least && *least < kHopeless) {
        break;
      }
    }
  }

  /// Deeper trees of cubes for a junction alone of more arms than a cube takes, where the others fail.
  void arrange_deeper(const Cluster& cluster) {
    if (cluster.size() > 1 || cluster.front().arms.size() <= kCubeArms || is_fair()) {
      return;
    }
    attempt_all(deeper_arrangements(surface_, {cluster, {{}}}, 0, 2 * std::max(1, options_.candidates)));
  }

  /// Of several hubs the weakest is arranged anew, then the next, unless the blocks of one stay folded: those of the
  /// others do not unfold them.
  void rearrange_weakest(int most_rounds) {
    std::vector<char> done(found_.empty() ? 0 : found_.front().cluster.size(), 0);
    for (int round = 0; round < most_rounds && done.size() > 1 && !is_good(); ++round) {
      const std::vector<double> least = least_of_hubs(found_.front());
      std::optional<int> weakest;
      bool stays_folded = false;
      for (int h = 0; h < static_cast<int>(least.size()); ++h) {
        stays_folded |= done[h] && least[h] < 0;
        if (!done[h] && least[h] < options_.good_jacobian && (!weakest || least[h] < least[*weakest])) {
          weakest = h;
        }
      }
      if (!weakest || stays_folded) {
        break;
      }
      const Arrangement now{found_.front().cluster, found_.front().assignments};
      // each try costs as much as all of the cluster
      const int hubs = std::max(2, static_cast<int>(now.cluster.size()));
      attempt_all(arrangements(surface_, now, *weakest, std::max(3, 2 * kLongSearch * options_.candidates / hubs)));
      if (found_.front().cluster.size() < now.cluster.size()) {
        done.assign(found_.front().cluster.size(), 0);  // two hubs became one: the numbers are new
      } else {
        done.resize(found_.front().cluster.size(), 1);
        done[*weakest] = 1;
      }
    }
  }

  /// The best, refined and fitted to the mesh that is asked for; one without blocks if no attempt came to an end.
  ClusterResult result() {
    ClusterResult best = refined();
    if (!best.solution.nodes.empty()) {
      best.blocks.problem.mesh = options_.mesh;
      best.solution = fit_to_mesh(best.blocks.problem, std::move(best.solution));
    }
    best.candidates = tried_;
    best.cpu_seconds = thread_cpu_seconds() - start_;
    return best;
  }

 private:
  bool reached(double least) const { return !found_.empty() && is_at_least(found_.front(), least); }
  static bool is_at_least(const ClusterResult& r, double least) {
    return r.solution.certified && r.solution.min_jacobian >= least;
  }
  bool is_good() const { return reached(options_.good_jacobian); }
  void keep(ClusterResult r) {
    const auto worse = std::find_if(found_.begin(), found_.end(), [&](const ClusterResult& other) {
      return r.solution.is_better_than(other.solution);
    });
    found_.insert(worse, std::move(r));
    found_.resize(std::min<std::size_t>(found_.size(), kMostRefined));
  }
  /// Refining costs more than another attempt: only what the search ends with, until one is good.
  ClusterResult refined() {
    ClusterResult best;
    for (ClusterResult& r : found_) {
      if (is_at_least(best, options_.good_jacobian)) {
        break;
      }
      r.solution =
          refine_blocks(r.blocks.problem, std::move(r.solution), r.cluster.size() > 1 ? kWeakOfSeveral : kWeak, true);
      if (best.solution.nodes.empty() || r.solution.is_better_than(best.solution)) {
        best = std::move(r);
      }
    }
    return best;
  }
  void attempt_all(const std::vector<Arrangement>& all) {
    for (int i = 0; i < static_cast<int>(all.size()) && !is_good(); ++i) {
      if (i >= options_.candidates && reached(kFairJacobian)) {
        break;
      }
      attempt(all[i], false);
    }
  }

  const ImplicitSurface& surface_;
  const BlockOptions& options_;
  const double start_ = thread_cpu_seconds();
  std::array<std::set<std::vector<double>>, 2> attempted_;  ///< [patient] by key_of()
  std::vector<ClusterResult> found_;                        ///< the best first
  int tried_ = 0;
  bool may_change_sides_ = false;
};

}  // namespace

ClusterResult solve_cluster(const ImplicitSurface& surface, const Cluster& cluster, const BlockOptions& options) {
  Search search(surface, options);
  const bool alone = cluster.size() == 1;
  const auto look = [&] {
    if (!alone || cluster.front().arms.size() <= kCubeArms) {
      search.attempt(first_arrangement(surface, cluster), !alone);
    }
    search.arrange_alone(cluster, std::clamp(options.candidates, 1, kMostPatient));
    search.arrange_deeper(cluster);
    search.rearrange_weakest(std::min(6, options.candidates));
  };
  look();
  if (!search.is_fair()) {
    search.let_walls_change_sides();
    look();
  }
  return search.result();
}

ClusterResult try_cluster(const ImplicitSurface& surface, const Cluster& cluster, const BlockOptions& options) {
  Search search(surface, options);
  const bool thorough = options.candidates > 1;
  search.attempt(first_arrangement(surface, cluster), thorough && cluster.size() > 1);
  if (thorough) {
    search.arrange_alone(cluster, 0);
    search.rearrange_weakest(1);
  }
  return search.result();
}

bool is_hopeless(const ClusterResult& result) {
  return !result.solution.certified && result.solution.min_jacobian < kHopeless;
}

}  // namespace vasohex
