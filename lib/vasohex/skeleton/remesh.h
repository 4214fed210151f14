#pragma once
/// \file Triangles whose size follows the width of the lumen.

#include <vector>

#include "vasohex/core/run.h"
#include "vasohex/skeleton/closed_lumen.h"

namespace vasohex {

struct SizedLumen {
  TriSurface surface;          ///< a closed manifold
  std::vector<bool> is_cap;    ///< [triangles] see ClosedLumen
  std::vector<double> widths;  ///< [points] see local_thickness
  std::vector<int> anchors;    ///< [ends] vertex at SurfaceEnd::centre
};

/// The closed lumen with edges of about `edge` times the local width: long edges are halved, short ones collapsed,
/// edges flipped to be Delaunay. Topology is kept. New points lie on the old triangles.
SizedLumen remesh(const ClosedLumen& lumen, double edge, const Run& run);

}  // namespace vasohex
