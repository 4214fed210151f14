#pragma once
/// \file The first step from a skeleton to a network: faults of the graph are repaired, each with a report.

#include <string>
#include <vector>

#include "vasohex/skeleton/skeleton.h"

namespace vasohex {

/// The skeleton with the same points, numbered as before, and cleaned segments: none of length zero (neighbours
/// closer than 1e-6 of the smaller radius become one point, the one of lowest index, which inherits a name), none
/// twice. Adds one line to `repairs` for each change, and for points that no segment uses. Throws Error (bad_input)
/// if sizes differ, an index is out of range, a number is not finite, a radius is not > 0 or no segment remains.
Skeleton clean(const Skeleton& skeleton, std::vector<std::string>& repairs);

/// `point 12 (1.5 -3 0.25)`, to name a place in messages.
std::string place_of(const Skeleton& skeleton, int point);

}  // namespace vasohex
