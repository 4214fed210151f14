#include "vasohex/mesh/wall_node.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace vasohex {
namespace {

constexpr double kPrecise = 1e-8;  // radii: length of the last step of Newton, taken without another look

/// Newton, within the plane of normal `plane` unless it is null. The blocks' walls lie close by, so an evaluation
/// saved counts: the length of the last step is the bound.
WallNode closest(const ImplicitSurface& surface, const Vec3& start, const Vec3* plane, double radius) {
  WallNode w;
  w.point = start;
  Vec3 gradient;
  for (int iteration = 0; iteration < 30 && !w.converged; ++iteration) {
    const double value = surface.value(w.point, gradient);
    if (plane) {
      gradient -= plane->dot(gradient) * *plane;
    }
    Vec3 step = -value / std::max(gradient.squaredNorm(), 1e-300) * gradient;
    const double length = step.norm();
    if (length > 0.5 * radius) {
      step *= 0.5 * radius / length;
    }
    w.point += step;
    w.residual = length / radius;
    w.converged = w.residual < kPrecise;
  }
  w.converged = w.converged && (w.point - start).norm() <= kFurthestShift * radius;
  w.normal = gradient.normalized();
  return w;
}

/// The nearest crossing of the line through `start`, outward where `start` is inside, inward where it is outside: not
/// further than ten times the distance of the surface.
std::optional<WallNode> along_line(const ImplicitSurface& surface, const Vec3& start, const Vec3& outward,
                                   double radius) {
  WallNode w;
  Vec3 gradient;
  double value = surface.value(start, gradient);
  const double near = std::abs(value) / gradient.norm();
  const double side = value < 0 ? 1 : -1;
  const Vec3 direction = side * outward;
  const double limit = std::min(10 * near, kFurthestAlongLine * radius);
  double before = 0, behind = near;  // the crossing lies between them
  while (true) {
    if (!(behind <= limit)) {
      return std::nullopt;
    }
    value = side * surface.value(start + behind * direction, gradient);
    if (value >= 0) {
      break;
    }
    before = behind;
    behind += std::max(-value / gradient.norm(), 0.1 * near);
  }
  double t = behind;
  for (int iteration = 0; iteration < 60; ++iteration) {
    const double rate = side * gradient.dot(direction);
    double next = t - value / rate;
    if (!(rate > 0 && next >= before && next <= behind)) {
      next = 0.5 * (before + behind);
    }
    w.residual = std::abs(next - t) / radius;
    t = next;
    if (w.residual < kPrecise) {
      w.converged = true;
      w.point = start + t * direction;
      w.normal = gradient.normalized();
      return w;
    }
    value = side * surface.value(start + t * direction, gradient);
    (value < 0 ? before : behind) = t;
  }
  return std::nullopt;
}

}  // namespace

WallNode onto_wall(const ImplicitSurface& surface, const Vec3& start, const Vec3& outward, const Vec3* plane,
                   double radius) {
  if (!surface.is_round()) {
    const Vec3 within = plane ? Vec3(outward - plane->dot(outward) * *plane).normalized() : outward;
    if (std::optional<WallNode> w = along_line(surface, start, within, radius)) {
      if (plane) {
        w->normal = (w->normal - plane->dot(w->normal) * *plane).normalized();
      }
      return *w;
    }
  }
  return closest(surface, start, plane, radius);
}

}  // namespace vasohex
