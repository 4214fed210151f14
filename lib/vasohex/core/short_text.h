#pragma once
/// \file Numbers and places as messages show them.

#include <string>

#include "vasohex/core/vec3.h"

namespace vasohex {

/// Six significant digits at most.
std::string short_text(double value);

/// Rounded to hundredths.
std::string hundredths(double value);

/// `(x y z)`
std::string short_text(const Vec3& point);

}  // namespace vasohex
