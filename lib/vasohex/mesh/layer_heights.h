#pragma once
/// \file What became of the layers along the wall.

#include "vasohex/grading/division.h"
#include "vasohex/mesh/hex_mesh.h"
#include "vasohex/surface/implicit_surface.h"

namespace vasohex {

/// The part of the wall nodes, in [0, 1], whose first layer is as high as asked for to 10 %: the distance to the
/// surface of the node one element below. Nodes count once per element face. 1 if there is no wall.
double first_layer_kept(const HexMesh& mesh, const ImplicitSurface& surface, const WallLayers& layers);

}  // namespace vasohex
