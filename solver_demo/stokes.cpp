#include "stokes.h"

#include <deal.II/base/timer.h>
#include <deal.II/lac/solver_gmres.h>

#include "inflow.h"
#include "preconditioner.h"
#include "vasohex/core/error.h"

namespace vasohex::stokes {
namespace {

/// Radius of the widest end, and the flow through all ends of known flow.
std::pair<double, double> reference_length_and_flow(const FlowProblem& problem) {
  bool pressure = false;
  double length = 0, flow = 0;
  for (const End& end : problem.ends) {
    pressure |= !end.flow;
    flow += std::abs(end.flow.value_or(0));
    length = std::max(length, end.radius);
  }
  if (!pressure || flow == 0) {
    throw Error(ErrorCode::bad_input, flow == 0 ? "there is no flow: no end has one that is not zero"
                                                : "no outlet is left: all ends have given flows");
  }
  return {length, flow};
}

}  // namespace

Flow solve_stokes(const FlowProblem& problem, const StokesOptions& options) {
  dealii::Timer timer;
  const auto [length, inflow] = reference_length_and_flow(problem);
  Flow flow;
  flow.velocity_space = std::make_unique<Space>(problem, options.degree);
  const Space& velocity = *flow.velocity_space;
  Hierarchy hierarchy(problem, options.degree);
  const Space& pressure = *hierarchy.spaces.front();
  const std::vector<SpaceUse> uses{
      {&velocity, &velocity.no_slip}, {&pressure, &pressure.free}, {&pressure, &pressure.no_slip}};
  const auto cells = cell_loops<double>(problem, uses, options.degree + 1);
  const auto fast_cells = cell_loops<float>(problem, uses, options.degree + 1);
  std::vector<Resistance> resistances;
  for (const End& end : problem.ends) {
    if (!end.flow && end.resistance > 0) {
      BoundaryWeights weights(problem, velocity, end.boundary_id);
      for (std::size_t i = 0; i < weights.dofs.size(); ++i) {
        if (velocity.no_slip.is_constrained(velocity.dofs.locally_owned_dofs().nth_index_in_set(weights.dofs[i]))) {
          weights.weights[i] = 0;  // the rim: its velocities are known to be zero, its rows must stay so
        }
      }
      resistances.push_back({end.resistance / problem.viscosity, end.normal, std::move(weights)});
    }
  }
  const StokesMatrix<double> matrix(*cells, length, resistances);
  const StokesMatrix<float> fast_matrix(*fast_cells, length, resistances);
  const Preconditioner preconditioner(velocity, *fast_cells, hierarchy, fast_matrix, length, resistances);

  Blocks<double> x, residual;
  matrix.reinit(x);
  matrix.reinit(residual);
  set_inflow(problem, velocity, x);
  Blocks<float> correction, defect;
  fast_matrix.reinit(correction);
  fast_matrix.reinit(defect);
  flow.dofs = x.size();
  flow.setup_seconds = timer.wall_time();
  flow.setup_cpu_seconds = timer.cpu_time();

  timer.restart();
  double first = 0;
  while (true) {
    matrix.vmult(residual, x);
    const double norm = residual.l2_norm();
    first = first == 0 ? norm : first;
    flow.residual = norm / first;
    // the pressure's shape functions sum up to 1: so do the residuals of mass, to the flow that is lost
    const Vector<double>& mass = residual.block(3);
    const double lost = std::abs(mass.mean_value()) * mass.size() * length;
    flow.converged = flow.residual <= options.tolerance && lost <= 5 * options.tolerance * inflow;
    if (flow.converged || flow.iterations >= options.max_iterations) {
      break;
    }
    residual *= -1 / norm;
    for (int c = 0; c < 4; ++c) {
      defect.block(c).copy_locally_owned_data_from(residual.block(c));
    }
    correction = 0;
    const int left = options.max_iterations - flow.iterations, sweep = std::min(left, 40);
    const double goal = std::clamp(.5 * options.tolerance / flow.residual, 1e-4, .1);
    dealii::IterationNumberControl control(sweep, goal);
    dealii::SolverGMRES<Blocks<float>> gmres(control,
                                             dealii::SolverGMRES<Blocks<float>>::AdditionalData(sweep + 3, true));
    gmres.connect([&](unsigned int i, double r, const Blocks<float>&) {
      if (options.on_iteration && i > 0) {
        options.on_iteration(flow.iterations + i, r * flow.residual);
      }
      return dealii::SolverControl::success;
    });
    gmres.solve(fast_matrix, correction, defect, preconditioner);
    flow.iterations += control.last_step();
    for (int c = 0; c < 4; ++c) {
      Vector<double>& step = residual.block(c);
      step.copy_locally_owned_data_from(correction.block(c));
      x.block(c).add(norm, step);
    }
  }
  flow.solve_seconds = timer.wall_time();
  flow.solve_cpu_seconds = timer.cpu_time();

  flow.velocity.reinit(3);
  for (int c = 0; c < 3; ++c) {
    flow.velocity.block(c).swap(x.block(c));
  }
  flow.velocity.collect_sizes();
  flow.velocity.update_ghost_values();
  flow.pressure.swap(x.block(3));
  flow.pressure *= problem.viscosity / length;
  flow.pressure.update_ghost_values();
  flow.pressure_space = std::move(hierarchy.spaces.front());
  return flow;
}

}  // namespace vasohex::stokes
