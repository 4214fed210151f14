#pragma once
/// \file Equiangular skewness of hexahedra.

#include <span>
#include <vector>

#include "vasohex/core/run.h"
#include "vasohex/core/vec3.h"

namespace vasohex {

/// Largest max(t - 90, 90 - t) / 90 over the corner angles t, in degrees, of the 6 straight-sided faces: 0 for a
/// brick, 1 for an angle of 0 or 180 degrees, at an edge of no length, or where a coordinate is not finite.
/// `elements` is [n][(order + 1)^3] indices into `nodes`, lexicographic; order 1 to 9, else Error bad_input, as for
/// indices that are not in `nodes`.
std::vector<double> skewness(int order, std::span<const Vec3> nodes, std::span<const int> elements,
                             const Run& run = {});

}  // namespace vasohex
