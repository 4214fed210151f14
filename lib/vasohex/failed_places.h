#pragma once
/// \file Where a mesh is not proven valid, and why, as far as can be told.

#include <string>
#include <vector>

#include "vasohex/blocks/block_structure.h"
#include "vasohex/mesh/hex_mesh.h"
#include "vasohex/quality/quality_report.h"
#include "vasohex/skeleton/diagnose.h"
#include "vasohex/skeleton/network.h"

namespace vasohex {

/// A junction or a branch with elements that are not certified.
struct FailedPlace {
  int place = 0;               ///< branch of the network, or -1 - node
  Vec3 at = Vec3::Zero();      ///< centre of the worst of these elements
  int elements = 0;            ///< how many
  double scaled_jacobian = 0;  ///< the least of theirs
  int finding = -1;            ///< index of what most likely is the reason; -1: none of the findings
  std::string text;            ///< one line: what, where, how many, how bad
  std::string reason;          ///< one line: the finding's text, or the shape of the network there
  std::string cure;            ///< what helps
};

/// All of them, that with the worst element first; none exactly if all elements are certified. The reason is that a
/// vessel is cut next to its junction, if the worst element is there; otherwise a finding about a branch of that place,
/// not more than 6 radii from the worst element, the nearest one, or one about any other within 2 radii; otherwise the
/// shape of the place. The mesh has to know what its elements belong to.
std::vector<FailedPlace> failed_places(const Network& network, const std::vector<Finding>& findings,
                                       const HexMesh& mesh, const QualityReport& quality);

}  // namespace vasohex
