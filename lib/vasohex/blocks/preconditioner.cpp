#include "vasohex/blocks/preconditioner.h"

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>

namespace vasohex {
namespace {

/// Calls f(node a, node b, weight) for every lattice edge of a finite-volume Laplacian on the Gauss-Lobatto lattice
/// with the blocks' target lengths.
template <class F>
void for_laplacian_edges(const PolynomialBlocks& blocks, F&& f) {
  const int q = blocks.degree(), n = q + 1;
  const std::vector<double>& t = blocks.nodes_1d();
  std::vector<double> width(n, 0.0);
  for (int i = 0; i < q; ++i) {
    width[i] += 0.5 * (t[i + 1] - t[i]);
    width[i + 1] += 0.5 * (t[i + 1] - t[i]);
  }
  blocks.for_lattice_edges([&](int b, int d, const std::array<int, 3>& ijk, int from, int to) {
    const double length = blocks.lengths()[b][d];
    const double weight = width[ijk[(d + 1) % 3]] * width[ijk[(d + 2) % 3]] /
                          ((t[ijk[d] + 1] - t[ijk[d]]) * length * length * blocks.block_count());
    f(from, to, weight);
  });
}

}  // namespace

Preconditioner::Preconditioner(const PolynomialBlocks& blocks, const BlockProblem& problem,
                               const BlockTopology& topology) {
  PolynomialBlocks coarse(problem, topology, 2);
  coarse.adopt_lengths(blocks);
  factorise(coarse);
  if (blocks.degree() > 2) {
    interpolate_from(coarse, blocks);
  }
}

void Preconditioner::factorise(const PolynomialBlocks& coarse) {
  std::vector<Eigen::Triplet<double>> entries;
  const auto& kinds = coarse.kinds();
  double scale = 0;
  for_laplacian_edges(coarse, [&](int a, int b, double w) {
    const bool fixed_a = kinds[a] == NodeKind::fixed, fixed_b = kinds[b] == NodeKind::fixed;
    scale = std::max(scale, w);
    if (!fixed_a) {
      entries.emplace_back(a, a, w);
    }
    if (!fixed_b) {
      entries.emplace_back(b, b, w);
    }
    if (!fixed_a && !fixed_b) {
      entries.emplace_back(std::max(a, b), std::min(a, b), -w);
    }
  });
  // blocks without any section would leave the Laplacian singular
  const int n = static_cast<int>(coarse.x.rows());
  for (int i = 0; i < n; ++i) {
    entries.emplace_back(i, i, kinds[i] == NodeKind::fixed ? scale : 1e-6 * scale);
  }
  Eigen::SparseMatrix<double> matrix(n, n);
  matrix.setFromTriplets(entries.begin(), entries.end());
  const Eigen::SimplicialLLT<Eigen::SparseMatrix<double>> solver(matrix);
  const Eigen::SparseMatrix<double> factor = solver.matrixL();
  column_.assign(factor.outerIndexPtr(), factor.outerIndexPtr() + n + 1);
  row_.assign(factor.innerIndexPtr(), factor.innerIndexPtr() + factor.nonZeros());
  entry_.assign(factor.valuePtr(), factor.valuePtr() + factor.nonZeros());
  for (int c = 0; c < n; ++c) {
    entry_[column_[c]] = 1 / entry_[column_[c]];
  }
  const auto& permutation = solver.permutationP().indices();
  place_.assign(permutation.data(), permutation.data() + n);
  coarse_.resize(n);
}

void Preconditioner::interpolate_from(const PolynomialBlocks& coarse, const PolynomialBlocks& blocks) {
  const int n = blocks.degree() + 1, nodes = static_cast<int>(blocks.x.rows());
  const std::vector<double> values = lagrange_values(coarse.nodes_1d(), blocks.nodes_1d());
  std::vector<std::array<int, 2>> owner(nodes, {-1, -1});  // a block and the point of its lattice
  for (int b = blocks.block_count(); b-- > 0;) {
    for (int at = 0; at < n * n * n; ++at) {
      owner[blocks.id(b, at)] = {b, at};
    }
  }
  jacobi_.assign(nodes, 0.0);
  for_laplacian_edges(blocks, [&](int a, int b, double w) {
    jacobi_[a] += w;
    jacobi_[b] += w;
  });
  first_.assign(1, 0);
  for (int node = 0; node < nodes; ++node) {
    const auto [b, at] = owner[node];
    const bool fixed = blocks.kinds()[node] == NodeKind::fixed;
    for (int c = 0; c < 27 && !fixed; ++c) {
      const double w =
          values[at % n * 3 + c % 3] * values[at / n % n * 3 + c / 3 % 3] * values[at / n / n * 3 + c / 9];
      const int below = coarse.id(b, c);
      if (std::abs(w) > 1e-13 && coarse.kinds()[below] != NodeKind::fixed) {
        below_.push_back(place_[below]);
        weight_.push_back(w);
      }
    }
    first_.push_back(static_cast<int>(below_.size()));
    jacobi_[node] = fixed ? 0.0 : 0.5 / jacobi_[node];
  }
}

void Preconditioner::apply(const Points& g, Points& z) {
  const int nodes = static_cast<int>(g.rows());
  z.resize(nodes, 3);
  const auto padded = [&](int i) { return Vec4(g(i, 0), g(i, 1), g(i, 2), 0); };
  if (first_.empty()) {
    for (int i = 0; i < nodes; ++i) {
      coarse_[place_[i]] = padded(i);
    }
    solve();
    for (int i = 0; i < nodes; ++i) {
      z.row(i) = coarse_[place_[i]].head<3>();
    }
    return;
  }
  std::fill(coarse_.begin(), coarse_.end(), Vec4::Zero());
  for (int i = 0; i < nodes; ++i) {
    const Vec4 v = padded(i);
    for (int k = first_[i]; k < first_[i + 1]; ++k) {
      coarse_[below_[k]] += weight_[k] * v;
    }
  }
  solve();
  for (int i = 0; i < nodes; ++i) {
    Vec4 v = jacobi_[i] * padded(i);
    for (int k = first_[i]; k < first_[i + 1]; ++k) {
      v += weight_[k] * coarse_[below_[k]];
    }
    z.row(i) = v.head<3>();
  }
}

void Preconditioner::solve() {
  const int n = static_cast<int>(coarse_.size());
  for (int c = 0; c < n; ++c) {
    const Vec4 v = coarse_[c] * entry_[column_[c]];
    coarse_[c] = v;
    for (int k = column_[c] + 1; k < column_[c + 1]; ++k) {
      coarse_[row_[k]] -= entry_[k] * v;
    }
  }
  for (int c = n; c-- > 0;) {
    Vec4 v = coarse_[c];
    for (int k = column_[c] + 1; k < column_[c + 1]; ++k) {
      v -= entry_[k] * coarse_[row_[k]];
    }
    coarse_[c] = v * entry_[column_[c]];
  }
}

}  // namespace vasohex
