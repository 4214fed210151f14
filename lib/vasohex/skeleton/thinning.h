#pragma once
/// \file A segmentation thinned to lines of voxels without a change of its topology.

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "vasohex/core/run.h"
#include "vasohex/surface/label_volume.h"

namespace vasohex {

/// Whether the middle one of 27 voxels (bit i + 3 j + 9 k: inside; the middle's own bit does not matter) can become
/// outside, or inside, without a change of topology: the voxels inside around it are one 26-component, those outside
/// that share a face or an edge with it, and have one of them that shares a face, one 6-component. G. Bertrand,
/// G. Malandain, "A new characterization of three-dimensional simple points" (1994).
bool is_simple(std::uint32_t neighbourhood);

/// The tips of vessels: voxels farthest from the thickest place of their component, by ways through the lumen, one for
/// every part that sticks out by more than `least_radii` times the radius of the lumen where it starts. Ascending.
/// `distances`: signed_centre_distances of the volume. At least one tip per component.
std::vector<std::size_t> vessel_tips(const LabelVolume& volume, const std::vector<float>& distances,
                                     double least_radii);

/// The voxels that remain when simple voxels are taken away, those nearest to the wall first, but none of `kept`:
/// lines in the middle of vessels that lead to these. The volume needs one voxel outside on each side. Ascending.
std::vector<std::size_t> thin(const LabelVolume& volume, const std::vector<float>& distances,
                              const std::vector<std::size_t>& kept);

}  // namespace vasohex
