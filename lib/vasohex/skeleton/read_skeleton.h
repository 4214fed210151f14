#pragma once
/// \file Readers of skeleton files. Every error names the place in the file and what would be right.

#include <string>
#include <string_view>

#include "vasohex/skeleton/skeleton.h"

namespace vasohex {

/// Reads a skeleton by the extension of its file, `.swc` or `.json`. Radii are > 0, all numbers finite, indices in
/// range, at least one segment. Throws Error (bad_input) with file, place, what is wrong and what would be right.
Skeleton read_skeleton(const std::string& path);

/// The text of an SWC file: one point a line, `id type x y z radius parent`, parent -1 for a root; several roots are
/// several components. Points are numbered in the order of their lines. A comment `# units: cm` states the unit.
/// Throws as read_skeleton, without the name of the file.
Skeleton parse_swc(std::string_view text);

/// The text of a JSON skeleton, `{"format": "vascular-graph-1", "units": "mm", "points": [[x, y, z], ..],
/// "radius": [r, ..], "branches": [[point, point, ..], ..], "names": {"point": "name", ..}}`; `units` and `names` are
/// optional, further keys are not read. Throws as read_skeleton, without the name of the file.
Skeleton parse_skeleton_json(std::string_view text);

/// The unit that a text starts with (`mm (RAS+)` is mm): one of um, mm, cm, m; empty for any other text.
std::string length_unit(std::string_view text);

}  // namespace vasohex
