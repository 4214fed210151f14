#pragma once
/// \file Flows as files for ParaView.

#include <string>

#include "stokes.h"

namespace vasohex::stokes {

/// Writes FOLDER/flow.vtu (velocity, pressure) and FOLDER/wall.vtu (wall_shear_stress and its magnitude): Lagrange
/// cells of the velocity's degree. On several ranks each writes its pieces, flow_0000.vtu .., and the first one
/// flow.pvtu and wall.pvtu, which is what to open. Files are complete or not there. Error bad_input if one cannot be
/// written. Returns the names of the files to open.
std::vector<std::string> write_flow(const FlowProblem& problem, const Flow& flow, const std::string& folder);

}  // namespace vasohex::stokes
