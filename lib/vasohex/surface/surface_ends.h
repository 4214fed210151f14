#pragma once
/// \file The steps of prepare_surface that find where vessels end. Triangles are a manifold, oriented outward.

#include <string>
#include <vector>

#include "vasohex/surface/tri_surface.h"

namespace vasohex {

/// Drops the triangles of flat caps, so that their rims are open.
void drop_caps(TriSurface& surface, std::vector<std::string>& repairs);

/// Closes openings that are holes in the wall, by a fan around a new point in the middle.
void close_holes(TriSurface& surface, std::vector<std::string>& repairs);

/// The end at an open rim; `rim`: its points, counter-clockwise about the end's normal.
SurfaceEnd rim_end(const TriSurface& surface, const std::vector<int>& rim);

/// The open rims, as close_holes leaves them.
std::vector<std::vector<int>> open_rims(const TriSurface& surface);

}  // namespace vasohex
