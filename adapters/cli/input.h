#pragma once
/// \file What a command is given: a skeleton, a lumen as triangles or as a segmentation, or one and the other.

#include <CLI/CLI.hpp>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "vasohex/vasohex.h"

namespace vasohex::cli {

/// The options that name the input.
struct Input {
  std::string path;      ///< skeleton, surface or labelmap, by its extension
  std::string skeleton;  ///< for a lumen: this one instead of its own
  std::string surface;   ///< for a skeleton: the lumen, a surface or labelmap
  std::string units;
  std::vector<int> labels;
  std::optional<int> inlet;
  bool facets = false;

  void add_to(CLI::App& command);
  static void add_repair(CLI::App& command, SkeletonMeshOptions& options);
  /// Whether there is a lumen, given as surface or labelmap. Throws Error (bad_input) for an unknown extension.
  bool has_lumen() const;
  /// Whether that lumen is a surface of triangles. Throws as has_lumen does.
  bool has_triangles() const;
  /// All files that are read.
  std::vector<std::string> files() const;
};

/// What was read and found. A lumen without a given skeleton brings its own.
struct Loaded {
  Skeleton skeleton;
  std::optional<Lumen> lumen;
  std::vector<std::string> repairs;  ///< of surface, labelmap and skeleton extraction, one line each
  /// The lumen in figures; filled in as its surface is made.
  std::shared_ptr<nlohmann::ordered_json> figures = std::make_shared<nlohmann::ordered_json>();
};

/// Reads the input; throws Error (bad_input) also for options that do not go together.
Loaded load(const Input& input, const Run& run);

/// mesh_skeleton or mesh_lumen, the repairs of the input first.
SkeletonMesh mesh(const Input& input, const Loaded& loaded, SkeletonMeshOptions options, const Run& run);

}  // namespace vasohex::cli
