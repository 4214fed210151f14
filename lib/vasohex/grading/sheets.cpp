#include "vasohex/grading/sheets.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include "vasohex/core/error.h"
#include "vasohex/core/reference_hex.h"

namespace vasohex {
namespace {

/// Edges joined when they must share a division, with the direction of each relative to its leader.
class DirectedUnion {
 public:
  explicit DirectedUnion(std::size_t n) : leader_(n), reversed_(n, 0) {
    std::iota(leader_.begin(), leader_.end(), 0);
  }

  std::pair<int, bool> find(int e) {
    bool reversed = false;
    while (leader_[e] != e) {
      reversed ^= reversed_[e] != 0;
      e = leader_[e];
    }
    return {e, reversed};
  }
  /// Whether a and b run the same way or not; false if that contradicts what is known.
  bool join(int a, int b, bool opposite) {
    const auto [la, ra] = find(a);
    const auto [lb, rb] = find(b);
    if (la == lb) {
      return (ra ^ rb) == opposite;
    }
    const int low = std::min(la, lb), high = std::max(la, lb);
    leader_[high] = low;
    reversed_[high] = ra ^ rb ^ opposite;
    return true;
  }

 private:
  std::vector<int> leader_;
  std::vector<char> reversed_;
};

const char* kind_name(DirectionKind kind) {
  return kind == DirectionKind::radial ? "radial" : kind == DirectionKind::axial ? "axial" : "core";
}

void set_count(Sheet& sheet, int count, const std::string& whose) {
  if (count < 1) {
    throw Error(ErrorCode::bad_input,
                "sheet " + sheet.name + ": " + std::to_string(count) + " elements " + whose + ", must be at least 1");
  }
  if (sheet.count != 0 && sheet.count != count) {
    throw Error(ErrorCode::bad_input, "sheet " + sheet.name + ": " + std::to_string(sheet.count) + " and " +
                                          std::to_string(count) +
                                          " elements are both asked for; a sheet has one count, give one of them");
  }
  sheet.count = count;
}

/// Elements that fill what the layers leave of a line of the O-grid (about 0.45 radii), without a jump in size.
int count_for(const WallLayers& layers) {
  constexpr double kLine = 0.45;
  if (!layers.relative) {
    return layers.layers + 3;
  }
  double height = layers.first_height, sum = 0;
  for (int i = 0; i < layers.layers; ++i) {
    sum += height;
    height *= layers.growth;
  }
  const double rest = std::max(0.0, kLine - sum);
  int parts = 0;
  for (double filled = 0; filled + 0.5 * height < rest && parts < 20; ++parts) {
    filled += height;
    height = std::min(height * layers.growth, 0.12);  // no coarser than the core's elements
  }
  return layers.layers + std::max(2, parts);
}

}  // namespace

std::pair<int, bool> Sheets::of_block(const BlockTopology& topology, int block, int direction) const {
  const BlockTopology::EdgeUse& use = topology.block_edges[block][4 * direction];
  return {of_edge[use.edge], use.reversed != (edge_reversed[use.edge] != 0)};
}

Sheets grade(const BlockStructure& blocks, const BlockTopology& topology, const Grading& grading) {
  const std::size_t edges = topology.edges.size();
  DirectedUnion joined(edges);
  std::vector<char> twisted(edges, 0);
  for (std::size_t b = 0; b < topology.blocks.size(); ++b) {
    for (int d = 0; d < 3; ++d) {
      const auto& first = topology.block_edges[b][4 * d];
      for (int e = 1; e < 4; ++e) {
        const auto& other = topology.block_edges[b][4 * d + e];
        if (!joined.join(first.edge, other.edge, first.reversed != other.reversed)) {
          twisted[first.edge] = 1;
        }
      }
    }
  }
  Sheets out;
  out.of_edge.assign(edges, -1);
  out.edge_reversed.assign(edges, 0);
  std::map<int, int> sheet_of_leader;
  std::map<DirectionKind, int> numbers;
  // the direction of a sheet is that of the first block in it
  std::vector<char> flip;
  for (std::size_t b = 0; b < topology.blocks.size(); ++b) {
    for (int d = 0; d < 3; ++d) {
      const auto& use = topology.block_edges[b][4 * d];
      const auto [leader, reversed] = joined.find(use.edge);
      const auto [it, is_new] = sheet_of_leader.try_emplace(leader, static_cast<int>(out.sheets.size()));
      if (is_new) {
        Sheet sheet;
        sheet.kind = blocks.kinds[b][d];
        sheet.name = std::string(kind_name(sheet.kind)) + "." + std::to_string(++numbers[sheet.kind]);
        out.sheets.push_back(sheet);
        flip.push_back(reversed != use.reversed);
      }
    }
  }
  for (std::size_t e = 0; e < edges; ++e) {
    const auto [leader, reversed] = joined.find(static_cast<int>(e));
    out.of_edge[e] = sheet_of_leader.at(leader);
    out.edge_reversed[e] = reversed != (flip[out.of_edge[e]] != 0);
    out.sheets[out.of_edge[e]].twisted |= twisted[e] != 0;
  }

  for (const Grading::Request& r : grading.requests) {
    const auto sheet =
        std::find_if(out.sheets.begin(), out.sheets.end(), [&](const Sheet& s) { return s.name == r.sheet; });
    if (sheet == out.sheets.end()) {
      throw Error(ErrorCode::bad_input, "sheet " + r.sheet + " does not exist; the sheets run from " +
                                            out.sheets.front().name + " to " + out.sheets.back().name);
    }
    if (r.count) {
      set_count(*sheet, *r.count, "asked for");
    }
    if (r.law) {
      sheet->law = *r.law;
    }
  }
  for (Sheet& sheet : out.sheets) {
    const std::optional<int>& of_kind = sheet.kind == DirectionKind::radial  ? grading.radial
                                        : sheet.kind == DirectionKind::axial ? grading.axial
                                                                             : grading.core;
    if (of_kind) {
      set_count(sheet, *of_kind, std::string("asked for all ") + kind_name(sheet.kind) + " sheets");
    }
    if (sheet.kind == DirectionKind::radial && grading.layers) {
      sheet.layers = grading.layers;
      if (sheet.count == 0) {
        set_count(sheet, count_for(*grading.layers), "for the layers");
      }
      if (sheet.count <= grading.layers->layers) {
        throw Error(ErrorCode::bad_input, "sheet " + sheet.name + ": " + std::to_string(sheet.count) +
                                              " elements cannot hold " + std::to_string(grading.layers->layers) +
                                              " layers and the rest; give at least " +
                                              std::to_string(grading.layers->layers + 1));
      }
    }
    if (sheet.count == 0) {
      set_count(sheet, grading.elements, "per edge");
    }
    if (sheet.twisted && !is_symmetric(sheet.law, sheet.count)) {
      throw Error(ErrorCode::bad_input,
                  "sheet " + sheet.name + ": runs back into itself reversed, so its law must be symmetric");
    }
  }
  return out;
}

}  // namespace vasohex
