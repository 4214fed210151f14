#pragma once
/// \file Checks of option values and output names, with messages that say what would be right.

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace vasohex::cli {

/// A whole number, at least `least`.
CLI::Validator whole_number(int least);

/// A finite number > 0.
CLI::Validator positive_number();

/// Error bad_input with this message.
[[noreturn]] void usage(const std::string& message);

/// Probes that the files can be written, before the work and not after it. Error bad_input if one cannot, if two are
/// the same file, or if one is an input.
void check_outputs(const std::vector<std::string>& inputs, const std::vector<std::string>& outputs);

}  // namespace vasohex::cli
