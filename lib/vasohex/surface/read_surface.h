#pragma once
/// \file Readers of triangulated surfaces. Every error names the place in the file and what would be right.

#include <string>
#include <string_view>

#include "vasohex/surface/tri_surface.h"

namespace vasohex {

/// Reads a surface by the extension of its file: `.stl` (ASCII or binary), `.ply` (ASCII or binary, either byte
/// order),
/// `.obj`, `.off`. All numbers finite, indices in range, at least one triangle; otherwise as the file has it:
/// prepare_surface (prepare_surface.h) finds and repairs what is wrong with it as a surface. Quadrilaterals are split
/// at their shorter diagonal; faces with more corners are refused. The units are not stated by these formats.
/// Throws Error (bad_input) with file, place (line, or triangle), what is wrong and what would be right.
TriSurface read_surface(const std::string& path);

/// The bytes of a file, as read_surface without the name of the file. STL repeats the points of each triangle: those
/// with equal coordinates become one.
TriSurface parse_stl(std::string_view bytes);
TriSurface parse_ply(std::string_view bytes);
TriSurface parse_obj(std::string_view text);
TriSurface parse_off(std::string_view text);

/// Adds the triangle or quadrilateral with these corners [3 or 4]. The message for an Error: empty, or what is wrong.
std::string add_face(TriSurface& surface, const std::vector<long long>& corners);

}  // namespace vasohex
