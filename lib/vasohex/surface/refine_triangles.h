#pragma once
/// \file Triangles made fine and even enough for jets.

#include <functional>

#include "vasohex/surface/tri_surface.h"

namespace vasohex {

/// Divides edges longer than .4 of the local radius, and those longer than .2 of it and twice the shortest edge of
/// their triangle, up to 6 rounds. New points lie on the cubic that the normals of the two ends make (A. Vlachos et
/// al., Curved PN triangles, 2001), on the straight edge where these differ by more than 60 degrees. Neighbours stay
/// neighbours; the points that were there keep their numbers.
void refine_triangles(TriSurface& surface, const std::function<double(const Vec3&)>& radius);

}  // namespace vasohex
