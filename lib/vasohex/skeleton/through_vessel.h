#pragma once
/// \file A vessel that runs through several junctions, and where its side branches meet it.

#include <array>
#include <optional>
#include <vector>

#include "vasohex/skeleton/axis_section.h"
#include "vasohex/skeleton/junction_arms.h"

namespace vasohex {

/// A vessel that branches off another one.
struct SideBranch {
  Arrival arm;
  Path path;         ///< its stations within the other vessel do not count
  int junction = 0;  ///< index
};

/// Side branches along the vessel that runs through, and the junctions they share.
struct ThroughVessel {
  Path axis;  ///< over the last stations before and after the junctions too, see leg_size
  std::array<Arrival, 2> arms;
  std::vector<double> junctions;  ///< places on the axis, ascending
  std::vector<SideBranch> sides;
  std::vector<int> nodes, inner;  ///< of the cluster, that the junctions and the links replace
};

/// How many of the stations that count, from a junction on, are taken for the axis of the vessel that runs through.
std::size_t leg_size(const Path& stations, double radius);

/// The vessel that runs through a cluster: two arms much wider than all others and not side by side. Its axis is that
/// of circles (circle_of) past the openings of the others, and they meet it where their lines come nearest, but at no
/// angle below 70 degrees: an arm that bends at its mouth has a line that misses the wall around it. Nearer to each
/// other than .3 radii they share a junction. Nodes of the cluster outside of the vessel, by the radius of what
/// leaves them, stay, and what leads there is a side branch. Nothing if the cluster has fewer than four arms, no
/// such pair of them, an arm without a line or one that passes the axis, or a cycle.
std::optional<ThroughVessel> through_vessel(const Cluster& cluster, const VesselGraph& graph,
                                            const Arrivals& arrivals, const PartedLumen& lumen,
                                            const std::vector<Path>& paths);

}  // namespace vasohex
