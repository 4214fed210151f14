#pragma once
/// \file From a node of the blocks' wall onto the surface.

#include "vasohex/surface/implicit_surface.h"

namespace vasohex {

/// Wall nodes are moved from the blocks' wall onto the surface by so many local radii at most: further off is another
/// sheet, or a dent that the blocks do not follow, and to go there would fold their elements.
inline constexpr double kFurthestShift = 0.25;

/// The same along the line that the node ends: spikes stand out further, and a line leads into them.
inline constexpr double kFurthestAlongLine = 0.5;

struct WallNode {
  Vec3 point = Vec3::Zero();
  Vec3 normal = Vec3::UnitZ();  ///< unit, outward; of an end's rim: within the plane of the end
  double residual = 0;          ///< bound of the distance left, over the local radius
  bool converged = false;
};

/// The point of the surface that a node at `start` is moved to: of round vessels, which the blocks follow closely, the
/// closest one; of others where the block's line from the core, continued, meets the surface, since closest points of
/// the nodes around a spike or a bulge all lie at its foot; if it meets none near by, the closest one again.
/// \param outward unit, direction of the line at the wall
/// \param plane normal of the plane that the node stays in; null: none
/// \param radius about the local one
WallNode onto_wall(const ImplicitSurface& surface, const Vec3& start, const Vec3& outward, const Vec3* plane,
                   double radius);

}  // namespace vasohex
