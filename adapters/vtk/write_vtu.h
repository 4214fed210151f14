#pragma once
/// \file Writer of VTK XML unstructured grids (no VTK needed).

#include <span>
#include <string>
#include <vector>

#include "vasohex/core/run.h"
#include "vasohex/mesh/hex_mesh.h"

namespace vasohex {

/// One number per element.
struct CellScalars {
  std::string name;
  std::span<const double> values;  ///< [elements]
};

/// Writes the hexahedra as VTU version 2.2 (the edge order of VTK >= 9.1), binary: VTK_HEXAHEDRON for order 1,
/// VTK_LAGRANGE_HEXAHEDRON above. Points are mesh.nodes, in their order. Cell data: `block` and `branch`, if the mesh
/// has them, and `scalars`.
///
/// The file is complete or not there. Error bad_input if it cannot be written, for orders above 10, VTK's limit, and
/// from order 3 on for nodes that are not equispaced, which VTU cannot tell, and for scalars of another number.
void write_vtu(const HexMesh& mesh, const std::string& path, std::span<const CellScalars> scalars = {},
               const Run& run = {});

/// Writes the boundary faces alone, oriented outward: VTK_QUAD or VTK_LAGRANGE_QUADRILATERAL. Cell data: `surface`,
/// the physical id (index in mesh.surfaces + 1). Point data: `node`, the index in mesh.nodes. Errors as above.
void write_vtu_boundary(const HexMesh& mesh, const std::string& path, const Run& run = {});

/// Place v of a VTK Lagrange hexahedron holds the lexicographic node result[v] = i + (p+1) * (j + (p+1) * k); for
/// order 1 also of VTK_HEXAHEDRON.
std::vector<int> vtk_hex_order(int order);

/// The same of a quadrilateral, i + (p+1) * j.
std::vector<int> vtk_quad_order(int order);

}  // namespace vasohex
