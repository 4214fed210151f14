#pragma once
/// \file From a segmentation to a skeleton, and to the smooth lumen that it lies in.

#include <memory>
#include <string>
#include <vector>

#include "vasohex/core/run.h"
#include "vasohex/skeleton/skeleton.h"
#include "vasohex/surface/label_volume.h"
#include "vasohex/surface/level_set.h"
#include "vasohex/surface/tri_surface.h"

namespace vasohex {

struct LabelSkeletonOptions {
  /// Components of fewer voxels are left out.
  std::size_t least_voxels = 50;
  /// Holes narrower than so many voxels (mean spacing) are filled (without_narrow_holes).
  double least_hole = 2;
  /// By how much a branch must stick out of the lumen around its junction, in its own radii.
  double least_branch = 2;
};

struct LabelSkeleton {
  Skeleton skeleton;
  /// Where vessels are cut, one for each end of the skeleton: the plane normal to the axis, so far inside the
  /// vessel's blunt end that its section is whole.
  std::vector<SurfaceEnd> ends;
  std::vector<int> end_points;  ///< [end] the point of the skeleton
  /// The smooth wall (make_level_set), of what is not left out.
  std::shared_ptr<const LevelSet> level_set;
  int components = 0;  ///< of the lumen, 26-connected, without what was left out
  int tunnels = 0;     ///< holes through it; cycles of the skeleton, but for those of about one voxel
  std::vector<std::string>
      repairs;  ///< what was changed in the segmentation or left out of the skeleton, one line each
};

/// The middle lines of the vessels in a segmentation, by thinning without a change of topology towards the tips of
/// vessels, so that holes of the lumen are cycles and nothing else is. Points are about a voxel to half a radius
/// apart, in the middle of the smooth wall's cross-sections; radii are those of discs of the same area. In a junction
/// branches have their own radii up to the node, which has that of the ball inscribed there.
/// Throws Error (bad_input) as check(LabelVolume) and if no vessel is found.
LabelSkeleton extract_skeleton(const LabelVolume& volume, const LabelSkeletonOptions& options = {},
                               const Run& run = {});

}  // namespace vasohex
