#pragma once
/// \file What preconditions the matrix of Stokes flow: multigrid for velocities, mass matrix and Darcy flow for
/// pressures.

#include <deal.II/lac/full_matrix.h>

#include "multigrid.h"
#include "stokes_matrix.h"

namespace vasohex::stokes {

/// The mass matrix of pressures, use 1 of the cells.
class PressureMass {
 public:
  explicit PressureMass(const Cells<float>& cells) : cells_(cells) {}

  void vmult(Blocks<float>& out, const Blocks<float>& in) const {
    out = 0;
    cells_.cell_loop<Blocks<float>, Blocks<float>>(
        [&](const Cells<float>&, Blocks<float>& y, const Blocks<float>& x, const CellRange& range) {
          CellValues<1, float> p(cells_, 1);
          for (unsigned int cell = range.first; cell < range.second; ++cell) {
            p.reinit(cell);
            p.read_dof_values(x);
            p.evaluate(dealii::EvaluationFlags::values);
            for (unsigned int q = 0; q < p.n_q_points; ++q) {
              p.submit_value(p.get_value(q), q);
            }
            p.integrate(dealii::EvaluationFlags::values);
            p.distribute_local_to_global(y);
          }
        },
        out, in, false);
  }

  /// The sum of each row. With Gauss-Lobatto nodes it is positive and nearer to the matrix than its diagonal is: the
  /// condition number stays below (2 + 1/degree)^3.
  Vector<float> lumped() const {
    Blocks<float> one, sums;
    reinit(one);
    reinit(sums);
    one = 1;
    vmult(sums, one);
    return sums.block(0);
  }

  void reinit(Blocks<float>& v) const {
    v.reinit(1);
    cells_.initialize_dof_vector(v.block(0), 1);
    v.collect_sizes();
  }

 private:
  const Cells<float>& cells_;
};

/// The spaces of degrees below the velocity's, k - 1, then halved down to 1, and their cell loops.
struct Hierarchy {
  enum Use : unsigned int { velocity, pressure, torsion, coarse_velocity, coarse_pressure };

  std::vector<std::unique_ptr<Space>> spaces;        ///< k - 1 first
  std::vector<std::unique_ptr<Cells<float>>> cells;  ///< of spaces

  Hierarchy(const FlowProblem& problem, int degree) {
    for (int d = degree - 1; d >= 1; d /= 2) {
      spaces.push_back(std::make_unique<Space>(problem, d));
    }
    const Space& linear = *spaces.back();
    for (std::size_t l = 0; l < spaces.size(); ++l) {
      const Space& space = *spaces[l];
      std::vector<SpaceUse> uses{{&space, &space.no_slip}, {&space, &space.pressure}, {&linear, &linear.wall}};
      if (l + 1 < spaces.size()) {
        const Space& below = *spaces[l + 1];
        uses.insert(uses.end(), {{&below, &below.no_slip}, {&below, &below.pressure}});
      }
      cells.push_back(cell_loops<float>(problem, uses, space.element.degree + 1));
    }
  }
};

/// w with -laplace w = 1, w = 0 on the wall: r^2/8 in the mean over a circular section, the permeability of a vessel.
inline Blocks<float> torsion_function(const Hierarchy& h) {
  const Cells<float>& cells = *h.cells.back();
  const SpaceUse space{h.spaces.back().get(), &h.spaces.back()->wall};
  const Multigrid<1> preconditioner({{&cells, Hierarchy::torsion, 0, space, {}}}, 1);
  const Diffusion<1> matrix(cells, Hierarchy::torsion);
  Blocks<float> w, load;
  matrix.reinit(w);
  matrix.reinit(load);
  CellValues<1, float> values(cells, Hierarchy::torsion);
  for (unsigned int cell = 0; cell < cells.n_cell_batches(); ++cell) {
    values.reinit(cell);
    for (unsigned int q = 0; q < values.n_q_points; ++q) {
      values.submit_value(Wide<float>(1.f), q);
    }
    values.integrate(dealii::EvaluationFlags::values);
    values.distribute_local_to_global(load.block(0));
  }
  load.compress(dealii::VectorOperation::add);
  dealii::ReductionControl control(100, 0, 1e-3);
  dealii::SolverCG<Blocks<float>>(control).solve(matrix, w, load, preconditioner);
  return w;
}

/// Its values in the quadrature points; not quite zero, for cells with all corners on the wall.
inline Coefficient permeability(const Cells<float>& cells, const Blocks<float>& torsion) {
  Vector<float> w;
  cells.initialize_dof_vector(w, Hierarchy::torsion);
  w.copy_locally_owned_data_from(torsion.block(0));
  w.update_ghost_values();
  CellValues<1, float> values(cells, Hierarchy::torsion);
  Coefficient result(cells.n_cell_batches() * values.n_q_points);
  for (unsigned int cell = 0; cell < cells.n_cell_batches(); ++cell) {
    values.reinit(cell);
    values.read_dof_values(w);
    values.evaluate(dealii::EvaluationFlags::values);
    Wide<float> volume = 0.f;
    for (unsigned int q = 0; q < values.n_q_points; ++q) {
      volume += values.JxW(q);
    }
    const Wide<float> size = std::pow(volume, 1.f / 3);
    for (unsigned int q = 0; q < values.n_q_points; ++q) {
      result[cell * values.n_q_points + q] = std::max(values.get_value(q), Wide<float>(0.f)) + .01f * size * size;
    }
  }
  return result;
}

/// Block upper triangular: a pressure from the divergence, then a velocity. With resistances, corrected by the
/// Woodbury formula for their part of the matrix.
class Preconditioner {
 public:
  Preconditioner(const Space& velocity, const Cells<float>& cells, const Hierarchy& h,
                 const StokesMatrix<float>& matrix, double length, const std::vector<Resistance>& resistances)
      : matrix_(matrix), length_(length), mass_matrix_(cells), resistances_(resistances) {
    mass_ = std::make_unique<Chebyshev<PressureMass>>(mass_matrix_, mass_matrix_.lumped(), 6, 0);
    const Blocks<float> torsion = torsion_function(h);
    std::vector<Multigrid<3>::Level> for_velocity{{&cells, 0, 2, {&velocity, &velocity.no_slip}, {}}};
    std::vector<Multigrid<1>::Level> for_pressure;
    for (std::size_t l = 0; l < h.spaces.size(); ++l) {
      const Space& space = *h.spaces[l];
      const Cells<float>& loops = *h.cells[l];
      for_velocity.push_back({&loops, Hierarchy::velocity, Hierarchy::coarse_velocity, {&space, &space.no_slip}, {}});
      for_pressure.push_back({&loops,
                              Hierarchy::pressure,
                              Hierarchy::coarse_pressure,
                              {&space, &space.pressure},
                              permeability(loops, torsion)});
    }
    velocity_ = std::make_unique<Multigrid<3>>(std::move(for_velocity), 4);
    darcy_ = std::make_unique<Multigrid<1>>(std::move(for_pressure), 3);
    matrix_.reinit(work_);
    mass_matrix_.reinit(p_);
    mass_matrix_.reinit(darcy_b_);
    mass_matrix_.reinit(darcy_p_);
    u_.reinit(3);
    b_.reinit(3);
    for (int c = 0; c < 3; ++c) {
      u_.block(c).reinit(work_.block(c));
      b_.block(c).reinit(work_.block(c));
    }
    u_.collect_sizes();
    b_.collect_sizes();
    add_resistances();
  }

