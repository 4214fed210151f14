#pragma once
/// \file Exact Euclidean distances on a lattice of voxels.

#include <vector>

#include "vasohex/core/run.h"
#include "vasohex/surface/label_volume.h"

namespace vasohex {

/// [voxel] the signed distance between centres of voxels: of a voxel outside to the nearest inside, of one inside,
/// with a minus sign, to the nearest outside. Never 0. The volume must have both. Lower envelopes of parabolas:
/// P. Felzenszwalb, D. Huttenlocher, "Distance Transforms of Sampled Functions" (2012).
std::vector<float> signed_centre_distances(const LabelVolume& volume, const Run& run = {});

}  // namespace vasohex
