#pragma once
/// \file Internal to blocks/: what makes the minimisation of the blocks' energy converge in some tens of steps.

#include <vector>

#include "vasohex/blocks/polynomial_blocks.h"

namespace vasohex {

/// Approximate inverse of the energy's Hessian: the inverse of a finite-volume Laplacian on the Gauss-Lobatto lattice
/// at degree 2; above, that between interpolations plus a damped Jacobi step (two levels).
class Preconditioner {
 public:
  Preconditioner(const PolynomialBlocks& blocks, const BlockProblem& problem, const BlockTopology& topology);

  /// z = approximate inverse Hessian * g.
  void apply(const Points& g, Points& z);

 private:
  void factorise(const PolynomialBlocks& coarse);
  void interpolate_from(const PolynomialBlocks& coarse, const PolynomialBlocks& blocks);
  void solve();

  using Vec4 = Eigen::Vector4d;  ///< a point and a zero: two vector instructions

  // Cholesky factor L of the permuted Laplacian by columns, the inverse of the diagonal entry first
  std::vector<int> column_, row_;
  std::vector<double> entry_;
  std::vector<int> place_;    ///< [coarse nodes] in the permutation
  std::vector<Vec4> coarse_;  ///< [place] right-hand side, then solution
  // fine node i takes part in the coarse nodes at first_[i] ... first_[i + 1]; empty at degree 2
  std::vector<int> first_, below_;
  std::vector<double> weight_;
  std::vector<double> jacobi_;  ///< [fine nodes] 0 where fixed
};

}  // namespace vasohex
