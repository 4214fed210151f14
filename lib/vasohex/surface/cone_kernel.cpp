#include "vasohex/surface/cone_kernel.h"

namespace vasohex {

double cone_scale(double slope) {
  // F of the infinite cone of radius 1 at t = 0, on its surface: the integral over q = S^2 (1 + g t)^2 - 1 - t^2 > 0.
  constexpr double reach2 = kernel_reach * kernel_reach;
  const double g = std::clamp(slope, -0.6, 0.6);
  const double c0 = reach2 - 1, c1 = reach2 * g, c2 = reach2 * g * g - 1;
  const double root = std::sqrt(c1 * c1 - c0 * c2);
  const double from = (c1 - root) / -c2, to = (c1 + root) / -c2;
  constexpr int steps = 32;  // the trapezoidal rule in an angle: the integrand is even and smooth there
  constexpr double pi = 3.14159265358979323846;
  double sum = 0;
  for (int k = 1; k < steps; ++k) {
    const double angle = pi * k / steps;
    const double t = 0.5 * (from + to) - 0.5 * (to - from) * std::cos(angle);
    const double q = c0 + (2 * c1 + c2 * t) * t, r = 1 + g * t;
    sum += q * q * q / std::pow(r, 7) * std::sin(angle);
  }
  return 1 / (sum * 0.5 * (to - from) * pi / steps);
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
    nearest.ratio = (x - nearest.point).norm() / nearest.radius;
    return nearest;
  };
  // d/dt of (h^2 + (t - p)^2) / r^2 vanishes at t = p + g h^2 / r(p), a minimum when r(p) > 0.
  const double radius = segment.radius + segment.slope * p;
  if (radius > 0) {
    const double h2 = (w - p * segment.direction).squaredNorm();
    return at(std::clamp(p + segment.slope * h2 / radius, 0.0, segment.length));
  }
  const ConeNearest first = at(0), last = at(segment.length);
  return first.ratio <= last.ratio ? first : last;
}

}  // namespace vasohex
