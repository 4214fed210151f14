#include "vasohex/core/short_text.h"

#include <cmath>
#include <cstdio>

namespace vasohex {

std::string short_text(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.6g", value);
  return text;
}

std::string hundredths(double value) { return short_text(std::round(100 * value) / 100); }

std::string short_text(const Vec3& point) {
  return "(" + short_text(point.x()) + " " + short_text(point.y()) + " " + short_text(point.z()) + ")";
}

}  // namespace vasohex
