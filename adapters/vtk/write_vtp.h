#pragma once
/// \file Writer of skeletons as VTK XML polydata (no VTK needed).

#include <string>

#include "vasohex/skeleton/skeleton.h"

namespace vasohex {

/// Writes one polyline per branch as VTP, ASCII with exact numbers; branches share their nodes' points. Point data:
/// `Radius`. Cell data: `branch`. The file is complete or not there; Error bad_input if it cannot be written.
void write_vtp(const Skeleton& skeleton, const std::string& path);

}  // namespace vasohex
