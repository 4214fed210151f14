#pragma once
/// \file A point or direction as JSON.

#include <nlohmann/json.hpp>

#include "vasohex/core/vec3.h"

namespace vasohex::cli {

/// [x, y, z]
inline nlohmann::ordered_json xyz(const Vec3& p) { return {p.x(), p.y(), p.z()}; }

}  // namespace vasohex::cli
