#pragma once
/// \file Long thin triangles made into even ones.

#include <functional>

#include "vasohex/surface/tri_surface.h"

namespace vasohex {

/// Triangles that are longer than .4 of the local radius and three times their shortest edge are divided in the middle
/// of one of their long edges, and flat quadrilaterals around them get the diagonal that is Delaunay, until there are
/// none, or for 30 rounds. That edge is divided across which the surface bends: the sides of a strip, whose diagonals
/// are then flipped. To divide all long edges leaves needles. The new points are the middles of straight edges: along
/// such an edge the wall is straight, or the triangulation would have points there, and the normals of needles say
/// nothing of it. The points that were there keep their numbers.
void cut_needles(TriSurface& surface, const std::function<double(const Vec3&)>& radius);

}  // namespace vasohex
