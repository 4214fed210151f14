#pragma once
/// \file A junction divided among several cubes: what one cube cannot hold well, or not at all.

#include <vector>

#include "vasohex/blocks/hubs.h"

namespace vasohex {

/// Most branches that one cube can take.
inline constexpr int kCubeArms = 6;

/// Clusters in which hub `h` is replaced by a tree of cubes: arms near each other (closer than 75 degrees, unless the
/// hub has more than kCubeArms) share a cube halfway to their crotch, linked to the others' cube, the nearest pair
/// first, then two pairs, ... and the nearest three of five or more. None if no arms are that near.
std::vector<Cluster> split_hub(const Cluster& cluster, int h);

}  // namespace vasohex
