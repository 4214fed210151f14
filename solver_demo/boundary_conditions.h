#pragma once
/// \file From a mesh and the flows asked for to a valid flow problem.

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "dealii/mesh_info.h"
#include "spaces.h"
#include "vasohex/mesh/hex_mesh.h"

namespace vasohex::stokes {

struct BoundaryConditions {
  std::optional<double> flow_rate;            ///< into the only inlet, length unit^3 / s
  std::map<std::string, double> flows;        ///< by end, into the domain
  std::map<std::string, double> resistances;  ///< by outlet, Pa s / length unit^3
  double viscosity = 0;                       ///< Pa s
};

/// The ends of the mesh with their conditions. Without any flow the only inlet gets that of 1 Pa of wall shear
/// stress. Throws Error(bad_input), which says what to do, if a name is not that of an end, if an inlet has no flow,
/// if a connected part of the mesh has no end with a flow or none without, and if an element is not certified.
std::vector<End> flow_ends(const HexMesh& mesh, const MeshInfo& info, const BoundaryConditions& conditions);

}  // namespace vasohex::stokes
