#pragma once
/// \file Reader of Gmsh MSH files through the Gmsh SDK. Programs that link it fall under the GPL.

#include <string>

#include "vasohex/core/run.h"
#include "vasohex/mesh/hex_mesh.h"

namespace vasohex {

/// Reads an MSH 2 or 4 file of complete hexahedra of one order, 1 to 9.
///
/// Every face of only one hexahedron becomes a boundary face, on the physical surface of the quadrangle with the same
/// corners. `surfaces` are the physical surfaces in the order of their tags (`surface_TAG` if unnamed), and last
/// `untagged`, if there are boundary faces without one. `volume` is the name of the first physical volume;
/// element_block and element_branch stay empty, since MSH does not tell them. Nodes of no hexahedron are left out, so
/// are quadrangles that lie on no boundary face or on one that has a surface already; these are counted in the log.
///
/// Error bad_input: no such file, not an MSH file, no hexahedra, other volume elements, hexahedra of several orders
/// or without nodes inside (serendipity), a node that is missing or not finite. Gmsh itself may crash on a file that
/// is cut off or names missing nodes. Not thread-safe: Gmsh is one global state, which must not be in use.
HexMesh read_msh(const std::string& path, const Run& run = {});

}  // namespace vasohex
