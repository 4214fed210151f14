#pragma once
/// \file From graded blocks and the surface to the mesh of order p.

#include "vasohex/blocks/block_structure.h"
#include "vasohex/core/run.h"
#include "vasohex/grading/sheets.h"
#include "vasohex/mesh/hex_mesh.h"
#include "vasohex/mesh/relax_wall.h"
#include "vasohex/surface/implicit_surface.h"

namespace vasohex {

struct MeshOptions {
  int order = 1;
  NodeFamily family = NodeFamily::equispaced;
};

struct MeshResult {
  HexMesh mesh;
  /// Largest distance of a wall node to the surface, over the local radius: a bound, the length of the last step.
  double wall_residual_max = 0;
  int unconverged = 0;   ///< wall nodes whose projection did not converge (they stay where the block has them)
  Vec3 unconverged_place = Vec3::Zero();  ///< the first of them
  RelaxedWall relaxed;   ///< wall nodes that left the surface again so that elements do not fold
  int shrunk_lines = 0;  ///< lines towards the wall too short for the layers asked for
};

/// Evaluates the blocks at the nodes of the graded lattice; wall nodes are projected onto the surface (those on an
/// end: within its plane) and the shift fades linearly along the line to the core; where elements would fold, they
/// stay off it (relax_wall.h). The same bytes for any number of threads. Throws Error(bad_input) for an order < 1.
MeshResult generate_mesh(const BlockStructure& blocks, const BlockTopology& topology, const Sheets& sheets,
                         const ImplicitSurface& surface, const MeshOptions& options, const Run& run);

}  // namespace vasohex
