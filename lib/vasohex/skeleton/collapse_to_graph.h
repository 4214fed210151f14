#pragma once
/// \file A contracted surface becomes a graph.

#include <array>
#include <vector>

#include "vasohex/core/vec3.h"
#include "vasohex/skeleton/remesh.h"

namespace vasohex {

/// Curves in the inside of a lumen and the part of its wall that each of their points stands for.
struct CurveGraph {
  std::vector<Vec3> points;
  std::vector<std::array<int, 2>> edges;
  std::vector<int> node_of;  ///< [points of the lumen] point of the graph
  std::vector<int> anchors;  ///< [ends] point of the graph at SurfaceEnd::centre
  int cycles = 0;            ///< number of independent cycles
};

/// Collapses the edges of the contracted surface, the shortest first in relation to the local width, until it has no
/// triangle. Points move to the mean of the points of the surface that they stand for; anchors stay. If the graph
/// then has more independent cycles than `genus`, its shortest cycles become points; it may have fewer, where a hole
/// closed in the contraction.
CurveGraph collapse_to_graph(const SizedLumen& lumen, const std::vector<Vec3>& contracted, int genus);

}  // namespace vasohex
