#pragma once
/// \file Steady Stokes flow: -mu laplace u + grad p = 0, div u = 0, by Taylor-Hood elements Q_k / Q_{k-1}.
///
/// u = 0 on the wall, a laminar profile on ends of known flow, mu du/dn - p n = -(resistance * flow) n on the others
/// (resistance 0: nothing is prescribed; Poiseuille flow passes unchanged).

#include <functional>
#include <memory>

#include "spaces.h"

namespace vasohex::stokes {

struct StokesOptions {
  int degree = 2;           ///< k >= 2 of the velocity
  double tolerance = 1e-8;  ///< of the residual, relative to the start; flow in = flow out to 5 times that
  int max_iterations = 200;
  std::function<void(int iteration, double residual)> on_iteration;  ///< relative residual
};

struct Flow {
  std::unique_ptr<Space> velocity_space, pressure_space;
  Blocks<double> velocity;  ///< three components, length unit / s
  Vector<double> pressure;  ///< Pa
  int iterations = 0;
  double residual = 1;  ///< relative
  bool converged = false;
  unsigned long long dofs = 0;
  double setup_seconds = 0, solve_seconds = 0, setup_cpu_seconds = 0, solve_cpu_seconds = 0;  ///< CPU: of this rank
};

/// Solves on all ranks together. GMRES in single precision within iterative refinement in double precision, with a
/// multigrid cycle for velocities and, for pressures, the mass matrix and a Darcy problem whose permeability is the
/// torsion function of the lumen: flow in a long vessel is that of a pipe, which the mass matrix alone does not know.
/// Throws Error(bad_input) if there is no end of known pressure, or no flow.
Flow solve_stokes(const FlowProblem& problem, const StokesOptions& options);

}  // namespace vasohex::stokes
