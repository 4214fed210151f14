#pragma once
/// \file Axes of vessels in the middle of their cross-sections.

#include <vector>

#include "vasohex/core/run.h"
#include "vasohex/skeleton/closed_lumen.h"
#include "vasohex/skeleton/vessel_graph.h"

namespace vasohex {

/// A point on the axis of a vessel and the radius of the disc with the area of the cross-section there.
struct AxisSample {
  Vec3 point = Vec3::Zero();
  double radius = 0;
};

/// Axes of all vessels; node positions and radii in `nodes`.
struct CentredAxes {
  std::vector<AxisSample> nodes;              ///< [nodes] radius: the largest of the vessels that meet there
  std::vector<std::vector<AxisSample>> axes;  ///< [vessels][>= 2] half a radius apart; first and last at the nodes
};

/// Moves the vessels of a graph to the centroids of plane cross-sections, whose area gives the radius.
/// - A section counts where its wall belongs to the vessel; openings of side branches are closed by chords up to a
/// fifth
///   of the way around. `vessel_of` tells the vessel of each vertex of the lumen.
/// - Where it does not, near junctions, the axis goes straight on: a junction is the point nearest to the axes of its
///   vessels, wide ones weigh most.
/// - At a SurfaceEnd the axis ends at its centre and runs along its normal, with its radius.
CentredAxes centre_axes(const VesselGraph& graph, const ClosedLumen& lumen, const std::vector<int>& vessel_of,
                        const std::vector<SurfaceEnd>& ends, const Run& run);

}  // namespace vasohex
