#pragma once
/// \file Names, ids and shapes of a grid's boundaries: what a solver needs to set its conditions.

#include <string>
#include <vector>

#include "vasohex/mesh/hex_mesh.h"

namespace vasohex {

enum class BoundaryRole { wall, inlet, outlet };

/// One named surface of the boundary.
struct BoundaryInfo {
  unsigned int id = 0;  ///< deal.II's boundary id, and the physical id in MSH files: wall 1, then the ends
  std::string name;     ///< `wall`, `inlet`, `outlet_1`, ...
  BoundaryRole role = BoundaryRole::wall;
  double area = 0;
  Vec3 centre = Vec3::Zero();  ///< of gravity
  Vec3 normal = Vec3::Zero();  ///< mean, outward; unit for an end, zero for the wall
  double radius = 0;           ///< of the disc of the same area; 0 for the wall
};

struct MeshInfo {
  std::vector<BoundaryInfo> boundaries;  ///< boundaries[i].id == i + 1
  unsigned int material_id = 0;          ///< of all cells: the volume's physical id in MSH files
  std::string volume;
  std::string units;

  /// Throws Error(bad_input) that lists the names there are.
  const BoundaryInfo& boundary(const std::string& name) const;
};

/// By exact quadrature over the boundary faces. Roles follow the names: `inlet`, `inlet_2`, ... are inlets, `wall`
/// the wall, all others outlets.
MeshInfo mesh_info(const HexMesh& mesh);

}  // namespace vasohex
