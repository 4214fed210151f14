#pragma once
/// \file Repairs of faults that tracing and thinning leave along the branches of a skeleton.

#include <array>
#include <string>
#include <vector>

#include "vasohex/skeleton/skeleton.h"

namespace vasohex {

/// The points of a branch from one node to another, or once around a closed curve (first and last point the same).
/// Nodes are the points with one segment or more than two; of a closed curve without such a point, its first.
using PointChain = std::vector<int>;

/// All branches of a clean skeleton (see clean), ascending by their first point.
std::vector<PointChain> split(const Skeleton& skeleton);

/// Takes the segments of a branch out of its skeleton.
void remove_chain(Skeleton& skeleton, const PointChain& chain);

/// A clean skeleton in which junctions nearer to each other, along the branch between them, than 0.3 of the larger
/// radius are one: the wider one stays where it is. Adds one line to `repairs` for each.
Skeleton merge_junctions(Skeleton skeleton, std::vector<std::string>& repairs);

/// A clean skeleton without closed tubes that have no hole: a branch back to its own start, or the longer of two
/// between the same points, where the way around is shorter than around a circle of the mean radius. Adds one line to
/// `repairs` for each. Throws Error (bad_input) if no segment remains.
Skeleton straighten(Skeleton skeleton, std::vector<std::string>& repairs);

}  // namespace vasohex
