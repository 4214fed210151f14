#pragma once
/// \file Where the axes of vessels meet.

#include <array>
#include <optional>
#include <vector>

#include "vasohex/skeleton/axis_path.h"
#include "vasohex/skeleton/axis_section.h"
#include "vasohex/skeleton/vessel_graph.h"

namespace vasohex {

/// A vessel between two junctions on one axis that has no wall of its own.
struct JunctionLink {
  std::array<int, 2> nodes{};
  Path path;  ///< between the nodes, without them
};

/// How vessels hang together.
struct JunctionLayout {
  std::vector<Station> nodes;               ///< those of the graph first; radius: of the widest vessel there
  std::vector<std::array<int, 2>> vessels;  ///< [vessels] their nodes; -1: is part of one of the links
  std::vector<std::array<std::optional<Vec3>, 2>>
      inward;  ///< [vessels] unit direction from the node, where it is known
  std::vector<JunctionLink> links;
};

/// Places the junctions of a graph where the axes `paths` of its vessels meet, of which the stations with a section
/// count. Dead ends go straight on, SurfaceEnds stay.
/// - Where side branches leave a vessel close to each other (through_vessel), its axis is that of circles (circle_of)
///   past their openings, in `paths` too, and each meets it where its line comes nearest. So each gets a junction, in
///   their order along the vessel, even if the graph has one for all; nearer than .3 radii they share one.
/// - Otherwise a junction is the point nearest to the axes of its vessels, wide ones weigh most.
JunctionLayout place_junctions(const VesselGraph& graph, const PartedLumen& lumen, std::vector<Path>& paths,
                               const std::vector<Station>& nodes, const std::vector<SurfaceEnd>& ends);

}  // namespace vasohex
