#pragma once
/// \file A smooth way from 0 to 1.

#include <algorithm>

namespace vasohex {

/// 0 for x <= 0, 1 for x >= 1, the quintic with vanishing first and second derivatives at both between.
inline double smooth_step(double x) {
  x = std::clamp(x, 0.0, 1.0);
  return x * x * x * (10 + x * (6 * x - 15));
}

}  // namespace vasohex
