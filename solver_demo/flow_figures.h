#pragma once
/// \file What a flow amounts to: flows and pressures at the ends, shear stress on the wall.

#include <vector>

#include "stokes.h"

namespace vasohex::stokes {

struct EndFigures {
  double area = 0;      ///< length unit^2
  double flow = 0;      ///< out of the domain, length unit^3 / s
  double pressure = 0;  ///< mean, Pa
};

/// Of problem.ends, in their order; the same on all ranks.
std::vector<EndFigures> end_figures(const FlowProblem& problem, const Flow& flow);

/// One face of the wall on this rank: (k + 1)^2 equispaced points, lexicographic, where k is the velocity's degree.
struct WallFace {
  std::vector<dealii::Point<3>> points;
  std::vector<dealii::Tensor<1, 3>> shear;  ///< Pa, the force of the fluid per area within the wall's plane
};

std::vector<WallFace> wall_shear(const FlowProblem& problem, const Flow& flow);

struct ShearFigures {
  double area = 0, mean = 0, rms = 0, max = 0;  ///< of the magnitude, Pa; max in Gauss points
};

ShearFigures shear_figures(const FlowProblem& problem, const Flow& flow);

}  // namespace vasohex::stokes
