#pragma once
/// \file Holes of a segmentation that are narrower than it can tell.

#include <string>
#include <vector>

#include "vasohex/core/run.h"
#include "vasohex/surface/label_volume.h"

namespace vasohex {

/// The lumen, cropped, without the holes through it that no ball of diameter `width` (a length, > 0) passes, each
/// filled with as few voxels as close it; gaps between vessels that lead around nothing stay. Vessels that touch in
/// voxels go around such holes, and no mesh of their size fits through. One line to `repairs` for each.
/// What a ball cannot reach is thinned back to the lumen without a change of topology: sheets across holes remain,
/// and bridges, which the Euler number tells apart.
LabelVolume without_narrow_holes(const LabelVolume& given, double width, std::vector<std::string>& repairs,
                                 const Run& run = {});

}  // namespace vasohex
