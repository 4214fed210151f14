#pragma once
/// \file A closed surface shrinks onto curves in its inside.

#include <vector>

#include "vasohex/core/run.h"
#include "vasohex/skeleton/remesh.h"

namespace vasohex {

/// The points of the lumen after contraction [Au et al. 2008]: near curves in the middle of the vessels, anchors
/// where they were. Each step is one implicit step of mean curvature flow, (M + L) x' = M x, with the cotangent
/// Laplacian L of the shrinking surface and masses M of the first one over the square of the local width, so that
/// narrow and wide vessels become thin after the same number of steps. What has become thin stays where it is, since
/// M then outweighs L.
std::vector<Vec3> contract_surface(const SizedLumen& lumen, const Run& run);

}  // namespace vasohex
