#pragma once
/// \file Cubic smoothing splines through noisy points on a line or on a circle.

#include <Eigen/Core>
#include <span>
#include <vector>

#include "vasohex/core/vec3.h"

namespace vasohex {

/// Knots in ascending order and one value, of any dimension, at each. Of a closed curve the last knot is the first
/// one after a period and has no row of its own in `values`: t has one entry more than `values` has rows.
struct KnotData {
  std::vector<double> t;   ///< [n], of a closed curve [n + 1]
  Eigen::MatrixXd values;  ///< [n, dimension]
  bool closed = false;     ///< a closed curve needs n >= 3, an open one n >= 2
};

/// A C2 curve in space: at its knots, points and second derivatives with respect to t.
struct SpaceSpline {
  std::vector<double> t;          ///< [k]
  std::vector<Vec3> points;       ///< [k]
  std::vector<Vec3> derivatives;  ///< [k], second

  struct Value {
    Vec3 position, first, second;
  };
  /// Position and derivatives at `t` in the piece between knots `piece` and `piece + 1`.
  Value at(std::size_t piece, double t) const;
};

double curvature(const SpaceSpline::Value& value);

/// Cubic smoothing spline [Reinsch 1967]: minimises sum (x_i - values_i)^2 / compliance_i + integral of |x''|^2.
/// compliance [n] >= 0, a length cubed: 0 interpolates, h^3 lets a value move about as far as needed to straighten a
/// stretch of length h. At open ends the curvature runs out evenly.
struct Smoothed {
  Eigen::MatrixXd values;  ///< [n, dimension] of the spline at the knots
  Eigen::MatrixXd second;  ///< [n, dimension] second derivatives of the spline at the knots
};
Smoothed smooth(const KnotData& data, std::span<const double> compliance);

/// The curve of a smoothing spline in three dimensions; of a closed one with the first knot again at the end.
SpaceSpline spline_through(const KnotData& data, const Smoothed& fit);

/// The standard deviation of the noise of one value component at each knot, from differences of fourth order (lower
/// in short data) over some neighbours: close to zero for smooth data, however bent.
std::vector<double> noise_level(const KnotData& data);

/// Slopes dy/dt at the knots of the C1 cubic Hermite interpolant that is monotone between neighbours [Fritsch,
/// Butland 1984], so never overshoots. t, y [n >= 2].
std::vector<double> monotone_slopes(std::span<const double> t, std::span<const double> y);

/// Cubic Hermite interpolant at fraction u in [0, 1] of an interval of length h: value and derivative.
template <class T>
T hermite(const T& y0, const T& d0, const T& y1, const T& d1, double h, double u) {
  const double v = 1 - u;
  return (1 + 2 * u) * v * v * y0 + u * u * (3 - 2 * u) * y1 + h * u * v * (v * d0 - u * d1);
}
template <class T>
T hermite_derivative(const T& y0, const T& d0, const T& y1, const T& d1, double h, double u) {
  return 6 * u * (1 - u) / h * (y1 - y0) + (1 - u) * (1 - 3 * u) * d0 + u * (3 * u - 2) * d1;
}

}  // namespace vasohex
