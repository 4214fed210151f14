#pragma once
/// \file A vascular network as the user gives it: points with radii, joined by segments.

#include <array>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "vasohex/core/vec3.h"

namespace vasohex {

/// Any graph: several components, cycles, points of any degree.
struct Skeleton {
  std::vector<Vec3> points;                  ///< [n]
  std::vector<double> radii;                 ///< [n], same unit as the points
  std::vector<std::array<int, 2>> segments;  ///< [m], indices of points
  std::map<int, std::string> names;          ///< of end points, optional (`inlet`, `outlet_left`, ...)
  std::optional<int> root;                   ///< the point the file starts from, if the format has one (SWC)
  std::string units;                         ///< `mm`, `cm`, `m`, `um`, or empty: not stated
};

}  // namespace vasohex
