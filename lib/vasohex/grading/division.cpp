#include "vasohex/grading/division.h"

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
  std::vector<double> d{0};
  double height = first;
  const double wanted = first * geometric_sum(layers.growth, layers.layers);
  shrunk = wanted > 0.9 * length;
  if (shrunk) {
    height *= 0.9 * length / wanted;
  }
  for (int i = 0; i < layers.layers; ++i) {
    d.push_back(d.back() + height);
    height *= layers.growth;
  }
  const int rest = count - layers.layers;
  const double last = height / layers.growth;
  const double gap = length - d.back();
  // ratio g with last (g + g^2 + ... + g^rest) = gap: the sum increases with g
  double low = 1e-3, high = 1e3;
  for (int i = 0; i < 80; ++i) {
    const double g = std::sqrt(low * high);
    (last * g * geometric_sum(g, rest) < gap ? low : high) = g;
  }
  const double g = std::sqrt(low * high);
  const double scale = gap / (last * g * geometric_sum(g, rest));
  double part = last * g * scale;
  for (int i = 0; i < rest; ++i) {
    d.push_back(d.back() + part);
    part *= g;
  }
  d.back() = length;
  return d;
}

}  // namespace vasohex
