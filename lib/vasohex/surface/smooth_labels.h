#pragma once
/// \file From the voxels of a segmentation to a smooth level set.

#include <array>
#include <cstddef>
#include <vector>

#include "vasohex/core/run.h"
#include "vasohex/surface/label_volume.h"
#include "vasohex/surface/level_set.h"

namespace vasohex {

/// Voxels outside around the lumen that make_level_set needs.
inline constexpr int kLevelSetMargin = 8;

struct SmoothLabelsOptions {
  int iterations = 300;
  double margin = 0.1;     ///< least distance of a voxel's centre from the wall, of the smallest spacing
};

/// From one voxel of a vessel's axis to the next, a neighbour by a face, an edge or a corner.
struct AxisStep {
  std::array<std::size_t, 2> voxels{};
  double radius = 0;  ///< at least so wide is the lumen there
};

/// The smoothest function that has the right sign at the centre of every voxel: the least integral of the squared
/// second derivatives (in space, so that anisotropic voxels do not matter) among all with values between bounds. A
/// voxel whose centre is at distance d from the nearest centre on the other side has a distance to the wall between
/// d - (largest spacing) and d. A staircase costs more than the plane or tube it stands for, which also fits; volume
/// is kept, as voxels of both sides hold the wall, and a vessel of one voxel does not vanish. Higher-order smoothness
/// for binary volumes: V. Lempitsky, "Surface Extraction from Binary Volumes with Higher-Order Smoothness" (2010).
///
/// Along `axis` the lumen is kept connected: vessels may hang together by edges or corners of voxels only.
/// The volume needs kLevelSetMargin voxels outside around its voxels inside (see cropped); `distances`:
/// signed_centre_distances of it. Independent of threads.
LevelSet make_level_set(const LabelVolume& volume, std::vector<float> distances,
                        const std::vector<AxisStep>& axis, const SmoothLabelsOptions& options = {},
                        const Run& run = {});

}  // namespace vasohex
