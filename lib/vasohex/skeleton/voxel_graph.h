#pragma once
/// \file Lines of voxels as a graph: ends, junctions, and the chains of voxels between them.

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "vasohex/surface/label_volume.h"

namespace vasohex {

/// A chain of voxels from one node to another (or the same); each begins and ends with a voxel of its nodes.
struct VoxelChain {
  std::array<int, 2> nodes{};
  std::vector<std::size_t> voxels;  ///< [>= 2]
};

struct VoxelGraph {
  std::vector<std::size_t> nodes;  ///< the voxel each lies in
  std::vector<VoxelChain> chains;
};

/// The graph of lines of voxels (see thin), ascending. Voxels with one neighbour are ends; those with more than two,
/// taken together where they touch, are junctions, placed at the voxel nearest to their middle; a ring has one node.
/// Cycles that lie within one junction, around about one voxel, are lost.
VoxelGraph voxel_graph(const LabelVolume& volume, const std::vector<std::size_t>& voxels);

/// Leaves out chains with a free end that stick out of the lumen around their other end by less than `least_radii` of
/// their own radius or two voxels, the shortest first, and joins chains that go on in each other; also pieces that are
/// not longer than wide. One line to `repairs` for each that sticks out by more than its radius. `distances`: signed_centre_distances of the volume.
void prune(const LabelVolume& volume, const std::vector<float>& distances, double least_radii, VoxelGraph& graph,
           std::vector<std::string>& repairs);

}  // namespace vasohex
