#pragma once
/// \file The steps of prepare_surface that make triangles a manifold. Each adds lines to `repairs` for what it
/// changed.

#include <string>
#include <vector>

#include "vasohex/surface/tri_surface.h"

namespace vasohex {

/// Throws Error (bad_input) for indices out of range and coordinates that are not finite.
void check_triangles(const TriSurface& surface);

/// Points closer than the rounding of single precision become one, the first; triangles with equal corners go.
void weld_points(TriSurface& surface, std::vector<std::string>& repairs);

/// Points of rims closer than a tenth of the shortest edge there become one, the first: cracks between triangles that
/// were meant to be neighbours.
void weld_cracks(TriSurface& surface, std::vector<std::string>& repairs);

/// Of triangles with the same corners one remains, or none where they are a film between others that close the
/// surface.
void drop_copies(TriSurface& surface, std::vector<std::string>& repairs);

/// Triangles without height lose their longest edge to the neighbour's other diagonal.
void flip_needles(TriSurface& surface, std::vector<std::string>& repairs);

/// Sheets that share an edge or a point get points of their own.
void separate_sheets(TriSurface& surface, std::vector<std::string>& repairs);

/// All triangles of a component turn alike, and outward: the volume that a component encloses, its openings closed
/// by the shortest fans, is positive. Throws Error (bad_input) for a component with one side only.
void orient_outward(TriSurface& surface, std::vector<std::string>& repairs);

/// Drops components of less than 1 % of the area of the largest, and those inside another. The count that remains.
int drop_fragments(TriSurface& surface, std::vector<std::string>& repairs);

/// Points that no triangle uses go; the others keep their order.
void drop_unused_points(TriSurface& surface);

/// Sum of the signed solid angles of the triangles over 4 pi (A. Van Oosterom, J. Strackee, 1983): 1 inside of a
/// closed surface, 0 outside, near them where it is open. Brute force.
double winding_number(const TriSurface& surface, const Vec3& x);

}  // namespace vasohex
