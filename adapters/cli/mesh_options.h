#pragma once
/// \file Options that `mesh` and `blocks` share: how a skeleton becomes blocks.

#include <CLI/CLI.hpp>
#include <optional>
#include <string>

#include "option_checks.h"
#include "vasohex/skeleton/read_skeleton.h"
#include "vasohex/vasohex.h"

namespace vasohex::cli {

struct SkeletonInput {
  std::string path;
  std::string units;
  std::optional<int> inlet;

  void add_to(CLI::App& command) {
    command.add_option("INPUT", path, "Skeleton: .swc or .json (vascular-graph-1)")->required();
    command.add_option("--units", units, "Unit of the input: um, mm, cm or m. Overrides what the file says")
        ->check(CLI::IsMember({"um", "mm", "cm", "m"}));
    command
        .add_option("--inlet", inlet, "Point of the skeleton (index from 0, in file order) whose end is the inlet")
        ->check(whole_number(0));
  }
  static void add_repair(CLI::App& command, SkeletonMeshOptions& options) {
    command.add_flag(
        "--repair", options.repair,
        "Part vessels that overlap or touch, leave out stray pieces and branches that end inside others");
  }
  Skeleton read(NetworkOptions& options) const {
    Skeleton skeleton = read_skeleton(path);
    if (!units.empty()) {
      skeleton.units = units;
    }
    options.inlet = inlet;
    return skeleton;
  }
};

}  // namespace vasohex::cli
