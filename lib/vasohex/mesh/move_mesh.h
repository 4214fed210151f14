#pragma once
/// \file Into and out of the network's own frame: what is asked of a mesh, and the mesh.

#include "vasohex/grading/sheets.h"
#include "vasohex/mesh/generate_mesh.h"
#include "vasohex/skeleton/own_frame.h"

namespace vasohex {

/// A height of layers in the network's unit becomes one of the frame's; relative ones stay.
Grading in_frame(Grading grading, const OwnFrame& frame);

/// Of a mesh that lies in the frame: its nodes and the places in its report as seen from outside.
void move_outward(MeshResult& result, const OwnFrame& frame);

}  // namespace vasohex
