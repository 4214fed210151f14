#include "vasohex/blocks/solve_cluster.h"

#include <algorithm>
#include <optional>

#include "vasohex/blocks/split_hub.h"
#include "vasohex/core/cpu_time.h"
#include "vasohex/core/error.h"

namespace vasohex {
namespace {

std::vector<CubeAssignment> assignments_of(const Hub& hub, int count) {
  std::vector<Vec3> directions;
  for (const Arm& arm : hub.arms) {
    directions.push_back(arm.direction);
  }
  return cube_assignments(directions, count);
}

/// The hub with the least scaled Jacobian among those not tried yet; nothing if all were.
std::optional<int> weakest_hub(const ClusterResult& r, const std::vector<char>& tried) {
  std::vector<double> least(r.cluster.size(), 2.0);
  for (std::size_t b = 0; b < r.blocks.problem.blocks.size(); ++b) {
    const auto nodes = r.solution.nodes.begin() + static_cast<std::ptrdiff_t>(b) * kBlockNodes;
    double& of_hub = least[r.blocks.block_hub[b]];
    of_hub = std::min(of_hub, least_jacobian(std::vector<Vec3>(nodes, nodes + kBlockNodes)));
  }
  std::optional<int> weakest;
  for (int h = 0; h < static_cast<int>(least.size()); ++h) {
    if (!tried[h] && (!weakest || least[h] < least[*weakest])) {
      weakest = h;
    }
  }
  return weakest;
}

/// Clusters in which no hub has more arms than a cube can take.
std::vector<Cluster> with_small_hubs(const Cluster& cluster) {
  std::vector<Cluster> all{cluster};
  for (int h = 0; h < static_cast<int>(cluster.size()); ++h) {
    if (cluster[h].arms.size() > kCubeArms) {
      std::vector<Cluster> divided;
      for (const Cluster& c : all) {
        for (Cluster& d : split_hub(c, h)) {
          divided.push_back(std::move(d));
        }
      }
      all = std::move(divided);
    }
  }
  if (all.empty()) {
    throw Error(ErrorCode::internal, "a junction of more than 6 branches could not be divided among cubes");
  }
  constexpr std::size_t kMost = 4;
  all.resize(std::min(all.size(), kMost));
  return all;
}

}  // namespace

ClusterResult solve_cluster(const ImplicitSurface& surface, const Cluster& cluster, const BlockOptions& options) {
  const double start = thread_cpu_seconds();
  std::optional<ClusterResult> best;
  int tried = 0;
  const auto is_good = [&] {
    return best && best->solution.certified && best->solution.min_jacobian >= options.good_jacobian;
  };
  const auto attempt = [&](const Cluster& c, const std::vector<CubeAssignment>& assignments) {
    ClusterResult r;
    r.cluster = c;
    r.assignments = assignments;
    r.blocks = cluster_blocks(surface, c, assignments);
    r.solution = optimise_blocks(r.blocks.problem);
    ++tried;
    if (!best || r.solution.is_better_than(best->solution)) {
      best = std::move(r);
    }
  };
  for (const Cluster& c : with_small_hubs(cluster)) {
    std::vector<CubeAssignment> assignments;
    for (const Hub& hub : c) {
      assignments.push_back(assignments_of(hub, 1).front());
    }
    if (!is_good()) {
      attempt(c, assignments);
    }
  }
  constexpr int kMostRounds = 6;
  std::vector<char> done(best->cluster.size(), 0);
  for (int round = 0; round < kMostRounds && !is_good(); ++round) {
    const std::optional<int> hub = weakest_hub(*best, done);
    if (!hub) {
      break;
    }
    const ClusterResult before = *best;
    const std::vector<CubeAssignment> others = assignments_of(before.cluster[*hub], options.candidates);
    for (std::size_t rank = 1; rank < others.size() && !is_good(); ++rank) {
      std::vector<CubeAssignment> assignments = before.assignments;
      assignments[*hub] = others[rank];
      attempt(before.cluster, assignments);
    }
    if (before.cluster[*hub].arms.size() >= 4) {
      for (const Cluster& c : split_hub(before.cluster, *hub)) {
        std::vector<CubeAssignment> assignments = before.assignments;
        assignments[*hub] = assignments_of(c[*hub], 1).front();
        for (std::size_t h = before.cluster.size(); h < c.size(); ++h) {
          assignments.push_back(assignments_of(c[h], 1).front());
        }
        if (!is_good()) {
          attempt(c, assignments);
        }
      }
    }
    done.resize(best->cluster.size(), 1);
    done[*hub] = 1;
  }
  best->candidates = tried;
  best->cpu_seconds = thread_cpu_seconds() - start;
  return std::move(*best);
}

}  // namespace vasohex
