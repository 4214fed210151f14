#include "spaces.h"

#include <deal.II/base/quadrature_lib.h>
#include <deal.II/dofs/dof_tools.h>
#include <deal.II/fe/fe_values.h>

namespace vasohex::stokes {

Space::Space(const FlowProblem& problem, int degree) : element(degree), dofs(*problem.triangulation) {
  dofs.distribute_dofs(element);
  const dealii::IndexSet relevant = dealii::DoFTools::extract_locally_relevant_dofs(dofs);
  for (auto* constraints : {&free, &no_slip, &wall, &pressure}) {
    constraints->reinit(relevant);
  }
  dealii::DoFTools::make_zero_boundary_constraints(dofs, problem.wall_id, no_slip);
  dealii::DoFTools::make_zero_boundary_constraints(dofs, problem.wall_id, wall);
  for (const End& end : problem.ends) {
    dealii::DoFTools::make_zero_boundary_constraints(dofs, end.boundary_id, end.flow ? no_slip : pressure);
  }
  for (auto* constraints : {&free, &no_slip, &wall, &pressure}) {
    constraints->close();
  }
}

template <class Number>
std::unique_ptr<Cells<Number>> cell_loops(const FlowProblem& problem, const std::vector<SpaceUse>& uses, int points) {
  std::vector<const dealii::DoFHandler<3>*> dofs;
  std::vector<const dealii::AffineConstraints<double>*> constraints;
  for (const SpaceUse& use : uses) {
    dofs.push_back(&use.space->dofs);
    constraints.push_back(use.constraints);
  }
  typename Cells<Number>::AdditionalData data;
  data.tasks_parallel_scheme = Cells<Number>::AdditionalData::none;
  data.mapping_update_flags = dealii::update_gradients | dealii::update_JxW_values;
  auto cells = std::make_unique<Cells<Number>>();
  cells->reinit(*problem.mapping, dofs, constraints, dealii::QGauss<1>(points), data);
  return cells;
}

template std::unique_ptr<Cells<float>> cell_loops(const FlowProblem&, const std::vector<SpaceUse>&, int);
template std::unique_ptr<Cells<double>> cell_loops(const FlowProblem&, const std::vector<SpaceUse>&, int);

BoundaryWeights::BoundaryWeights(const FlowProblem& problem, const Space& space, unsigned int boundary_id) {
  const dealii::IndexSet relevant = dealii::DoFTools::extract_locally_relevant_dofs(space.dofs);
  Vector<double> sums(space.dofs.locally_owned_dofs(), relevant, space.dofs.get_communicator());
  // a point more than for velocities: the normal of a curved face is a polynomial of twice its degree
  dealii::FEFaceValues<3> face(*problem.mapping, space.element, dealii::QGauss<2>(space.element.degree + 2),
                               dealii::update_values | dealii::update_JxW_values);
  std::vector<dealii::types::global_dof_index> indices(space.element.dofs_per_cell);
  for (const auto& cell : space.dofs.active_cell_iterators()) {
    for (unsigned int f = 0; cell->is_locally_owned() && f < 6; ++f) {
      if (!cell->face(f)->at_boundary() || cell->face(f)->boundary_id() != boundary_id) {
        continue;
      }
      face.reinit(cell, f);
      cell->get_dof_indices(indices);
      for (unsigned int i = 0; i < indices.size(); ++i) {
        if (space.element.has_support_on_face(i, f)) {
          for (unsigned int q = 0; q < face.n_quadrature_points; ++q) {
            sums[indices[i]] += face.shape_value(i, q) * face.JxW(q);
          }
        }
      }
    }
  }
  sums.compress(dealii::VectorOperation::add);
  for (unsigned int i = 0; i < sums.locally_owned_size(); ++i) {
    if (sums.local_element(i) != 0) {
      dofs.push_back(i);
      weights.push_back(sums.local_element(i));
    }
  }
}

}  // namespace vasohex::stokes
