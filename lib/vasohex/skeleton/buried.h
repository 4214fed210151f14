#pragma once
/// \file Branches and nodes that lie inside a vessel.

#include <vector>

#include "vasohex/skeleton/diagnose.h"
#include "vasohex/skeleton/network.h"

namespace vasohex {

/// Adds the findings of kind `stub`: side branches with a free end whose axis lies in the tube of another branch of
/// their junction from there to the end, however long they are. Of branches that lie in each other all but the widest.
void add_stubs(const Network& network, std::vector<Finding>& findings);

}  // namespace vasohex
