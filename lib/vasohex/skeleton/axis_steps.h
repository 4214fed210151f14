#pragma once
/// \file Along which steps between voxels, and how wide, a segmentation's lumen is kept connected.

#include <cstddef>
#include <string>
#include <vector>

#include "vasohex/surface/label_volume.h"
#include "vasohex/surface/smooth_labels.h"

namespace vasohex {

/// Adds the steps of a chain of voxels, each the next one's neighbour. Where two only touch by an edge or a corner,
/// nothing is known of the width there, and a lumen of a fraction of a voxel between two vessels could not be meshed:
/// it becomes that of the thinner vessel nearby; one line to `repairs` for each. `radii`: [voxels], about those of
/// the inscribed balls.
void add_axis_steps(const LabelVolume& volume, const std::vector<std::size_t>& chain,
                    const std::vector<double>& radii, std::vector<AxisStep>& axis, std::vector<std::string>& repairs);

}  // namespace vasohex
