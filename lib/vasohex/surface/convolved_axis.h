#pragma once
/// \file Internal to surface/: the branches of a network as the cones that are convolved.

#include <vector>

#include "vasohex/skeleton/network.h"
#include "vasohex/surface/blending.h"
#include "vasohex/surface/cone_kernel.h"

namespace vasohex {

/// A branch, resampled at about half a radius, and what calibration made of it.
struct ConvolvedAxis {
  std::vector<double> arc;
  std::vector<AxisPoint> target;  ///< the vessel asked for
  std::vector<int> piece;         ///< [samples - 1], of the segment that follows
  std::vector<double> freedom;    ///< 1: may be corrected, 0: near a junction
  std::vector<Vec3> normal;       ///< unit, across the axis: the direction of the first ray
  std::vector<Vec3> shift;        ///< of the centre that is convolved from the target
  std::vector<double> factor;     ///< of the radius that is convolved to the target
};

/// The axis of a branch, nothing corrected yet.
ConvolvedAxis make_axis(const Network& network, int branch, const Blending& blending);

/// The cones along the axes of all branches. Free ends are prolonged by the reach of the kernel and fade there.
std::vector<ConeSegment> make_segments(const Network& network, const std::vector<ConvolvedAxis>& axes);

}  // namespace vasohex
