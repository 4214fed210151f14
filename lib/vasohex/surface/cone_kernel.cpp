#include "vasohex/surface/cone_kernel.h"

#include <array>
#include <numbers>

namespace vasohex {

using std::numbers::pi;

double cone_scale(double slope) {
  // F of the infinite cone of radius 1 at t = 0, on its surface: the integral over q = S^2 (1 + g t)^2 - 1 - t^2 > 0.
  constexpr double reach2 = kernel_reach * kernel_reach;
  const double g = std::clamp(slope, -0.6, 0.6);
  const double c0 = reach2 - 1, c1 = reach2 * g, c2 = reach2 * g * g - 1;
  const double root = std::sqrt(c1 * c1 - c0 * c2);
  const double from = (c1 - root) / -c2, to = (c1 + root) / -c2;
  // The trapezoidal rule in an angle, where the integrand is even and smooth: t = middle - half * cos(angle).
  static const std::array<Eigen::Array2d, 31> circle = [] {
    std::array<Eigen::Array2d, 31> points;
    for (int k = 0; k < 31; ++k) {
      const double angle = pi * (k + 1) / 32;
      points[k] = {std::cos(angle), std::sin(angle)};
    }
    return points;
  }();
  double sum = 0;
  for (const Eigen::Array2d& point : circle) {
    const double t = 0.5 * (from + to) - 0.5 * (to - from) * point[0];
    const double q = c0 + (2 * c1 + c2 * t) * t, inverse = 1 / (1 + g * t);
    const double a = q * inverse * inverse;
    sum += a * a * a * inverse * point[1];
  }
  return 1 / (sum * 0.5 * (to - from) * pi / 32);
}

ConeSegment cone_segment(const Vec3& start, double start_radius, const Vec3& end, double end_radius, int piece) {
  ConeSegment segment;
  segment.start = start;
  segment.length = (end - start).norm();
  segment.direction = (end - start) / segment.length;
  segment.radius = start_radius;
  segment.slope = (end_radius - start_radius) / segment.length;
  segment.scale = cone_scale(segment.slope);
  segment.piece = piece;
  return segment;
}

ConeNearest cone_nearest(const ConeSegment& segment, const Vec3& x) {
  const Vec3 w = x - segment.start;
  const double p = w.dot(segment.direction);
  const auto at = [&](double t) {
    ConeNearest nearest;
    nearest.point = segment.start + t * segment.direction;
    nearest.radius = segment.radius + segment.slope * t;
    const double distance = (x - nearest.point).norm();
    nearest.ratio = distance / nearest.radius;
    if (distance > 0) {
      nearest.gradient = (x - nearest.point) / (distance * nearest.radius);
    }
    return nearest;
  };
  // d/dt of (h^2 + (t - p)^2) / r^2 vanishes at t = p + g h^2 / r(p), a minimum when r(p) > 0.
  const double radius = segment.radius + segment.slope * p;
  ConeNearest nearest;
  if (radius > 0) {
    const double h2 = (w - p * segment.direction).squaredNorm();
    nearest = at(std::clamp(p + segment.slope * h2 / radius, 0.0, segment.length));
  } else {
    const ConeNearest first = at(0), last = at(segment.length);
    nearest = first.ratio <= last.ratio ? first : last;
  }
  if (segment.end_fade > 0) {
    const double beyond = segment.end_normal.dot(x) - segment.end_offset - segment.end_fade;
    const double end_radius = segment.end_fade / end_fade_radii;
    if (beyond >= 0 && kernel_reach + beyond / end_radius > nearest.ratio) {
      nearest.ratio = kernel_reach + beyond / end_radius;
      nearest.gradient = segment.end_normal / end_radius;
    }
  }
  return nearest;
}

}  // namespace vasohex
