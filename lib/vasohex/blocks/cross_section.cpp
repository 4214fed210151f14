#include "vasohex/blocks/cross_section.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "vasohex/surface/project.h"

namespace vasohex {
namespace {

// The core is a square with bulged sides: x = a (kMiddle - kBulge b^2) for a, b in [-1, 1], y likewise. Its corners
// lie at radius 0.6. At a core corner three quads meet; the bulge splits the full turn into 122.4 degrees for the
// core and 118.8 twice, the best compromise of curved elements (scaled Jacobian .844) and of straight ones with 6 per
// edge (.853).
constexpr double kMiddle = 0.4856;
constexpr double kBulge = 0.0616;

Eigen::Vector2d core_point(double a, double b) {
  return {a * (kMiddle - kBulge * b * b), b * (kMiddle - kBulge * a * a)};
}

}  // namespace

SectionFrame turned(const SectionFrame& frame, double angle) {
  SectionFrame t = frame;
  t.x = std::cos(angle) * frame.x + std::sin(angle) * frame.y;
  t.y = std::cos(angle) * frame.y - std::sin(angle) * frame.x;
  return t;
}

Eigen::Vector2d section_point(int quad, double u, double v) {
  if (quad == 0) {
    return core_point(1 - 2 * u, 1 - 2 * v);
  }
  // quad 1 lies at the top: b = 1, a from 1 to -1; the others are its quarter-turns
  const double a = 1 - 2 * v;
  const double angle = std::numbers::pi / 2 - std::numbers::pi / 4 * a;
  Eigen::Vector2d p = (1 - u) * core_point(a, 1) + u * Eigen::Vector2d(std::cos(angle), std::sin(angle));
  for (int turn = 1; turn < quad; ++turn) {
    p = Eigen::Vector2d(-p.y(), p.x());
  }
  return p;
}

Vec3 place_section_point(const ImplicitSurface& surface, const SectionFrame& frame, int quad, double u, double v) {
  const Eigen::Vector2d p = section_point(quad, u, v);
  const double part = p.norm();
  if (part < 1e-12) {
    return frame.origin;
  }
  const Vec3 direction = (p.x() * frame.x + p.y() * frame.y) / part;
  const double wall = shoot(surface, frame.origin, direction, frame.radius, 3 * frame.radius).value_or(frame.radius);
  // towards the axis the stretch fades to the nominal radius: the map stays smooth there
  const double stretch = part * wall + (1 - part) * frame.radius;
  return frame.origin + part * stretch * direction;
}

}  // namespace vasohex
