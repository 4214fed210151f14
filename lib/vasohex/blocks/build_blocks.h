#pragma once
/// \file From a network and its surface to blocks.

#include "vasohex/blocks/block_structure.h"
#include "vasohex/blocks/optimise.h"
#include "vasohex/core/run.h"
#include "vasohex/skeleton/network.h"
#include "vasohex/surface/implicit_surface.h"

namespace vasohex {

struct BlockOptions {
  double block_length = 2.0;   ///< of a branch's blocks, in local radii
  int candidates = 6;          ///< arrangements tried of a weak junction's cubes; below .5, three times as many
  double good_jacobian = 0.6;  ///< scaled Jacobian that ends the search, if certified
  MeshDivision mesh;           ///< what the blocks are for; of mesh_skeleton: order 0 is the order asked for
};

/// Cross-sections along the branches, cubes or trees of cubes at the junctions, optimised. Blocks may come out
/// invalid: see `certified`.
BlockStructure build_blocks(const Network& network, const ImplicitSurface& surface, const BlockOptions& options,
                            const Run& run);

}  // namespace vasohex
