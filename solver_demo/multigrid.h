#pragma once
/// \file Multigrid over the polynomial degrees down to 1, algebraic multigrid below, for Diffusion on one mesh.

#include <deal.II/base/polynomial.h>
#include <deal.II/base/quadrature_lib.h>
#include <deal.II/lac/trilinos_precondition.h>

#include "chebyshev.h"
#include "diffusion.h"

namespace vasohex::stokes {

/// From the space of one degree to that of a higher one on the same cells, by evaluation at the nodes.
template <int components>
class Transfer {
 public:
  /// `fine`, `coarse`: uses of the cells.
  Transfer(const Cells<float>& cells, unsigned int fine, unsigned int coarse)
      : cells_(cells), fine_use_(fine), coarse_use_(coarse) {
    const int fine_degree = cells.get_dof_handler(fine).get_fe().degree;
    const int coarse_degree = cells.get_dof_handler(coarse).get_fe().degree;
    fine_size_ = fine_degree + 1;
    coarse_size_ = coarse_degree + 1;
    const auto polynomials =
        dealii::Polynomials::generate_complete_Lagrange_basis(dealii::QGaussLobatto<1>(coarse_size_).get_points());
    const dealii::QGaussLobatto<1> nodes(fine_size_);
    for (const dealii::Point<1>& node : nodes.get_points()) {
      for (const auto& polynomial : polynomials) {
        matrix_.push_back(polynomial.value(node[0]));
      }
    }
    cells_.initialize_dof_vector(weights_, fine);
    CellValues<1, float> u(cells_, fine);
    for (unsigned int cell = 0; cell < cells_.n_cell_batches(); ++cell) {
      u.reinit(cell);
      std::fill_n(u.begin_dof_values(), u.dofs_per_cell, Wide<float>(1.f));
      u.distribute_local_to_global(weights_);
    }
    weights_.compress(dealii::VectorOperation::add);
    for (unsigned int i = 0; i < weights_.locally_owned_size(); ++i) {
      weights_.local_element(i) = 1 / std::max(1.f, weights_.local_element(i));
    }
    fine_.reinit(components);
    for (int c = 0; c < components; ++c) {
      cells_.initialize_dof_vector(fine_.block(c), fine);
    }
    fine_.collect_sizes();
  }

  void prolongate_and_add(Blocks<float>& fine, const Blocks<float>& coarse) const {
    loop(fine_, coarse, [&](auto& f, auto& c, auto& out, const auto& in) {
      c.read_dof_values(in);
      for (int i = 0; i < components; ++i) {
        interpolate(c.begin_dof_values() + i * c.dofs_per_component, f.begin_dof_values() + i * f.dofs_per_component);
      }
      f.distribute_local_to_global(out);
    });
    weigh(fine, fine_, true);
  }

  /// The transposed.
  void restrict_to(Blocks<float>& coarse, const Blocks<float>& fine) const {
    weigh(fine_, fine, false);
    loop(coarse, fine_, [&](auto& f, auto& c, auto& out, const auto& in) {
      f.read_dof_values(in);
      for (int i = 0; i < components; ++i) {
        collect(f.begin_dof_values() + i * f.dofs_per_component, c.begin_dof_values() + i * c.dofs_per_component);
      }
      c.distribute_local_to_global(out);
    });
  }

 private:
  template <class F>
  void loop(Blocks<float>& out, const Blocks<float>& in, F&& body) const {
    out = 0;  // cell_loop would leave out rows that no cell writes to
    cells_.template cell_loop<Blocks<float>, Blocks<float>>(
        [&](const Cells<float>&, Blocks<float>& y, const Blocks<float>& x, const CellRange& range) {
          CellValues<components, float> fine(cells_, fine_use_), coarse(cells_, coarse_use_);
          for (unsigned int cell = range.first; cell < range.second; ++cell) {
            fine.reinit(cell);
            coarse.reinit(cell);
            body(fine, coarse, y, x);
          }
        },
        out, in, false);
  }

  /// Applies the matrix, or its transposed, along the middle index of in[before][middle][after].
  template <bool transposed>
  void contract(const Wide<float>* in, Wide<float>* out, int before, int after) const {
    const int from = transposed ? fine_size_ : coarse_size_, to = transposed ? coarse_size_ : fine_size_;
    for (int b = 0; b < before; ++b) {
      for (int i = 0; i < to; ++i) {
        for (int a = 0; a < after; ++a) {
          Wide<float> sum = 0.f;
          for (int j = 0; j < from; ++j) {
            sum += matrix_[transposed ? j * to + i : i * from + j] * in[(b * from + j) * after + a];
          }
          out[(b * to + i) * after + a] = sum;
        }
      }
    }
  }

  void interpolate(const Wide<float>* coarse, Wide<float>* fine) const {
    const int n = coarse_size_, m = fine_size_;
    Wide<float> first[most_nodes], second[most_nodes];
    contract<false>(coarse, first, n * n, 1);
    contract<false>(first, second, n, m);
    contract<false>(second, fine, 1, m * m);
  }

