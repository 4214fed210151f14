#pragma once
/// \file Which junctions of a network stand alone, which are linked, and where their branches are cut off.

#include <vector>

#include "vasohex/blocks/junction.h"
#include "vasohex/skeleton/network.h"
#include "vasohex/surface/implicit_surface.h"

namespace vasohex {

/// Junctions linked to each other, directly or through others.
using Cluster = std::vector<Hub>;

/// What cannot be told before: where cubes and caps stand best.
struct Placement {
  /// Radii from a cube to where two of three branches that leave side by side part; infinity: it stands at the node.
  double before_parting = 1;
  double beyond = 0;          ///< radii that caps stand further out than they need, where there is room
};

/// All clusters of the network, in the order of their first node: the same ones for any placement. Caps lie where the
/// surface around the branch is a tube again; branches too short for two caps become links.
std::vector<Cluster> find_clusters(const Network& network, const ImplicitSurface& surface,
                                   const Placement& placement = {});

/// The stretches of the network that the cluster's blocks take up.
std::vector<Stretch> stretches_of(const Network& network, const Cluster& cluster);

/// Distance along each branch end at `node` at which the other branches leave room for a cap, by cap_distance.
/// [branch ends at the node], in the order of branch_ends().
std::vector<double> cap_distances(const Network& network, int node);

}  // namespace vasohex
