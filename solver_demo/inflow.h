#pragma once
/// \file Laminar profiles on the ends whose flow is known.

#include "spaces.h"

namespace vasohex::stokes {

/// Sets the velocity on all ends of known flow: that of fully developed flow in a pipe of their section, -laplace w =
/// 1 in the plane and w = 0 on the rim (a parabola on a disc), scaled to the flow. Other values are left as they are.
void set_inflow(const FlowProblem& problem, const Space& space, Blocks<double>& velocity);

}  // namespace vasohex::stokes
