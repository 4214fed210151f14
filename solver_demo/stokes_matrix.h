#pragma once
/// \file The matrix of Stokes flow.

#include "spaces.h"

namespace vasohex::stokes {

/// Flow out of an end of known pressure that pushes back. The matrix gets resistance * b b^T, flow = b . u.
struct Resistance {
  double over_viscosity;
  dealii::Tensor<1, 3> normal;
  BoundaryWeights weights;

  template <class Number>
  double flow(const Blocks<Number>& x) const {
    double sum = 0;
    for (int c = 0; c < 3; ++c) {
      sum += normal[c] * weights.integrate(x.block(c));
    }
    return dealii::Utilities::MPI::sum(sum, x.block(0).get_mpi_communicator());
  }

  template <class Number>
  void add(double factor, Blocks<Number>& x) const {
    for (int c = 0; c < 3; ++c) {
      for (std::size_t i = 0; i < weights.dofs.size(); ++i) {
        x.block(c).local_element(weights.dofs[i]) += factor * weights.weights[i] * normal[c];
      }
    }
  }
};

/// The matrix of (u, p'), four blocks: viscosity 1, p' = p * length / viscosity, so that rows are of one size
/// whatever the units. Uses of the cells: 0 velocities, 1 pressures (2: velocities of the degree below, for the
/// multigrid).
template <class Number>
class StokesMatrix {
 public:
  StokesMatrix(const Cells<Number>& cells, double length, const std::vector<Resistance>& resistances)
      : cells_(cells), scale_(1 / length), resistances_(resistances) {}

  /// Columns of known velocities are read, their rows give zero.
  void vmult(Blocks<Number>& out, const Blocks<Number>& in) const {
    out = 0;
    for_cells(
        [&](CellValues<3, Number>& u, CellValues<1, Number>& p, Blocks<Number>& y, const Blocks<Number>& x) {
          u.read_dof_values_plain(x);
          p.read_dof_values(x, 3);
          u.evaluate(dealii::EvaluationFlags::gradients);
          p.evaluate(dealii::EvaluationFlags::values);
          for (unsigned int q = 0; q < u.n_q_points; ++q) {
            auto stress = u.get_gradient(q);
            const Wide<Number> divergence = stress[0][0] + stress[1][1] + stress[2][2];
            const Wide<Number> pressure = scale_ * p.get_value(q);
            for (int c = 0; c < 3; ++c) {
              stress[c][c] -= pressure;
            }
            u.submit_gradient(stress, q);
            p.submit_value(-scale_ * divergence, q);
          }
          u.integrate(dealii::EvaluationFlags::gradients);
          p.integrate(dealii::EvaluationFlags::values);
          u.distribute_local_to_global(y);
          p.distribute_local_to_global(y, 3);
        },
        out, in);
    for (const Resistance& r : resistances_) {
      r.add(r.over_viscosity * r.flow(in), out);
    }
  }

  /// out -= B^T p, the velocity blocks only.
  void subtract_gradient(Blocks<Number>& out, const Blocks<Number>& pressure) const {
    for_cells(
        [&](CellValues<3, Number>& u, CellValues<1, Number>& p, Blocks<Number>& y, const Blocks<Number>& x) {
          p.read_dof_values(x);
          p.evaluate(dealii::EvaluationFlags::values);
          for (unsigned int q = 0; q < u.n_q_points; ++q) {
            dealii::Tensor<2, 3, Wide<Number>> stress;
            for (int c = 0; c < 3; ++c) {
              stress[c][c] = scale_ * p.get_value(q);
            }
            u.submit_gradient(stress, q);
          }
          u.integrate(dealii::EvaluationFlags::gradients);
          u.distribute_local_to_global(y);
        },
        out, pressure);
  }

  void reinit(Blocks<Number>& v) const {
    v.reinit(4);
    for (int c = 0; c < 4; ++c) {
      cells_.initialize_dof_vector(v.block(c), c == 3);
    }
    v.collect_sizes();
  }

 private:
  /// Adds to out what f(velocities, pressures, out, in) adds at each batch of cells.
  template <class F>
  void for_cells(const F& f, Blocks<Number>& out, const Blocks<Number>& in) const {
    cells_.template cell_loop<Blocks<Number>, Blocks<Number>>(
        [&](const Cells<Number>&, Blocks<Number>& y, const Blocks<Number>& x, const CellRange& range) {
          CellValues<3, Number> u(cells_, 0);
          CellValues<1, Number> p(cells_, 1);
          for (unsigned int cell = range.first; cell < range.second; ++cell) {
            u.reinit(cell);
            p.reinit(cell);
            f(u, p, y, x);
          }
        },
        out, in, false);
  }

  const Cells<Number>& cells_;
  Number scale_;
  const std::vector<Resistance>& resistances_;
};

}  // namespace vasohex::stokes
