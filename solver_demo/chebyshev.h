#pragma once
/// \file Chebyshev iterations with a diagonal preconditioner that all components share.

#include <deal.II/lac/solver_cg.h>

#include "wide_vectors.h"

namespace vasohex::stokes {

/// For an Operator with vmult(Blocks&, const Blocks&) and reinit(Blocks&), symmetric, positive semidefinite.
template <class Operator>
class Chebyshev {
 public:
  /// Damps the eigenvalues in [largest / range, largest] of D^-1 A; range 0: all that there are. The diagonal is zero
  /// where values are constrained, and these stay zero.
  Chebyshev(const Operator& matrix, const Vector<float>& diagonal, int degree, double range)
      : matrix_(matrix), degree_(degree), inverse_(diagonal) {
    for (unsigned int i = 0; i < inverse_.locally_owned_size(); ++i) {
      float& d = inverse_.local_element(i);
      d = d > 0 ? 1 / d : 0;
    }
    matrix_.reinit(residual_);
    matrix_.reinit(step_);
    const auto [least, largest] = eigenvalues();
    const double top = 1.1 * largest, bottom = range > 0 ? top / range : .9 * least;
    middle_ = (top + bottom) / 2;
    half_ = (top - bottom) / 2;
  }

  /// Improves x; from_zero: x is taken as zero, whatever it holds.
  void smooth(Blocks<float>& x, const Blocks<float>& b, bool from_zero) const {
    double rho = half_ / middle_;
    update(x, b, from_zero, 0, 1 / middle_);
    for (int i = 1; i < degree_; ++i) {
      const double next = 1 / (2 * middle_ / half_ - rho);
      update(x, b, false, next * rho, 2 * next / half_);
      rho = next;
    }
  }

  void vmult(Blocks<float>& x, const Blocks<float>& b) const { smooth(x, b, true); }

 private:
  struct Jacobi {
    const Vector<float>& inverse;
    void vmult(Blocks<float>& x, const Blocks<float>& b) const {
      x = b;
      for (unsigned int c = 0; c < x.n_blocks(); ++c) {
        x.block(c).scale(inverse);
      }
    }
  };

  /// step = old * step + now * D^-1 (b - A x), x += step; a pass over the vectors after the product
  void update(Blocks<float>& x, const Blocks<float>& b, bool from_zero, float old, float now) const {
    if (!from_zero) {
      matrix_.vmult(residual_, x);
    }
    const float* inverse = inverse_.begin();
    for (unsigned int c = 0; c < x.n_blocks(); ++c) {
      float *xs = x.block(c).begin(), *step = step_.block(c).begin();
      const float *bs = b.block(c).begin(), *ax = residual_.block(c).begin();
      const unsigned int n = inverse_.locally_owned_size();
      if (from_zero) {
#pragma GCC ivdep
        for (unsigned int i = 0; i < n; ++i) {
          step[i] = now * inverse[i] * bs[i];
          xs[i] = step[i];
        }
      } else {
#pragma GCC ivdep
        for (unsigned int i = 0; i < n; ++i) {
          step[i] = (old == 0 ? 0 : old * step[i]) + now * inverse[i] * (bs[i] - ax[i]);
          xs[i] += step[i];
        }
      }
    }
  }

  /// Least and largest of D^-1 A, by conjugate gradients from a rough vector.
  std::pair<double, double> eigenvalues() const {
    Blocks<float> x, b;
    matrix_.reinit(x);
    matrix_.reinit(b);
    const auto first = inverse_.get_partitioner()->local_range().first;
    for (unsigned int c = 0; c < b.n_blocks(); ++c) {
      for (unsigned int i = 0; i < inverse_.locally_owned_size(); ++i) {
        b.block(c).local_element(i) = inverse_.local_element(i) > 0 ? float((first + i) * 7919 % 101) - 50 : 0.f;
      }
    }
    dealii::IterationNumberControl control(15, 1e-6 * b.l2_norm());
    dealii::SolverCG<Blocks<float>> solver(control);
    std::vector<double> found;
    solver.connect_eigenvalues_slot([&](const std::vector<double>& values) { found = values; }, false);
    solver.solve(matrix_, x, b, Jacobi{inverse_});
    return found.empty() ? std::pair(1., 1.) : std::pair(found.front(), found.back());
  }

  const Operator& matrix_;
  int degree_;
  double middle_ = 1, half_ = 0;
  Vector<float> inverse_;
  mutable Blocks<float> residual_, step_;
};

}  // namespace vasohex::stokes
