#pragma once
/// \file Junctions near each other and the vessels that come to them.

#include <algorithm>
#include <array>
#include <optional>
#include <vector>

#include "vasohex/skeleton/axis_path.h"
#include "vasohex/skeleton/vessel_graph.h"
#include "vasohex/surface/tri_surface.h"

namespace vasohex {

/// The line along which a vessel comes to a node.
struct Arrival {
  int vessel = 0;
  bool back = false;  ///< with the end of its path
  Vec3 point = Vec3::Zero();
  Vec3 outward = Vec3::UnitZ();  ///< unit, away from the node
  double radius = 0;
  double calibre = 0;   ///< radius further out, where the mouth does not widen it
  bool is_end = false;  ///< no section counts: it is a SurfaceEnd
};

/// Over the first stations that count; none where fewer than two do.
std::optional<Arrival> arrival_of(const Path& path, int vessel, bool back);

using Arrivals = std::vector<std::array<std::optional<Arrival>, 2>>;

/// [vessels][start, goal] As above, otherwise the line of a SurfaceEnd at the other end.
Arrivals arrivals_of(const VesselGraph& graph, const std::vector<Path>& paths, const std::vector<SurfaceEnd>& ends);

/// Junctions near each other, and the vessels that leave them.
struct Cluster {
  std::vector<int> nodes;
  std::vector<int> inner;  ///< vessels between the nodes
  std::vector<Arrival> arms;
  bool is_complete = true;  ///< all arms have a line

  bool has(int node) const { return std::find(nodes.begin(), nodes.end(), node) != nodes.end(); }
};

Cluster cluster_of(const VesselGraph& graph, const Arrivals& arrivals, const std::vector<int>& nodes);

/// All nodes, those together that vessels shorter than three widths join.
std::vector<std::vector<int>> near_junctions(const VesselGraph& graph, const std::vector<Path>& paths);

}  // namespace vasohex
