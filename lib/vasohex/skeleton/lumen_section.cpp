#include "vasohex/skeleton/lumen_section.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
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

double depth_at(const LevelSet& level_set, const Vec3& x) {
  double value;
  return level_set.value(x, value, nullptr) ? -value : -std::numeric_limits<double>::infinity();
}

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
  Vec3 best = x;
  double depth = depth_at(level_set, x);
  for (double s = step; s > 0.1 * step;) {
    double value;
    Vec3 gradient;
    if (!level_set.value(best, value, &gradient) || !(gradient.norm() > 0)) {
      break;
    }
    const Vec3 trial = best - s * gradient.normalized();
    const double there = depth_at(level_set, trial);
    if (there > depth && (trial - x).norm() <= longest) {
      best = trial;
      depth = there;
    } else {
      s *= 0.5;
    }
  }
  return best;
}

}  // namespace vasohex
