#pragma once
/// \file The search for good blocks of a cluster: assignments to cubes, trees of cubes.

#include <vector>

#include "vasohex/blocks/build_blocks.h"
#include "vasohex/blocks/hubs.h"
#include "vasohex/blocks/junction.h"
#include "vasohex/blocks/optimise.h"

namespace vasohex {

struct ClusterResult {
  Cluster cluster;                          ///< as solved: hubs may have been divided
  std::vector<CubeAssignment> assignments;  ///< [hubs]
  ClusterBlocks blocks;
  BlockSolution solution;
  int candidates = 0;      ///< arrangements tried
  double cpu_seconds = 0;  ///< processor time
};

/// One cube per junction; while that is weak, other assignments of the weakest junction's arms, or a tree of cubes
/// there. Returns the best. Deterministic.
ClusterResult solve_cluster(const ImplicitSurface& surface, const Cluster& cluster, const BlockOptions& options);

/// A first look at the same cluster with cubes and caps elsewhere: with one candidate its first arrangement alone;
/// with more, others while they look promising, and of several hubs the weakest anew. The result has no blocks, and
/// is not better than any other, if nothing looked promising. Deterministic.
ClusterResult try_cluster(const ImplicitSurface& surface, const Cluster& cluster, const BlockOptions& options);

/// Whether the search ended so folded that a long one elsewhere has not helped in any network seen.
bool is_hopeless(const ClusterResult& result);

}  // namespace vasohex
