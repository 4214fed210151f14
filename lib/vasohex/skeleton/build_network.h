#pragma once
/// \file From a skeleton to a network of smooth axes.

#include <map>
#include <optional>
#include <set>
#include <string>

#include "vasohex/core/run.h"
#include "vasohex/skeleton/network.h"
#include "vasohex/skeleton/skeleton.h"

namespace vasohex {

struct NetworkOptions {
  /// The end, as an index of Skeleton::points, that is named `inlet`. Default: the root of the skeleton if that is an
  /// end, otherwise the widest end of each component.
  std::optional<int> inlet;
  /// Names of ends by index of Skeleton::points; they take precedence over Skeleton::names.
  std::map<int, std::string> names;
  /// Ends, as indices of Skeleton::points, where the vessel closes: they get no name.
  std::set<int> blind;
};

/// Cleans, splits, smooths and resamples a skeleton: any graph with several components, cycles, and points of any
/// degree.
///
/// - Nodes are the points with one segment (ends) or more than two (junctions), ascending by point; a closed curve
///   without a junction gets its point of lowest index as seam. They keep their positions exactly.
/// - Branches that go straight on at a junction (within 40 degrees, no other pair nearly as straight) form one smooth
///   curve through it. Axes are C2 inside a branch and through such junctions.
/// - Edges of more than 10 radii from which that curve would swing out by more than 0.25 radii are kept straight, apart
///   from some radii at corners: those are passed with a bend of about 2 radii, up to 1 radius off the edge at right angles.
/// - Points closer than about their radius are smoothed as far as their noise asks for, others are interpolated. No
///   point moves by more than 0.2 radii, no radius changes by more than 20 %, except as follows.
/// - Bends with less than 1.05 radii are rounded to 1.1 radii, unless that would move the axis by more than 4 radii (see
///   limit_bends). Every place where it moves by more than 0.1 radii is reported with how far.
/// - Where that moves a bend by more than one radius, a point there may be left out instead (see curve_near), if it is
///   not more than 4 of its radii off the axis then; each is reported with its distance.
/// - Where a node is more than 15 % wider than a branch one node radius away from it, the branch keeps its own radius
///   up to the node: a skeleton has but one radius per point, that of the widest branch.
/// - Radii change along the axis by at most 0.75 per length between points; steeper bulges are lowered.
/// - Junctions nearer to each other than 0.3 radii become one (see merge_junctions).
/// - Loops too short for a hole are left out (see straighten).
/// - Of loops of any number of branches that their own tubes fill, the branch without which the lumen changes least is
///   left out (see filled_loops).
/// - NetworkNode::radius is the largest radius of the branches that meet there.
/// - Ends: names given win; then per component, the largest volume first, `inlet`, `inlet_2`, ... and, ascending by
///   point, `outlet_1`, `outlet_2`, ...
///
/// Every change of the input is a line in Network::repairs; lines that start with `note: ` are observations without a
/// change (choice of an inlet). The result commutes with scaling and rigid motion.
/// Throws Error (bad_input) if the skeleton cannot be used (see clean), or a name is not for an end, not unique or
/// empty.
Network build_network(const Skeleton& skeleton, const NetworkOptions& options = {}, const Run& run = {});

}  // namespace vasohex
