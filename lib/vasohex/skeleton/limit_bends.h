#pragma once
/// \file Bends of an axis that are sharper than a tube allows are rounded.

#include <cstddef>
#include <vector>

#include "vasohex/skeleton/spline.h"

namespace vasohex {

struct LimitedBends {
  /// Stretch of a curve that was rounded.
  struct Bend {
    std::size_t knot = 0;  ///< the nearest one of the curve that was
    double moved = 0;      ///< largest displacement, in radii
  };
  SpaceSpline spline;         ///< C2, with other knots; fixed ones are still among them
  std::vector<double> t;      ///< [knots of the curve that was] their parameters now, ascending
  std::vector<Bend> rounded;  ///< in order
};

/// The curve itself unless it bends somewhere with less than 1.05 radii. Otherwise the curve that follows it, but with
/// bend radii of 1.1 radii or more: sharper stretches shrink inwards until they are as wide as that, the rest stays.
/// Where that would take more than 4 radii, as at the tip of a hairpin, the curve is left as it is.
///
/// radii [knots]; fixed [knots]: position must not change. Of a closed curve the last knot is the first one again.
LimitedBends limit_bends(const SpaceSpline& curve, const std::vector<double>& radii, const std::vector<bool>& fixed,
                         bool closed);

/// The same for a polyline [n >= 2] without pieces of length zero, whose ends stay. It gets other points, a quarter of
/// a radius apart.
void limit_bends(std::vector<Vec3>& points, std::vector<double>& radii);

}  // namespace vasohex
