#pragma once
/// \file A junction divided among several cubes: what one cube cannot hold well, or not at all; and junctions too near
/// each other for a cube each, made one.

#include <utility>
#include <vector>

#include "vasohex/blocks/hubs.h"

namespace vasohex {

/// Most branches that one cube can take.
inline constexpr int kCubeArms = 6;

/// Clusters in which hub `h` is replaced by a tree of cubes: pairs or triples of arms near each other share a cube on
/// the way to where they part, linked to that of the others. At most about a hundred, those with the narrowest groups
/// first; none if no arms are near each other. The new hubs stand at `h` and behind the old ones.
std::vector<Cluster> split_hub(const Cluster& cluster, int h);

/// Clusters in which hub `h` and one that a link shorter than three radii leads to are one hub, in the middle
/// between them, with the arms of both; where both link to a third hub they stay two. It stands at the lesser of the
/// two places.
std::vector<std::pair<Cluster, int>> merge_hub(const Cluster& cluster, int h);

/// After hubs have moved: lets axes start at their hub's centre, and those of links end at the other's. False if
/// nothing is left of one.
bool renew_axes(Cluster& cluster);

}  // namespace vasohex
