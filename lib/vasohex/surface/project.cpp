#include "vasohex/surface/project.h"

#include <algorithm>
#include <cmath>

namespace vasohex {

Projection project(const ImplicitSurface& surface, const Vec3& x, double trust, double tolerance) {
  const double radius = surface.radius(x);
  const double longest = trust > 0 ? trust : 0.5 * radius;
  const double near = tolerance * radius;

  Projection result;
  result.point = x;
  Vec3 gradient;
  double value = surface.value(x, gradient);
  double slope = gradient.norm();
  for (int iteration = 0; iteration < 50; ++iteration) {
    if (!(slope > 0)) {
      return result;
    }
    result.normal = gradient / slope;
    const double distance = std::abs(value) / slope;
    if (distance <= near) {
      result.converged = true;
      return result;
    }
    double step = std::min(distance, longest);
    const Vec3 downhill = value > 0 ? Vec3(-result.normal) : result.normal;
    bool closer = false;
    for (int halving = 0; halving < 12 && !closer; ++halving, step *= 0.5) {
      const Vec3 trial = result.point + step * downhill;
      Vec3 trial_gradient;
      const double trial_value = surface.value(trial, trial_gradient);
      const double trial_slope = trial_gradient.norm();
      // Far away the first-order distance may grow although the value falls (near an axis the gradient vanishes):
      // a step cut by the trust region need only bring the value down.
      const bool falls = std::abs(trial_value) < std::abs(value);
      closer = falls && (distance > longest || std::abs(trial_value) < distance * trial_slope);
      if (closer) {
        result.point = trial;
        gradient = trial_gradient;
        value = trial_value;
        slope = trial_slope;
      }
    }
    if (!closer) {
      return result;
    }
  }
  return result;
}

std::optional<double> shoot(const ImplicitSurface& surface, const Vec3& origin, const Vec3& direction,
                            double length_scale, double t_max) {
  Vec3 gradient;
  double inside = 0;  // the ray is inside here
  double value = surface.value(origin, gradient);
  if (!(value < 0)) {
    return std::nullopt;
  }
  // March by the first-order distance until the ray has left: short steps next to the wall, so a gap is not missed.
  double outside = 0;
  while (true) {
    if (inside >= t_max) {
      return std::nullopt;
    }
    const double slope = gradient.norm();
    const double shortest = 0.05 * length_scale, longest = 0.5 * length_scale;
    const double step = -0.8 * value < slope * longest ? std::max(-0.8 * value / slope, shortest) : longest;
    const double t = std::min(inside + step, t_max);
    value = surface.value(origin + t * direction, gradient);
    if (value >= 0) {
      outside = t;
      break;
    }
    inside = t;
  }
  // Newton, kept within the bracket by bisection.
  const double precision = 1e-12 * length_scale;
  double t = outside;
  for (int iteration = 0; iteration < 200; ++iteration) {
    const double rate = gradient.dot(direction);
    double next = t - value / rate;
    const bool newton = rate > 0 && next >= inside && next <= outside;
    if (newton && std::abs(next - t) <= precision) {
      return next;
    }
    if (!newton) {
      next = 0.5 * (inside + outside);
    }
    if (outside - inside <= precision) {
      return next;
    }
    t = next;
    value = surface.value(origin + t * direction, gradient);
    (value < 0 ? inside : outside) = t;
  }
  return t;
}

}  // namespace vasohex
