#pragma once
/// \file Figures as JSON and as text.

#include <nlohmann/json.hpp>
#include <string>

#include "vasohex/quality/quality_report.h"
#include "vasohex/skeleton/network.h"
#include "vasohex/vasohex.h"

namespace vasohex::cli {

/// The figures of a quality report under their names in docs/cli.md: `quality`, `validity`, `worst`. `network` is the
/// one that the mesh was made of, if that is known: junctions are told by their points.
void add_quality(nlohmann::ordered_json& json, const QualityReport& report, const Network* network = nullptr);

/// The same as a few lines for the terminal.
std::string quality_text(const QualityReport& report);

/// Distances of a lumen's wall to the mesh's, and the places that the mesh does not reach.
nlohmann::ordered_json reach_json(const WallReach& reach);

/// The same as a few lines for the terminal; empty if nothing was measured.
std::string reach_text(const WallReach& reach);

/// Components and independent loops of a network.
struct NetworkCounts {
  int components = 0;
  int loops = 0;
  int ends = 0;
  int junctions = 0;
};
NetworkCounts count(const Network& network);

/// Writes the JSON, whole or not at all.
void write_json(const nlohmann::ordered_json& json, const std::string& path);

}  // namespace vasohex::cli
