#pragma once
/// \file Vessels that end without an opening: which of them are vessels, and which bumps of a wall.

#include <string>
#include <vector>

#include "vasohex/skeleton/chain_graph.h"

namespace vasohex {

/// Leaves out dead ends that hardly leave their vessel, the one that reaches most stays first; prolongs the others to
/// a third of a radius before the wall. Which stay: see split_into_vessels. Adds to `notes` what was done.
void treat_dead_ends(ChainGraph& graph, const ClosedLumen& lumen, std::vector<std::string>& notes);

}  // namespace vasohex
