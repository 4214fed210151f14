#pragma once
/// \file Cycles of a network that do not exist in the lumen.

#include <string>
#include <vector>

#include "vasohex/skeleton/network.h"

namespace vasohex {

/// A cycle whose tubes fill the hole they go around, up to a hole narrower than a fifth of the radius: the smooth
/// surface of a skeleton closes that. [measured on pairs of tubes that part and meet again after 6, 9 and 14 radii]
struct FilledLoop {
  std::vector<int> branches;  ///< in order around the loop
  int leave_out = 0;          ///< of these, the branch without which the lumen changes least
  std::string text;           ///< one line for Network::repairs: where, what, how large
};

/// Filled loops without common nodes: those to open first. Empty if and only if none is found in the network.
/// Looked at is the shortest cycle through each branch. It is filled if a surface was found that it bounds and that
/// lies within its own tubes, so a cycle around a hole is never taken for filled.
/// Commutes with scaling and rigid motion.
std::vector<FilledLoop> filled_loops(const Network& network);

}  // namespace vasohex
