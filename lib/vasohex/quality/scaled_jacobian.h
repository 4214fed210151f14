#pragma once
/// \file Scaled Jacobian of hexahedra: 1 for a brick, <= 0 where inverted.

#include <span>
#include <vector>

#include "vasohex/core/run.h"
#include "vasohex/core/vec3.h"
#include "vasohex/mesh/hex_mesh.h"

namespace vasohex {

// `elements` is [n][(order + 1)^3] indices into `nodes`, lexicographic, on the nodes of `family`; order 1 to 9, else
// Error bad_input, as for indices that are not in `nodes`. An element with a coordinate that is not finite counts as
// -1.

/// Of the straight-sided hexahedron: least determinant of the three unit edge vectors over its 8 corners [Verdict,
/// without its sample at the centre]. 0 where an edge has no length.
std::vector<double> scaled_jacobian_linear(int order, std::span<const Vec3> nodes, std::span<const int> elements,
                                           const Run& run = {});

/// Of the curved hexahedron: least det J / (|J1||J2||J3|) over the uniform lattice of (2 * order + 1)^3 points.
std::vector<double> scaled_jacobian(int order, NodeFamily family, std::span<const Vec3> nodes,
                                    std::span<const int> elements, const Run& run = {});

}  // namespace vasohex
