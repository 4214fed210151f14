#pragma once
/// \file Wall nodes that leave the surface where elements would fold on it.

#include <memory>
#include <vector>

#include "vasohex/blocks/topology.h"
#include "vasohex/core/run.h"
#include "vasohex/mesh/hex_mesh.h"
#include "vasohex/surface/implicit_surface.h"

namespace vasohex {

/// How far a node of the wall was moved from its block's wall onto the surface.
struct WallShift {
  int node = 0;
  Vec3 shift = Vec3::Zero();
  std::shared_ptr<const std::vector<double>> fade;  ///< parts of it that the nodes of its line got, core to wall
};

/// What was done.
struct RelaxedWall {
  int nodes = 0;              ///< of the wall, that left the surface
  double largest = 0;         ///< how far, over the local radius
  Vec3 place = Vec3::Zero();  ///< where that is
};

/// How many elements away, at most, what is done to a wall node depends on.
inline constexpr int kRelaxReach = 14;

/// Elements that get scaled Jacobians below this where the wall is projected have their shifts made bilinear.
inline constexpr double kWeakOnWall = 0.5;
/// Those that stay below this, curved or straight-sided, are led back to their blocks' wall, and on to a smoother one.
inline constexpr double kFoldedOnWall = 0.25;

/// Where the surface has creases, or features smaller than an element, shifts of neighbouring nodes differ so much
/// that polynomials through them swing, and elements fold. There, and only there, the shifts within an element's face
/// are led towards those between the face's corners (bilinear), as far as it takes to make the least scaled Jacobian
/// of the elements behind the face kWeakOnWall, or as good as it gets; corners of elements stay on the surface. Where
/// that leaves it below kFoldedOnWall, since the corners themselves were shifted too differently, all shifts of the
/// face fade to nothing, again as far as it takes: the blocks are valid on their own. Where a spike bends the blocks'
/// wall itself, its nodes are then led to a smoothed one. Before all that, nodes of weak elements (on round vessels: of
/// folded ones) that lie more than a tenth of their edge off its even parts are moved there, where that is a gain. No
/// smoothed wall and no centre folds elements beside; no straight-sided element makes curved ones beside weak that lose
/// more than it gains. Same bytes for any number of threads.
/// \param wall_face [blocks] face that is wall, or -1
/// \param shifts of all wall nodes
RelaxedWall relax_wall(HexMesh& mesh, const LatticeNumbering& numbering, const std::vector<int>& wall_face,
                       std::vector<WallShift> shifts, const ImplicitSurface& surface, const Run& run);

}  // namespace vasohex
