#pragma once
/// \file Smoothing of one path, a chain of branches that continue each other: position and radius.

#include <vector>

#include "vasohex/core/vec3.h"
#include "vasohex/skeleton/spline.h"

namespace vasohex {

/// Points along a path with bounds on what may change. Of a closed path the first point is not repeated.
struct PathPoints {
  std::vector<Vec3> points;  ///< [n]
  std::vector<bool> fixed;   ///< [n], position must not change (nodes)
  bool closed = false;
};

/// A point where the curve was changed, and how far that moved it, in radii.
struct PathBend {
  std::size_t point = 0;
  double moved = 0;
};

/// 0 = t[0] < ..., lengths of the polyline up to each point; closed: one entry more, the length of the whole.
std::vector<double> polyline_length(const std::vector<Vec3>& points, bool closed);

/// Radii at knots t [n] (closed: [n + 1]), smoothed as far as their noise asks for, by at most 20 %.
std::vector<double> smooth_radii(const std::vector<double>& t, const std::vector<double>& radii, bool closed);

/// The largest radii that are nowhere above the given ones and change by at most 0.75 per length.
std::vector<double> limit_slope(const std::vector<double>& t, std::vector<double> radii, bool closed);

/// A C2 curve near the points: smoothed as far as their noise asks for, moved by at most 0.2 radii. One knot per
/// point, of a closed path the first again at the end. radii [n]: the scale of noise that matters.
SpaceSpline smooth_points(const PathPoints& path, const std::vector<double>& radii);

/// A C2 curve near the points that neither swings out between points far apart nor bends too sharply for a tube.
struct PathCurve {
  SpaceSpline spline;
  std::vector<double> t;        ///< [n] (closed: [n + 1]) parameter of each point, ascending; fixed ones are at knots
  std::vector<double> moved;    ///< [n] displacement of each point by smoothing, in radii
  std::vector<PathBend> bends;  ///< rounded
  std::vector<PathBend> left_out;  ///< points that the curve does not follow (see leave_out.h), their distance
  int straightened = 0;         ///< edges that got knots of their own
  double off_edge = 0;          ///< largest distance of the curve from such an edge, in radii
  std::size_t off_edge_at = 0;  ///< the nearer point of the path
};

/// The curve of smooth_points, with two exceptions: an edge of more than 10 radii that it leaves by more than 0.25
/// radii is followed as a straight line, apart from some radii at corners, which are passed with a bend of about 2
/// radii; and bends sharper than a tube allows are rounded (see limit_bends).
PathCurve curve_near_all(const PathPoints& path, const std::vector<double>& radii);

}  // namespace vasohex