  void collect(const Wide<float>* fine, Wide<float>* coarse) const {
    const int n = coarse_size_, m = fine_size_;
    Wide<float> first[most_nodes], second[most_nodes];
    contract<true>(fine, first, 1, m * m);
    contract<true>(first, second, n, m);
    contract<true>(second, coarse, n * n, 1);
  }

  void weigh(Blocks<float>& out, const Blocks<float>& in, bool add) const {
    for (int c = 0; c < components; ++c) {
      float* y = out.block(c).begin();
      const float *x = in.block(c).begin(), *w = weights_.begin();
      for (unsigned int i = 0; i < weights_.locally_owned_size(); ++i) {
        y[i] = (add ? y[i] : 0) + w[i] * x[i];
      }
    }
  }

  static constexpr int most_nodes = 7 * 7 * 7;  ///< degree 6

  const Cells<float>& cells_;
  unsigned int fine_use_, coarse_use_;
  int fine_size_, coarse_size_;  ///< nodes in a direction
  std::vector<float> matrix_;    ///< [fine_size_][coarse_size_]
  Vector<float> weights_;        ///< 1 / number of cells that share the node
  mutable Blocks<float> fine_;
};

/// One V-cycle as a preconditioner.
template <int components>
class Multigrid {
 public:
  struct Level {
    const Cells<float>* cells;
    unsigned int use;         ///< of cells
    unsigned int coarse_use;  ///< the same for the space of the next level; not read on the last one
    SpaceUse space;
    Coefficient coefficient;
  };

  /// Levels from the finest to degree 1.
  Multigrid(std::vector<Level> levels, int smoother_degree) {
    for (std::size_t l = 0; l < levels.size(); ++l) {
      Level& from = levels[l];
      Stage& stage = stages_.emplace_back();
      stage.matrix = std::make_unique<Diffusion<components>>(*from.cells, from.use, std::move(from.coefficient));
      if (l > 0) {
        stage.matrix->reinit(stage.x);
        stage.matrix->reinit(stage.b);
      }
      if (l + 1 < levels.size()) {
        stage.smoother = std::make_unique<Chebyshev<Diffusion<components>>>(*stage.matrix, stage.matrix->diagonal(),
                                                                            smoother_degree, 15);
        stage.transfer = std::make_unique<Transfer<components>>(*from.cells, from.use, from.coarse_use);
        stage.matrix->reinit(stage.residual);
      }
    }
    stages_.back().matrix->assemble(levels.back().space, matrix_);
    dealii::TrilinosWrappers::PreconditionAMG::AdditionalData options;
    options.smoother_sweeps = 2;
    options.aggregation_threshold = .02;
    amg_.initialize(matrix_, options);
    const dealii::DoFHandler<3>& dofs = levels.back().space.space->dofs;
    amg_x_.reinit(dofs.locally_owned_dofs(), dofs.get_communicator());
    amg_b_.reinit(amg_x_);
    amg_r_.reinit(amg_x_);
  }

  void vmult(Blocks<float>& x, const Blocks<float>& b) const { cycle(0, x, b); }

 private:
  struct Stage {
    std::unique_ptr<Diffusion<components>> matrix;
    std::unique_ptr<Chebyshev<Diffusion<components>>> smoother;
    std::unique_ptr<Transfer<components>> transfer;
    mutable Blocks<float> x, b, residual;
  };

  void cycle(std::size_t l, Blocks<float>& x, const Blocks<float>& b) const {
    const Stage& stage = stages_[l];
    if (!stage.smoother) {
      for (int c = 0; c < components; ++c) {
        amg_b_.copy_locally_owned_data_from(b.block(c));
        amg_.vmult(amg_x_, amg_b_);
        // twice: once, the number of iterations grew with the mesh (45 for 36 on the aorta), and this costs little
        matrix_.vmult(amg_r_, amg_x_);
        amg_b_ -= amg_r_;
        amg_.vmult(amg_r_, amg_b_);
        amg_x_ += amg_r_;
        x.block(c).copy_locally_owned_data_from(amg_x_);
      }
      return;
    }
    const Stage& below = stages_[l + 1];
    stage.smoother->smooth(x, b, true);
    stage.matrix->vmult(stage.residual, x);
    stage.residual.sadd(-1, 1, b);
    stage.transfer->restrict_to(below.b, stage.residual);
    cycle(l + 1, below.x, below.b);
    stage.transfer->prolongate_and_add(x, below.x);
    stage.smoother->smooth(x, b, false);
  }

  std::vector<Stage> stages_;
  dealii::TrilinosWrappers::SparseMatrix matrix_;  ///< read by amg_
  dealii::TrilinosWrappers::PreconditionAMG amg_;
  mutable Vector<double> amg_x_, amg_b_, amg_r_;
};

}  // namespace vasohex::stokes
