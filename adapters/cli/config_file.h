#pragma once
/// \file Options from a file.

#include <CLI/CLI.hpp>
#include <string>

namespace vasohex::cli {

/// Gives the command's options the values in the file: lines `name = value` with the long names of the options, `#`
/// starts a comment, several values as `["a", "b"]`, flags as `quiet = true`. What the command line gives wins.
/// Error bad_input naming the file if it cannot be read, names an unknown option or gives a value that is no good.
void read_config(CLI::App& command, const std::string& path);

}  // namespace vasohex::cli
