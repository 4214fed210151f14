#pragma once
/// \file The finished mesh: hexahedra of order p, boundary faces with tags, names.

#include <string>
#include <vector>

#include "vasohex/core/node_family.h"
#include "vasohex/core/vec3.h"

namespace vasohex {

/// Right-handed hexahedra of one order p >= 1 on the reference cube [0,1]^3. n = (p+1)^3 nodes each, lexicographic:
/// node (i, j, k) is elements[e * n + i + (p+1) * (j + (p+1) * k)].
struct HexMesh {
  /// One face of one element on the boundary. Faces are numbered as in reference_hex.h: 2 * direction + side.
  struct BoundaryFace {
    int element = 0;
    int face = 0;
    int surface = 0;  ///< index into `surfaces`
  };
  int order = 1;
  NodeFamily family = NodeFamily::equispaced;
  std::vector<Vec3> nodes;
  std::vector<int> elements;       ///< [elements * (p+1)^3]
  std::vector<int> element_block;  ///< [elements], index of the block; empty: unknown
  std::vector<int>
      element_branch;  ///< [elements], branch of the network, or -1 - node for a junction; empty: unknown
  std::vector<BoundaryFace> boundary;  ///< every face of one element, once
  std::vector<std::string> surfaces;   ///< names; physical id of surfaces[s] is s + 1 (`wall` is 0)
  std::string volume = "lumen";        ///< physical id is surfaces.size() + 1
  std::string units;

  int nodes_per_element() const { return (order + 1) * (order + 1) * (order + 1); }
  int element_count() const { return static_cast<int>(elements.size()) / nodes_per_element(); }
};

}  // namespace vasohex
