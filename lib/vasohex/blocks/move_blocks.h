#pragma once
/// \file Blocks into and out of the network's own frame.

#include "vasohex/blocks/block_structure.h"
#include "vasohex/skeleton/own_frame.h"

namespace vasohex {

/// Of blocks that lie in the frame: all places and lengths as seen from outside.
void move_outward(BlockStructure& blocks, const OwnFrame& frame);

/// The way back.
void move_inward(BlockStructure& blocks, const OwnFrame& frame);

}  // namespace vasohex
