#pragma once
/// \file Branches and nodes that lie inside a vessel.

#include <vector>

#include "vasohex/skeleton/contacts.h"
#include "vasohex/skeleton/diagnose.h"
#include "vasohex/skeleton/network.h"

namespace vasohex {

/// Adds the findings of kind `stub`: side branches with a free end whose axis lies in the tube of another branch of
/// their junction from there to the end, however long they are. Of branches that lie in each other all but the widest.
void add_stubs(const Network& network, std::vector<Finding>& findings);

/// Adds the findings of kind `unjoined`: nodes in the tube of a vessel that does not meet them, less than 3/4 of its
/// radius from its axis and outside the junctions at its ends, so not by how those are made. Not of what a contact or,
/// in `findings`, a stub tells already.
void add_unjoined(const Network& network, const std::vector<Contact>& contacts, std::vector<Finding>& findings);

}  // namespace vasohex