  void vmult(Blocks<float>& z, const Blocks<float>& r) const {
    without_resistances(z, r);
    if (!responses_.empty()) {
      dealii::Vector<double> flows(responses_.size()), factors(responses_.size());
      for (std::size_t i = 0; i < responses_.size(); ++i) {
        flows[i] = resistances_[i].flow(z);
      }
      capacitance_.vmult(factors, flows);
      for (std::size_t i = 0; i < responses_.size(); ++i) {
        z.add(-factors[i], responses_[i]);
      }
    }
  }

 private:
  void without_resistances(Blocks<float>& z, const Blocks<float>& r) const {
    darcy_b_.block(0).copy_locally_owned_data_from(r.block(3));
    mass_->vmult(p_, darcy_b_);
    darcy_->vmult(darcy_p_, darcy_b_);
    p_ += darcy_p_;
    p_ *= -length_ * length_;
    z.block(3).copy_locally_owned_data_from(p_.block(0));
    for (int c = 0; c < 3; ++c) {
      b_.block(c).copy_locally_owned_data_from(r.block(c));
    }
    matrix_.subtract_gradient(b_, p_);
    velocity_->vmult(u_, b_);
    for (int c = 0; c < 3; ++c) {
      z.block(c).copy_locally_owned_data_from(u_.block(c));
    }
  }

  void add_resistances() {
    const std::size_t n = resistances_.size();
    if (n == 0) {
      return;
    }
    dealii::FullMatrix<double> matrix(n, n);
    for (std::size_t i = 0; i < n; ++i) {
      Blocks<float> b, response;
      matrix_.reinit(b);
      matrix_.reinit(response);
      resistances_[i].add(1., b);
      without_resistances(response, b);
      for (std::size_t j = 0; j < n; ++j) {
        matrix(j, i) = resistances_[j].flow(response);
      }
      matrix(i, i) += 1 / resistances_[i].over_viscosity;
      responses_.push_back(std::move(response));
    }
    capacitance_.reinit(n, n);
    capacitance_.invert(matrix);
  }

  const StokesMatrix<float>& matrix_;
  float length_;
  PressureMass mass_matrix_;
  std::unique_ptr<Chebyshev<PressureMass>> mass_;
  std::unique_ptr<Multigrid<3>> velocity_;
  std::unique_ptr<Multigrid<1>> darcy_;
  const std::vector<Resistance>& resistances_;
  std::vector<Blocks<float>> responses_;  ///< to a unit pressure on each resistance's end
  dealii::FullMatrix<double> capacitance_;
  mutable Blocks<float> work_, p_, darcy_b_, darcy_p_, u_, b_;
};

}  // namespace vasohex::stokes
