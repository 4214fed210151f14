#include "vasohex/grading/division.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "vasohex/core/error.h"

namespace vasohex {
namespace {

/// 1 + g + ... + g^(n-1)
double geometric_sum(double g, int n) {
  double sum = 0, term = 1;
  for (int i = 0; i < n; ++i) {
    sum += term;
    term *= g;
  }
  return sum;
}

/// The g > 0 with 1 + g + ... + g^(n-1) = sum > 1; n >= 2.
double ratio_of_sum(int n, double sum) {
  // Newton's method from above: the sum is convex in g
  double g = std::pow(sum, 1.0 / (n - 1));
  for (int iteration = 0; iteration < 60; ++iteration) {
    double value = 1, slope = 0;
    for (int i = 1; i < n; ++i) {
      slope = slope * g + value;
      value = value * g + 1;
    }
    const double step = (value - sum) / slope;
    g -= step;
    if (!(step > 1e-14 * g)) {
      break;
    }
  }
  return g;
}

/// How much of a line towards the wall layers may take.
constexpr double kMostOfLine = 0.75;
/// Lengths that differ by less than this part are compared smoothly.
constexpr double kBlend = 0.15;

/// The lesser of two lengths, rounded off where they differ by less than `width`: twice continuously differentiable.
double smooth_lesser(double a, double b, double width) {
  const double h = std::max(0.0, width - std::abs(a - b));
  return std::min(a, b) - (h > 0 ? h * h * h / (6 * width * width) : 0.0);
}

double law_at(const Law& law, int i, int count) {
  const double t = static_cast<double>(i) / count;
  if (const auto* geometric = std::get_if<GeometricLaw>(&law)) {
    return geometric_sum(geometric->growth, i) / geometric_sum(geometric->growth, count);
  }
  if (const auto* tanh = std::get_if<TanhLaw>(&law)) {
    return 0.5 * (1 + std::tanh(tanh->stretching * (2 * t - 1)) / std::tanh(tanh->stretching));
  }
  if (const auto* custom = std::get_if<CustomLaw>(&law)) {
    return custom->position(t);
  }
  return t;
}

}  // namespace

std::vector<double> divide(const Law& law, int count) {
  std::vector<double> t(count + 1, 0.0);
  for (int i = 1; i < count; ++i) {
    t[i] = law_at(law, i, count);
  }
  t[count] = 1;
  for (int i = 0; i < count; ++i) {
    if (!(t[i] < t[i + 1])) {
      throw Error(ErrorCode::bad_input,
                  "grading law: position " + std::to_string(t[i + 1]) + " of division " + std::to_string(i + 1) +
                      " of " + std::to_string(count) +
                      " does not lie beyond the one before it; a law must increase from 0 to 1");
    }
  }
  return t;
}

bool is_symmetric(const Law& law, int count) {
  const std::vector<double> t = divide(law, count);
  for (int i = 0; i <= count; ++i) {
    if (std::abs(t[i] + t[count - i] - 1) > 1e-12) {
      return false;
    }
  }
  return true;
}

std::vector<double> divide_wall_line(const WallLayers& layers, double first, int count, double length, bool& shrunk) {
  const int n = layers.layers;
  const double wanted = first * geometric_sum(layers.growth, n), room = kMostOfLine * length;
  shrunk = room < wanted;
  const double total = smooth_lesser(wanted, room, kBlend * wanted);
  double height = first, growth = layers.growth;
  if (total < wanted) {
    // those below the first one make room, as long as they are thicker than it
    const double spare = wanted / n - first;
    height = spare > 0 ? smooth_lesser(first, total / n, std::min(kBlend * first, spare)) : first * total / wanted;
    growth = spare > 0 ? ratio_of_sum(n, total / height) : growth;
  }
  std::vector<double> d{0};
  for (int i = 0; i < n; ++i) {
    d.push_back(d.back() + height);
    height *= growth;
  }
  // the rest grows or shrinks from the last layer on, all by one ratio
  const int rest = count - n;
  const double last = d[n] - d[n - 1], gap = length - d[n];
  const double ratio = ratio_of_sum(rest + 1, 1 + gap / last);
  double part = last * ratio;
  for (int i = 0; i < rest; ++i) {
    d.push_back(d.back() + part);
    part *= ratio;
  }
  d.back() = length;
  return d;
}

}  // namespace vasohex
