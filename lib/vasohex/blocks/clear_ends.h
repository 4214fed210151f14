#pragma once
/// \file Room for the caps of branches that end too near to their junction.

#include "vasohex/skeleton/network.h"

namespace vasohex {

/// Lengthens branches whose free end lies inside the junction they come from, so that a cap fits; one line per branch
/// in network.repairs. To be called before the surface is made.
void clear_ends(Network& network);

}  // namespace vasohex
