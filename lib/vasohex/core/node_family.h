#pragma once
/// \file One-dimensional node sets on [0,1] and their Lagrange polynomials.

#include <span>
#include <vector>

namespace vasohex {

/// Where the p + 1 nodes of an element edge lie.
enum class NodeFamily {
  equispaced,     ///< as MSH and VTU demand
  gauss_lobatto,  ///< for spectral solvers
};

/// The order + 1 nodes of a family on [0,1], ascending, 0 and 1 included. order >= 1.
std::vector<double> family_nodes(NodeFamily family, int order);

/// Values of the Lagrange polynomials on `nodes` at each of `at`: matrix [at.size()][nodes.size()], row-major.
std::vector<double> lagrange_values(std::span<const double> nodes, std::span<const double> at);

/// The same for their first derivatives.
std::vector<double> lagrange_derivatives(std::span<const double> nodes, std::span<const double> at);

}  // namespace vasohex
