#pragma once
/// \file Axes of vessels in the middle of their cross-sections.

#include <array>
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

/// From one node to another, or back to the same one.
struct CentredAxis {
  std::array<int, 2> nodes{};
  std::vector<AxisSample> samples;  ///< [>= 2] half a radius apart; first and last at the nodes
};

struct CentredAxes {
  std::vector<AxisSample> nodes;  ///< radius: the largest of the vessels that meet there
  std::vector<int> end_of;        ///< [nodes] index of the SurfaceEnd, -1: none
  std::vector<CentredAxis> axes;
};

/// Moves the vessels of a graph to the centroids of plane cross-sections, whose area gives the radius.
/// - A section counts where its wall belongs to the vessel; openings of side branches are closed by chords up to a
/// fifth
///   of the way around. `vessel_of` tells the vessel of each vertex of the lumen.
/// - Where it does not, near junctions, the axis goes on to where place_junctions puts them; this may part a junction
///   of the graph into several.
/// - At a SurfaceEnd the axis ends at its centre and runs along its normal, with its radius.
CentredAxes centre_axes(const VesselGraph& graph, const ClosedLumen& lumen, const std::vector<int>& vessel_of,
                        const std::vector<SurfaceEnd>& ends, const Run& run);

}  // namespace vasohex
