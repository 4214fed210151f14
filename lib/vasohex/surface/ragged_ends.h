#pragma once
/// \file Ends whose rim is torn, folded or bevelled.

#include <string>
#include <vector>

#include "vasohex/surface/tri_surface.h"

namespace vasohex {

/// Cuts the wall back at open rims that turn back around their own middle, by more than .2 radians: segmentations cut
/// by the edge of the image have dents and flaps there, which no section of a vessel has. The plane is parallel to
/// the rim's, as little further inside as it takes for a rim that turns one way, a radius at most; where that is not
/// enough the rim stays. Likewise by half a radius at most where the wall turns towards the rim, and no
/// longer does there: grids bevel the edges of flat ends. One line of `repairs` for each. Triangles: a manifold,
/// oriented outward. Leaves points unused.
void cut_ragged_ends(TriSurface& surface, std::vector<std::string>& repairs);

}  // namespace vasohex
