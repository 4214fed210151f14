#pragma once
/// \file Triangulated shapes whose surface is known, and networks with their radii.

#include <cmath>
#include <functional>
#include <numbers>

#include "vasohex/skeleton/network.h"
#include "vasohex/surface/tri_surface.h"

namespace vasohex {

/// Triangles of a grid of points: `along` rows, each a closed ring of `around`; the last row joins the first if
/// `closed`. `point(i, j)` of row i; rows follow each other so that (row, ring) turn outward.
inline TriSurface ring_grid(int along, int around, bool closed, const std::function<Vec3(double, double)>& point) {
  TriSurface s;
  const int rows = closed ? along : along + 1;
  for (int i = 0; i < rows; ++i) {
    for (int j = 0; j < around; ++j) {
      s.points.push_back(point(static_cast<double>(i) / along, static_cast<double>(j) / around));
    }
  }
  for (int i = 0; i < along; ++i) {
    for (int j = 0; j < around; ++j) {
      const int a = i * around + j, b = i * around + (j + 1) % around;
      const int c = (i + 1) % rows * around + j, d = (i + 1) % rows * around + (j + 1) % around;
      if ((i + j) % 2 == 0) {
        s.triangles.push_back({a, b, d});
        s.triangles.push_back({a, d, c});
      } else {
        s.triangles.push_back({a, b, c});
        s.triangles.push_back({b, d, c});
      }
    }
  }
  return s;
}

inline Branch straight_or_bent(int count, const std::function<Vec3(double)>& axis,
                               const std::function<double(double)>& radius) {
  Branch b;
  for (int i = 0; i <= count; ++i) {
    const double t = static_cast<double>(i) / count;
    b.points.push_back(axis(t));
    b.radii.push_back(radius(t));
    b.tangents.push_back((axis(t + 1e-6) - axis(t - 1e-6)).normalized());
    b.arc.push_back(i == 0 ? 0 : b.arc.back() + (b.points[i] - b.points[i - 1]).norm());
  }
  return b;
}

inline Network one_branch(Branch branch) {
  Network n;
  n.branches.push_back(std::move(branch));
  return n;
}

/// Around z, tube radius 1.
struct TorusShape {
  double bend = 3;
  TriSurface triangles(int around) const {
    const int along = static_cast<int>(std::lround(bend * around));
    return ring_grid(along, around, true, [&](double t, double u) {
      const double a = 2 * std::numbers::pi * t, b = 2 * std::numbers::pi * u;
      return Vec3((bend + std::cos(b)) * std::cos(a), (bend + std::cos(b)) * std::sin(a), -std::sin(b));
    });
  }
  Network network() const {
    return one_branch(straight_or_bent(
        200,
        [&](double t) {
          return Vec3(bend * std::cos(2 * std::numbers::pi * t), bend * std::sin(2 * std::numbers::pi * t), 0);
        },
        [](double) { return 1.0; }));
  }
  double distance(const Vec3& x) const { return std::hypot(std::hypot(x[0], x[1]) - bend, x[2]) - 1; }
};

/// An open tube along z from 0 to `length`, of radius 1 + slope * z.
struct TubeShape {
  double length = 8;
  double slope = 0;
  TriSurface triangles(int around) const {
    const int along = static_cast<int>(std::lround(length * around / (2 * std::numbers::pi)));
    return ring_grid(along, around, false, [&](double t, double u) {
      const double r = 1 + slope * t * length, b = 2 * std::numbers::pi * u;
      return Vec3(r * std::cos(b), r * std::sin(b), t * length);
    });
  }
  Network network() const {
    return one_branch(straight_or_bent(
        100, [&](double t) { return Vec3(0, 0, t * length); }, [&](double t) { return 1 + slope * t * length; }));
  }
  double distance(const Vec3& x) const {
    return (std::hypot(x[0], x[1]) - 1 - slope * x[2]) / std::hypot(1.0, slope);
  }
};

}  // namespace vasohex
