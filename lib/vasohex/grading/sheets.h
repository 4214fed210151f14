#pragma once
/// \file Sheets: all block edges that must share a division. A sheet carries one count and one law, so counts that do
/// not fit cannot be written down.

#include <optional>
#include <string>
#include <vector>

#include "vasohex/blocks/block_structure.h"
#include "vasohex/blocks/topology.h"
#include "vasohex/grading/division.h"

namespace vasohex {

struct Sheet {
  std::string name;  ///< `radial.1`, `axial.12`, `core.3`: by kind, numbered from 1 in the order of their first edge
  DirectionKind kind = DirectionKind::axial;
  int count = 0;                     ///< elements per edge
  Law law = UniformLaw{};            ///< along the sheet's direction; of radial sheets from the core to the wall
  std::optional<WallLayers> layers;  ///< of radial sheets, instead of the law
  bool twisted = false;              ///< runs back into itself reversed: its law must be symmetric
};

/// The blocks' edges by sheets.
struct Sheets {
  std::vector<Sheet> sheets;
  std::vector<int> of_edge;         ///< [edges of the topology]
  std::vector<char> edge_reversed;  ///< [edges] the sheet's direction runs from the greater vertex to the lesser

  /// Sheet of a block's direction, and whether the block's direction runs against the sheet's.
  std::pair<int, bool> of_block(const BlockTopology& topology, int block, int direction) const;
};

/// What the user asks for. Later requests do not override earlier ones: two counts for one sheet are an error.
struct Grading {
  struct Request {
    std::string sheet;  ///< name of one sheet
    std::optional<int> count;
    std::optional<Law> law;
  };
  int elements = 6;                        ///< per block edge
  std::optional<int> radial, axial, core;  ///< the same for all sheets of a kind
  std::optional<WallLayers> layers;  ///< at the wall; the count of the radial sheets is chosen to fit unless given
  std::vector<Request> requests;
};

/// Finds the sheets and gives each its division. Throws Error(bad_input) naming the sheet: no such sheet, a count <
/// 1, two different counts, fewer radial elements than layers + 1, an unsymmetric law on a twisted sheet.
Sheets grade(const BlockStructure& blocks, const BlockTopology& topology, const Grading& grading);

}  // namespace vasohex
