#pragma once
/// \file Writers of skeleton files.

#include <string>

#include "vasohex/skeleton/skeleton.h"

namespace vasohex {

/// Writes a skeleton by the extension of its file, `.swc` or `.json`, in the forms that read_skeleton reads; numbers
/// are exact. SWC numbers points from 1, parents before children, each component from its root: Skeleton::root, an
/// end named `inlet`, otherwise its widest end. It has no names. The file is complete or not there. Throws Error
/// (bad_input) for another extension, for a skeleton with a cycle as SWC, which holds trees, and if the file cannot
/// be written.
void write_skeleton(const std::string& path, const Skeleton& skeleton);

}  // namespace vasohex
