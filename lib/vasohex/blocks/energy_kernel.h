#pragma once
/// \file The inner loop of the optimisation: distortion energy of polynomial blocks and its gradient, several blocks
/// at a time. This header and its source know neither Eigen nor the standard library: the source is compiled once per
/// instruction set, and an inline function of a header, compiled for a newer processor, must not leak into the rest.

namespace vasohex::kernel {

inline constexpr int kMostSamples = 16;  ///< per direction
inline constexpr int kGroup = 8;         ///< blocks whose `added` lie side by side

struct DistortionInput {
  int degree = 2;                 ///< of the blocks, 2, 3 or 4: degree + 1 nodes per direction
  int samples = 5;                ///< per direction, at most kMostSamples
  const double* value = nullptr;  ///< [samples][degree + 1] Lagrange polynomials at the samples
  const double* slope = nullptr;  ///< [samples][degree + 1] their derivatives
  int blocks = 0;
  const int* ids = nullptr;                ///< [blocks][(degree + 1)^3] node of each lattice point, i fastest
  const double* nodes = nullptr;           ///< [nodes][3]
  const double* inverse_length = nullptr;  ///< [blocks][3] 1 / target length per direction
  /// [ceil(blocks / kGroup)][samples^3][direction][xyz][kGroup] added to J, samples k fastest; beyond the last block
  /// copies of its own. Null: nothing.
  const double* added = nullptr;
  double shape_weight = 1;     ///< w_mu
  double jacobian_weight = 0;  ///< w_s
  double epsilon = 1e-3;       ///< of chi, which keeps folded blocks finite
  double jacobian_goal = 0.5;  ///< s0
  int power = 8;               ///< P: 8 or 16
};

struct DistortionOutput {
  double energy = 0;        ///< mean over blocks and samples
  double min_jacobian = 0;  ///< least scaled Jacobian at a sample
  double min_det = 0;       ///< least det T at a sample
};

/// E = mean [ w_mu s^{3/2} / chi + w_s ((1 - sigma) / (1 - s0))^P ], T = J diag(1 / L_d), d = det T, s = |T|^2 / 3,
/// chi = (d + sqrt(d^2 + eps^2)) / 2, sigma the scaled Jacobian. Adds dE/dnodes to gradient [nodes][3] unless it is
/// null. The result is the same to the last bit for every instruction set.
DistortionOutput distortion(const DistortionInput& in, double* gradient);

}  // namespace vasohex::kernel
