#pragma once
/// \file Writer of Gmsh MSH 4.1 files (no Gmsh needed).

#include <string>

#include "vasohex/core/run.h"
#include "vasohex/mesh/hex_mesh.h"

namespace vasohex {

/// Writes a binary MSH 4.1 file: one entity and physical group per named surface (surfaces[s]: dimension 2, tag s +
/// 1) and one for the volume (dimension 3, tag surfaces.size() + 1). Tags of nodes are 1, 2, .. in the order of
/// mesh.nodes; those of elements run over the boundary quadrangles by surface, then the hexahedra. Quadrangles are
/// oriented outward.
///
/// The file is complete or not there. Error bad_input if it cannot be written, for orders above 9, which MSH does not
/// have, and from order 3 on for nodes that are not equispaced, which MSH cannot tell.
void write_msh(const HexMesh& mesh, const std::string& path, const Run& run = {});

}  // namespace vasohex
