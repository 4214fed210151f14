#pragma once
/// \file From triangles as a file has them to a lumen that can be meshed.

#include <string>
#include <vector>

#include "vasohex/surface/tri_surface.h"

namespace vasohex {

struct PreparedSurface {
  TriSurface surface;                  ///< manifold, oriented outward, open at the ends: flat caps are dropped
  std::vector<SurfaceEnd> ends;        ///< open rims and the planes of dropped caps, by the first point of the rim
  std::vector<std::vector<int>> rims;  ///< [ends] points of each rim, counter-clockwise about the end's normal
  int components = 0;                  ///< lumens that are not connected
  std::vector<std::string> repairs;    ///< one line each: what was changed, where; and what is odd
};

/// Repairs a surface: welds points closer than rounding, and across cracks, removes triangles without area or given
/// twice, separates sheets that share an edge or a point, turns all triangles outward, drops fragments (below 1 % of
/// the largest component's area) and components inside others, closes holes in the wall, and drops flat caps. An
/// opening counts as the end of a vessel if the wall meets its plane steeply, as a hole otherwise. A region counts as
/// a cap if it is about plane (within 25 degrees and .15 of its radius; its rim within .05), round, and the wall
/// leaves it steeply (45 degrees on average). Ends whose rim is torn or folded are cut back (ragged_ends.h).
///
/// Throws Error (bad_input) with the place if an index is out of range, a coordinate is not finite, no triangle
/// remains, or a component has one side only (a Moebius band).
PreparedSurface prepare_surface(TriSurface surface);

}  // namespace vasohex
