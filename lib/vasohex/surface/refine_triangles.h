#pragma once
/// \file Triangles made fine and even enough for jets.

#include <functional>

#include "vasohex/surface/tri_surface.h"

namespace vasohex {

/// Cuts needles (cut_needles.h), then divides edges longer than .4 of the local radius, and the longest of a triangle that is longer than .2 of it and
/// twice the shortest, up to 6 rounds. New points lie on the cubic that the normals of the two ends make
/// (A. Vlachos et al., Curved PN triangles, 2001), the normals being those of jets (jet.h); in the middle of the
/// straight edge at creases and where that cubic is more than .1 of the radius away. Neighbours stay neighbours; the
/// points that were there keep their numbers.
void refine_triangles(TriSurface& surface, const std::function<double(const Vec3&)>& radius);

}  // namespace vasohex
