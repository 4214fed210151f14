#pragma once
/// \file What the three directions of a block mean in a vessel.

#include <array>

namespace vasohex {

enum class DirectionKind : char {
  radial,  ///< from the core to the wall
  axial,   ///< along the vessel
  core,    ///< across the core of the O-grid, and around it
};
using DirectionKinds = std::array<DirectionKind, 3>;

/// Of the five blocks between two cross-sections: quad 0 and quads 1 to 4.
inline constexpr DirectionKinds kCoreBlock{DirectionKind::core, DirectionKind::core, DirectionKind::axial};
inline constexpr DirectionKinds kOuterBlock{DirectionKind::radial, DirectionKind::core, DirectionKind::axial};

}  // namespace vasohex
