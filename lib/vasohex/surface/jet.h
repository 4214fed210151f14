#pragma once
/// \file A piece of surface as a polynomial over a tangent plane.

#include <array>
#include <vector>

#include "vasohex/core/vec3.h"

namespace vasohex {

/// g(x) = w - h(u, v) in the frame (u, v, w) of `axes` at `origin`: negative below the surface w = h.
struct Jet {
  Vec3 origin = Vec3::Zero();
  Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();  ///< rows: two tangents, the normal
  int degree = 0;                                      ///< 1 to 3; 0: no polynomial could be fitted
  /// h = c0 + c1 u + c2 v + c3 u^2 + c4 u v + c5 v^2 + c6 u^3 + c7 u^2 v + c8 u v^2 + c9 v^3
  std::array<double, 10> c{};

  double value(const Vec3& x, Vec3& gradient) const {
    const Vec3 p = axes * (x - origin);
    const double u = p[0], v = p[1];
    const double h = c[0] + u * (c[1] + u * (c[3] + u * c[6])) + v * (c[2] + v * (c[5] + v * c[9])) +
                     u * v * (c[4] + u * c[7] + v * c[8]);
    const double hu = c[1] + u * (2 * c[3] + 3 * u * c[6]) + v * (c[4] + 2 * u * c[7] + v * c[8]);
    const double hv = c[2] + v * (2 * c[5] + 3 * v * c[9]) + u * (c[4] + u * c[7] + 2 * v * c[8]);
    gradient = axes.transpose() * Vec3(-hu, -hv, 1);
    return p[2] - h;
  }

  /// Unit, at the origin.
  Vec3 normal() const { return (axes.transpose() * Vec3(-c[1], -c[2], 1)).normalized(); }
};

/// Fits a jet at `origin` with tangent plane of `normal` (unit) to `points` by least squares, weighted by the
/// distance in units of `size`, the length of the edges there. The degree is lowered from 3 while there are too few
/// points, the fit is ill-conditioned (points on one side), or steep or far from the points within 1.6 sizes.
Jet fit_jet(const Vec3& origin, const Vec3& normal, double size, const std::vector<Vec3>& points);

}  // namespace vasohex
