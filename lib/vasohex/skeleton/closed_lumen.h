#pragma once
/// \file A lumen without openings: every rim is closed by a fan, around the centre of the end that it is.

#include <string>
#include <vector>

#include "vasohex/surface/tri_surface.h"

namespace vasohex {

struct ClosedLumen {
  TriSurface surface;         ///< a closed manifold
  std::vector<int> opposite;  ///< [3 triangles] see half_edges.h
  std::vector<bool> is_cap;   ///< [triangles] closes an opening, is not wall
  std::vector<int> anchors;   ///< [ends] point at SurfaceEnd::centre
  int genus = 0;              ///< sum over the components: the number of holes through the lumen
};

/// Adds a line to `notes` for each opening that is none of the ends. Throws Error (bad_input) if the surface has no
/// triangles, is not a manifold of one orientation (prepare_surface makes it one), or has no opening for an end.
ClosedLumen close_lumen(const TriSurface& surface, const std::vector<SurfaceEnd>& ends,
                        std::vector<std::string>& notes);

}  // namespace vasohex
