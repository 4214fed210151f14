#pragma once
/// \file Branches of a junction that have not parted where one of them comes to the next junction.

#include <utility>
#include <vector>

#include "vasohex/blocks/hubs.h"

namespace vasohex {

/// The clusters that come of carrying arms of hub `h` on to the hubs that it is linked to, each with its changed hub:
/// of two arms side by side one is a link, and their tubes overlap as far as that goes. The link becomes the middle
/// line between them, the other arm starts at its end; a hub that keeps two arms goes. One cluster more for each hub
/// that the arm is carried past. Empty if nothing runs side by side as far as that.
std::vector<std::pair<Cluster, int>> carry_on(const Cluster& cluster, int h);

}  // namespace vasohex
