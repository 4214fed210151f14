#pragma once
/// \file Matrix-free -div(c grad u) on each of several components, and what preconditions it on one level.

#include <deal.II/dofs/dof_tools.h>
#include <deal.II/lac/trilinos_sparse_matrix.h>
#include <deal.II/lac/trilinos_sparsity_pattern.h>

#include "spaces.h"

namespace vasohex::stokes {

/// A coefficient per quadrature point of a Cells<float>: [batch * points + point]; empty: 1.
using Coefficient = dealii::AlignedVector<Wide<float>>;

/// -div(c grad u) for `components` functions of one space. Rows of constrained values give zero, columns are not
/// read.
template <int components>
class Diffusion {
 public:
  /// `use`: the space and its constraints, as in the uses of `cells`; both must outlive this.
  Diffusion(const Cells<float>& cells, unsigned int use, Coefficient coefficient = {})
      : cells_(cells), use_(use), coefficient_(std::move(coefficient)) {}

  void vmult(Blocks<float>& out, const Blocks<float>& in) const {
    out = 0;  // cell_loop would leave out rows that no cell writes to
    cells_.template cell_loop<Blocks<float>, Blocks<float>>(
        [&](const Cells<float>&, Blocks<float>& y, const Blocks<float>& x, const CellRange& range) {
          CellValues<components, float> u(cells_, use_);
          for (unsigned int cell = range.first; cell < range.second; ++cell) {
            u.reinit(cell);
            u.read_dof_values(x);
            apply(u, cell);
            u.distribute_local_to_global(y);
          }
        },
        out, in, false);
  }

  /// That of one component.
  Vector<float> diagonal() const {
    Vector<float> result;
    cells_.initialize_dof_vector(result, use_);
    for_each_column([&](CellValues<1, float>& u, unsigned int, const auto& columns) {
      const unsigned int n = u.dofs_per_cell;
      for (unsigned int i = 0; i < n; ++i) {
        u.begin_dof_values()[i] = columns[i * n + i];
      }
      u.distribute_local_to_global(result);
    });
    result.compress(dealii::VectorOperation::add);
    return result;
  }

  /// The matrix of one component, for a space of degree 1; constrained rows get a positive diagonal.
  void assemble(const SpaceUse& use, dealii::TrilinosWrappers::SparseMatrix& matrix) const {
    const dealii::DoFHandler<3>& dofs = use.space->dofs;
    dealii::TrilinosWrappers::SparsityPattern pattern(dofs.locally_owned_dofs(), dofs.get_communicator());
    dealii::DoFTools::make_sparsity_pattern(dofs, pattern, *use.constraints, false);
    pattern.compress();
    matrix.reinit(pattern);
    dealii::FullMatrix<double> local(8, 8);
    std::vector<dealii::types::global_dof_index> indices(8);
    for_each_column([&](CellValues<1, float>&, unsigned int batch, const auto& columns) {
      for (unsigned int lane = 0; lane < cells_.n_active_entries_per_cell_batch(batch); ++lane) {
        for (unsigned int i = 0; i < 8; ++i) {
          for (unsigned int j = 0; j < 8; ++j) {
            local(i, j) = columns[j * 8 + i][lane];
          }
        }
        cells_.get_cell_iterator(batch, lane, use_)->get_dof_indices(indices);
        use.constraints->distribute_local_to_global(local, indices, matrix);
      }
    });
    matrix.compress(dealii::VectorOperation::add);
  }

  const Cells<float>& cells() const { return cells_; }
  unsigned int use() const { return use_; }

  void reinit(Blocks<float>& v) const {
    v.reinit(components);
    for (int c = 0; c < components; ++c) {
      cells_.initialize_dof_vector(v.block(c), use_);
    }
    v.collect_sizes();
  }

 private:
  template <int n>
  void apply(CellValues<n, float>& u, unsigned int cell) const {
    u.evaluate(dealii::EvaluationFlags::gradients);
    for (unsigned int q = 0; q < u.n_q_points; ++q) {
      if (coefficient_.empty()) {
        u.submit_gradient(u.get_gradient(q), q);
      } else {
        u.submit_gradient(coefficient_[cell * u.n_q_points + q] * u.get_gradient(q), q);
      }
    }
    u.integrate(dealii::EvaluationFlags::gradients);
  }

  /// Calls f(values, batch, columns) for each batch of cells, columns[j * n + i] the element matrices.
  template <class F>
  void for_each_column(F&& f) const {
    CellValues<1, float> u(cells_, use_);
    const unsigned int n = u.dofs_per_cell;
    dealii::AlignedVector<Wide<float>> columns(n * n);
    for (unsigned int batch = 0; batch < cells_.n_cell_batches(); ++batch) {
      u.reinit(batch);
      for (unsigned int j = 0; j < n; ++j) {
        for (unsigned int i = 0; i < n; ++i) {
          u.begin_dof_values()[i] = i == j ? 1.f : 0.f;
        }
        apply(u, batch);
        std::copy_n(u.begin_dof_values(), n, &columns[j * n]);
      }
      f(u, batch, columns);
    }
  }

  const Cells<float>& cells_;
  unsigned int use_;
  Coefficient coefficient_;
};

}  // namespace vasohex::stokes
