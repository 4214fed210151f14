#pragma once
/// \file Findings about a skeleton's geometry, as JSON and as text.

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "vasohex/skeleton/diagnose.h"

namespace vasohex::cli {

/// An array, under the names in docs/cli.md.
nlohmann::ordered_json findings_json(const std::vector<Finding>& findings);

/// Lines for the terminal: how many of each kind, the worst ten of it, what helps.
std::string findings_text(const std::vector<Finding>& findings);

/// One line for each kind with errors or warnings, and where to read on; empty if there are none.
std::string findings_summary(const std::vector<Finding>& findings, bool repaired);

}  // namespace vasohex::cli
