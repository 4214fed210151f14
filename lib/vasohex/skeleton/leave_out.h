#pragma once
/// \file The curve of a path whose points may fold it back and forth.

#include <vector>

#include "vasohex/skeleton/smooth_path.h"

namespace vasohex {

/// The curve of curve_near_all, unless rounding moves a bend of an open path by more than one radius: then a point
/// nearby is left out, not more than 4 of its radii from the curve, if the curve moves and turns less in all.
PathCurve curve_near(const PathPoints& path, const std::vector<double>& radii);

}  // namespace vasohex
