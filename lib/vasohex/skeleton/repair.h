#pragma once
/// \file Repair, on request, of what diagnose finds.

#include "vasohex/core/run.h"
#include "vasohex/skeleton/build_network.h"
#include "vasohex/skeleton/network.h"
#include "vasohex/skeleton/skeleton.h"

namespace vasohex {

/// Largest changes that repairs make.
constexpr double kLeastRadius = 0.4;  ///< of the radius that was
constexpr double kLargestMove = 0.5;  ///< radii

/// The network of a skeleton (see build_network), repaired:
/// - Side branches that end inside their parent, tiny separate pieces and pieces inside another vessel are left out,
///   unless an end of them was given a name.
/// - Vessels that overlap or touch away from junctions become thinner there, both by the same factor (not below
///   kLeastRadius) and smoothly, until the gap is 5 % of the smaller radius. If that is not enough they are also
///   moved apart, by at most kLargestMove each; nodes stay where they are. If that is not enough either, both are
///   left as they are and a line says so.
/// Every change is a line in Network::repairs. Commutes with scaling and rigid motion.
Network build_repaired_network(const Skeleton& skeleton, const NetworkOptions& options = {}, const Run& run = {});

/// The part of it that makes vessels thinner and moves them apart.
void part_vessels(Network& network);

}  // namespace vasohex
