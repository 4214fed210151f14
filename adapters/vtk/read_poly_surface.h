#pragma once
/// \file Reader of surfaces in VTK's formats (needs VTK).

#include <string>

#include "vasohex/surface/tri_surface.h"

namespace vasohex {

/// Reads the polygons of a `.vtp` file, or of a legacy `.vtk` file that holds polydata: triangles, quadrilaterals
/// (split at their shorter diagonal) and triangle strips. Lines and single points are left aside. As the file has it:
/// prepare_surface finds and repairs what is wrong with it as a surface. The units are not stated by these formats.
/// Throws Error (bad_input): no such file, another format, damaged or cut off, no triangles, faces with more corners,
/// coordinates that are not finite.
TriSurface read_poly_surface(const std::string& path);

}  // namespace vasohex
