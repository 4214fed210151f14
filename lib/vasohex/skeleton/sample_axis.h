#pragma once
/// \file Samples of a branch along a spline, as dense as radius and curvature ask for.

#include <array>
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

/// The sharpest bend of an axis, measured against its radius.
struct Bend {
  double radius_over_curvature_radius = 0;  ///< above 1, cross-sections overlap
  Vec3 position = Vec3::Zero();
};

/// At least 5 samples with spacing <= 0.5 r and <= 0.25 / curvature (curvature counted up to 10 / r) everywhere, and
/// not many more; the density follows the need. Branch::nodes is left to the caller. `bend` receives the sharpest
/// one, except over the lengths `inside` at start and end.
Branch sample_axis(const SpaceSpline& spline, const AxisPiece& piece, const std::array<double, 2>& inside,
                   Bend& bend);

}  // namespace vasohex
