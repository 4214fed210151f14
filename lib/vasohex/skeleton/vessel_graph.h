#pragma once
/// \file Vessels of a curve graph, without the spurs and splits that contraction leaves.

#include <array>
#include <string>
#include <vector>

#include "vasohex/skeleton/closed_lumen.h"
#include "vasohex/skeleton/collapse_to_graph.h"
#include "vasohex/surface/tri_surface.h"

namespace vasohex {

/// An end, a junction, or the seam of a closed vessel.
struct VesselNode {
  Vec3 position = Vec3::Zero();
  double width = 0;       ///< mean local width of the wall around it
  int end = -1;           ///< index of the SurfaceEnd, if it is one
  bool dead_end = false;  ///< a vessel ends here without a SurfaceEnd
};

/// A chain of points from one node to another, or back to the same one.
struct Vessel {
  std::array<int, 2> nodes{};
  std::vector<Vec3> points;    ///< [k >= 2] the positions of the nodes included
  std::vector<double> widths;  ///< [k]
};

struct VesselGraph {
  std::vector<VesselNode> nodes;
  std::vector<Vessel> vessels;
  std::vector<int> vessel_of;  ///< [points of the sized lumen], -1: of none
};

/// Splits the graph into vessels.
/// - Every SurfaceEnd is a node with one vessel.
/// - Dead ends stay if they reach out of the vessel they branch off by more than their own radius and 1.5 radii of that
///   vessel, 4 if their tip is thinner than .3 of it: bumps taper. They are prolonged to a third of a radius before the
///   wall. A note for each that stays, and for each that does not though it reaches further than its own radius. The
///   longest are judged first, and all from the vessel they are on, not from forks of their own.
/// - Junctions nearer to each other, along the vessel between them, than 0.2 local widths become one.
/// Adds to `notes` also pieces of the lumen without a vessel.
VesselGraph split_into_vessels(const CurveGraph& graph, const SizedLumen& sized, const ClosedLumen& lumen,
                               const std::vector<SurfaceEnd>& ends, std::vector<std::string>& notes);

}  // namespace vasohex
