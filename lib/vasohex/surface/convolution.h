#pragma once
/// \file The lumen of a network as a convolution surface: smooth tubes of the given radii, blended at junctions.

#include <memory>

#include "vasohex/core/run.h"
#include "vasohex/skeleton/network.h"
#include "vasohex/surface/implicit_surface.h"

namespace vasohex {

struct ConvolutionOptions {
  /// Rounds of shooting rays from the axis and correcting it and the radii by what they meet. 0: the plain
  /// convolution, whose radius is some per cent off where vessels bend or taper.
  int calibration_passes = 3;
};

/// The surface that a network describes. value = |x - axis| / radius - 1 on a straight tube, and close to it
/// elsewhere, dimensionless. C2 up to half a radius off each vessel (value < .5); beyond, the least |x - axis| /
/// radius - 1 of all vessels: continuous, a bound for culling. Where vessels that do not blend touch, the union, with
/// its crease.
///
/// Away from junctions the distance from the axis to the surface is the branch's radius: within 1 % for bends of 1.5
/// radii or more and slopes up to .3. Branches blend around the nodes that they share and nowhere else (blending.h).
/// Free ends are prolonged by 1.5 radii, straight: the cap plane there is the caller's. Invariant under rigid motion
/// and scaling, independent of how densely the branches are sampled.
///
/// Throws Error(bad_input) when there is no branch, or one has less than two points, arrays of different sizes, a
/// radius that is not positive, or no length.
std::unique_ptr<ImplicitSurface> make_convolution_surface(const Network& network,
                                                          const ConvolutionOptions& options = {},
                                                          const Run& run = {});

}  // namespace vasohex
