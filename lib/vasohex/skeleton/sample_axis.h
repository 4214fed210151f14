#pragma once
/// \file Samples of a branch along a spline, as dense as radius and curvature ask for.

#include <cstddef>
#include <vector>

#include "vasohex/skeleton/network.h"
#include "vasohex/skeleton/spline.h"

namespace vasohex {

/// A stretch of a spline between two of its knots, with radii.
struct AxisPiece {
  std::size_t first = 0, last = 0;  ///< knots, first < last
  std::vector<double> radii;        ///< [last - first + 1]
  std::vector<double> slopes;       ///< [last - first + 1], of the radius with respect to t
};

/// At least 5 samples with spacing <= 0.5 r and <= 0.25 / curvature (curvature counted up to 10 / r) everywhere, and
/// not many more; the density follows the need. Branch::nodes is left to the caller.
Branch sample_axis(const SpaceSpline& spline, const AxisPiece& piece);

}  // namespace vasohex
