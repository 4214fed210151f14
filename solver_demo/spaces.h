#pragma once
/// \file The flow problem, and the finite element spaces it is solved in.

#include "wide_vectors.h"
// wide_vectors.h comes first

#include <deal.II/base/function.h>
#include <deal.II/dofs/dof_handler.h>
#include <deal.II/fe/fe_q.h>
#include <deal.II/fe/mapping.h>
#include <deal.II/lac/affine_constraints.h>

#include <optional>
#include <string>
#include <vector>

namespace vasohex::stokes {

/// One end of a vessel. With a flow (length unit^3 / s, into the domain) it is an inlet, or an outlet whose flow is
/// known (negative); otherwise the mean pressure is resistance * flow out of it (Pa s / length unit^3).
struct End {
  unsigned int boundary_id = 0;
  std::string name;
  dealii::Tensor<1, 3> normal;  ///< of the plane, outward, unit
  double radius = 0;            ///< of the disc of the same area
  std::optional<double> flow;
  double resistance = 0;
};

struct FlowProblem {
  const dealii::Triangulation<3>* triangulation = nullptr;
  const dealii::Mapping<3>* mapping = nullptr;
  unsigned int wall_id = 0;
  std::vector<End> ends;
  double viscosity = 0;  ///< Pa s
};

/// The continuous scalar space of one degree, and the values that are known to be zero in each of its uses.
struct Space {
  Space(const FlowProblem& problem, int degree);
  Space(const Space&) = delete;

  dealii::FE_Q<3> element;
  dealii::DoFHandler<3> dofs;
  dealii::AffineConstraints<double> free;      ///< none
  dealii::AffineConstraints<double> no_slip;   ///< wall and ends of known flow: velocities
  dealii::AffineConstraints<double> wall;      ///< the wall: the torsion function
  dealii::AffineConstraints<double> pressure;  ///< ends of known pressure: pressures in the preconditioner
};

struct SpaceUse {
  const Space* space;
  const dealii::AffineConstraints<double>* constraints;
};

/// Batches of cells, as cell_loop deals them out.
using CellRange = std::pair<unsigned int, unsigned int>;

/// Cell loops over several spaces, numbered as in `uses`, with so many Gauss points in each direction.
template <class Number>
std::unique_ptr<Cells<Number>> cell_loops(const FlowProblem& problem, const std::vector<SpaceUse>& uses, int points);

/// The integrals of the shape functions over one boundary, where they are not zero on this rank: flows, mean values.
struct BoundaryWeights {
  std::vector<unsigned int> dofs;  ///< local index in vectors of the space
  std::vector<double> weights;     ///< length unit^2

  BoundaryWeights(const FlowProblem& problem, const Space& space, unsigned int boundary_id);

  /// This rank's part of the integral of the function.
  template <class Number>
  double integrate(const Vector<Number>& values) const {
    double sum = 0;
    for (std::size_t i = 0; i < dofs.size(); ++i) {
      sum += weights[i] * values.local_element(dofs[i]);
    }
    return sum;
  }
};

}  // namespace vasohex::stokes
