#include "vasohex/skeleton/lumen_section.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace vasohex {
namespace {

constexpr int kRays = 16;

/// Length of a ray that starts inside up to the wall, at most `longest`.
double ray_length(const LevelSet& level_set, const Vec3& x, const Vec3& direction, double at_start, double longest) {
  const double shortest = 0.25 * level_set.lattice().spacing.minCoeff();
  double inside = 0, outside = 0, value = at_start;
  while (true) {
    const double t = inside + std::max(-value, shortest);
    if (t >= longest) {
      return longest;
    }
    if (!level_set.value(x + t * direction, value, nullptr) || value >= 0) {
      outside = t;
      break;
    }
    inside = t;
  }
  for (int halving = 0; halving < 12; ++halving) {
    const double middle = 0.5 * (inside + outside);
    const bool in = level_set.value(x + middle * direction, value, nullptr) && value < 0;
    (in ? inside : outside) = middle;
  }
  return 0.5 * (inside + outside);
}

}  // namespace

std::optional<LumenSection> measure_section(const LevelSet& level_set, const Vec3& x, const Vec3& normal,
                                            double longest) {
  double value;
  if (!level_set.value(x, value, nullptr) || value >= 0) {
    return std::nullopt;
  }
  const Vec3 a = normal.unitOrthogonal(), b = normal.cross(a);
  std::array<double, kRays> length{};
  std::array<Vec3, kRays> direction;
  for (int k = 0; k < kRays; ++k) {
    const double angle = 2 * std::numbers::pi * k / kRays;
    direction[k] = std::cos(angle) * a + std::sin(angle) * b;
    length[k] = ray_length(level_set, x, direction[k], value, longest);
  }
  std::array<double, kRays> sorted = length;
  std::sort(sorted.begin(), sorted.end());
  LumenSection section;
  section.inscribed = sorted[0];
  const double most = std::min(longest, 2 * sorted[0]), median = 0.5 * (sorted[kRays / 2 - 1] + sorted[kRays / 2]);
  double area = 0;
  for (int k = 0; k < kRays; ++k) {
    const bool open = length[k] > most;
    section.open |= open;
    const double t = std::min(length[k], most);
    section.shift += (2.0 / kRays * t) * direction[k];
    const double counted = open ? std::min(median, most) : t;
    area += counted * counted / kRays;
  }
  section.radius = std::sqrt(area);
  return section;
}

Vec3 deepest_near(const LevelSet& level_set, const Vec3& x, double step, double longest) {
  Vec3 best = x, gradient;
  double lowest;
  if (!level_set.value(x, lowest, &gradient)) {
    return x;
  }
  for (double s = step; s > 0.1 * step && gradient.norm() > 0;) {
    const Vec3 trial = best - s * gradient.normalized();
    Vec3 slope;
    double value;
    if ((trial - x).norm() <= longest && level_set.value(trial, value, &slope) && value < lowest) {
      best = trial;
      lowest = value;
      gradient = slope;
    } else {
      s *= 0.5;
    }
  }
  return best;
}

double inscribed_radius(const LevelSet& level_set, const Vec3& x, double longest) {
  double value;
  if (!level_set.value(x, value, nullptr) || value >= 0) {
    return 0;
  }
  double radius = longest;
  for (int n = 0; n < 27; ++n) {
    if (n != 13) {
      const Vec3 direction = Vec3(n % 3 - 1, n / 3 % 3 - 1, n / 9 - 1).normalized();
      radius = std::min(radius, ray_length(level_set, x, direction, value, radius));
    }
  }
  return radius;
}

}  // namespace vasohex
