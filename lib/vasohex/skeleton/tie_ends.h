#pragma once
/// \file Ends of a skeleton onto the ends of the lumen it lies in.

#include <string>
#include <vector>

#include "vasohex/skeleton/network.h"
#include "vasohex/skeleton/skeleton.h"
#include "vasohex/surface/tri_surface.h"

namespace vasohex {

/// Leads the skeleton's ends to the lumen's: the axis is cut where it comes out of an end's disc, or prolonged by up
/// to 4 radii where it stops short of one, and its last .8 radii bend so that it arrives in the middle, along the
/// normal. Points keep their numbers; an end's point lies at SurfaceEnd::centre, with its radius. `repairs` names ends
/// of the lumen that no vessel leads to. Returns the point of each of the lumen's ends, or -1.
std::vector<int> tie_ends(Skeleton& skeleton, const std::vector<SurfaceEnd>& ends, std::vector<std::string>& repairs);

/// Makes axes arrive at the ends along their normals exactly, so that caps lie in the planes that the vessels were cut
/// by. `points` as tie_ends returns them. Ends where the axis arrives at more than 45 degrees are left, and named.
void face_ends(Network& network, const std::vector<SurfaceEnd>& ends, const std::vector<int>& points);

}  // namespace vasohex
