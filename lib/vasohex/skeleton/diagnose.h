#pragma once
/// \file What in the geometry of a network stands in the way of a good mesh, where, and what helps.

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "vasohex/skeleton/network.h"

namespace vasohex {

enum class FindingKind {
  overlap,         ///< vessels, or turns of one, that overlap away from any junction; figure: depth / smaller radius
  touch,           ///< the same with a gap below 5 % of the smaller radius; figure: gap / smaller radius
  hairpin,         ///< a vessel that turns back and stays in itself; figure: depth / smaller radius
  side_by_side,    ///< branches that have not parted 24 radii from their junction; figure: depth / smaller radius
  sharp_bend,      ///< bend radius below 1.1 radii; figure: radius * curvature
  steep_taper,     ///< figure: change of the radius per length, above 0.6
  thin_branch,     ///< a branch thinner than 1/30 of its junction; figure: radius of the junction / its own
  stub,            ///< a side branch that lies in another up to its end; figure: its length / radius of the parent
  fragment,        ///< a component that is tiny, or inside another vessel; figure: its length / its diameter
  unjoined,        ///< a node deep in a vessel that no junction joins it to; figure: distance from its axis / radius
  near_junctions,  ///< junctions closer than their radius; figure: distance / radius
};

/// Name as in docs/cli.md, the enumerator.
std::string_view name_of(FindingKind kind);

enum class Severity {
  error,    ///< as it is, no mesh of the geometry exists
  warning,  ///< a mesh exists, and is poor or not what is meant
  note,
};
std::string_view name_of(Severity severity);

struct Finding {
  FindingKind kind = FindingKind::overlap;
  Severity severity = Severity::error;
  std::array<int, 2> branches{-1, -1};  ///< -1: none
  Vec3 at = Vec3::Zero();
  int point = -1;     ///< of the skeleton, where the place is a node; otherwise -1
  double figure = 0;  ///< see FindingKind
  std::string text;   ///< one line: what, where, how much
  std::string cure;   ///< what helps
};

/// All findings: by kind, the worst of each kind first. What build_network repairs by itself is not among them.
/// Commutes with scaling and rigid motion; O(n log n) for n samples.
std::vector<Finding> diagnose(const Network& network);

}  // namespace vasohex
