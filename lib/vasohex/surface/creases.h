#pragma once
/// \file Sharp edges that are meant: where two smooth pieces of a triangulated surface meet.

#include <functional>
#include <vector>

#include "vasohex/surface/tri_surface.h"

namespace vasohex {

struct Creases {
  std::vector<std::vector<int>> along;  ///< [points] the other ends of the creases' edges there
  std::vector<char> edges;              ///< [half-edges] 1 on a crease
  /// [half-edges] angle-weighted normal at the half-edge's start of the triangles around it, as far as no crease parts
  /// them from its own one; unit, zero where these have no area.
  std::vector<Vec3> normals;

  bool at(int point) const { return !along[point].empty(); }
};

/// An edge is sharp if the surface turns there by more than 15 degrees and twice as much as, in the mean, at the other
/// edges of its two triangles: a coarse or rough triangulation turns everywhere. Sharp edges that hang together are a
/// crease if most of their length turns by more than 50 degrees and three times as much as around, if they are as
/// large as the local diameter, and if at most a tenth of their points has another edge that turns half as much, or a
/// fork: noise is as large as its creases.
Creases find_creases(const TriSurface& surface, const std::function<double(const Vec3&)>& radius);

}  // namespace vasohex
