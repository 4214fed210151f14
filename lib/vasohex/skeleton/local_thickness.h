#pragma once
/// \file How wide a lumen is at each point of its wall.

#include <vector>

#include "vasohex/core/run.h"
#include "vasohex/surface/tri_surface.h"

namespace vasohex {

/// Radius of the largest ball inside the lumen that touches the wall at or near each point and again across the
/// lumen, > 0: on a tube its radius, on other sections about half their smallest width. Points where there is no such
/// ball (convex edges, triangles with is_cap, which do not count as wall) take the value of the nearest point along
/// the surface that has one. [points]. From shrinking balls [Ma, Bae, Choi 2012]: good to the distance between
/// points.
std::vector<double> local_thickness(const TriSurface& surface, const std::vector<bool>& is_cap, const Run& run);

}  // namespace vasohex
