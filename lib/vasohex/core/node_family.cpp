#include "vasohex/core/node_family.h"

#include <cmath>
#include <numbers>

namespace vasohex {
namespace {

/// Gauss-Lobatto-Legendre nodes on [0,1]: the ends and the roots of P_order', by Newton from Chebyshev's points.
std::vector<double> gauss_lobatto_nodes(int order) {
  std::vector<double> x(order + 1);
  for (int i = 0; i <= order / 2; ++i) {
    double t = -std::cos(std::numbers::pi * i / order);
    if (i == 0) {
      t = -1;
    } else if (2 * i == order) {
      t = 0;
    } else {
      for (int iteration = 0; iteration < 50; ++iteration) {
        double before = 1, p = t;
        for (int k = 2; k <= order; ++k) {
          const double next = ((2 * k - 1) * t * p - (k - 1) * before) / k;
          before = p;
          p = next;
        }
        // (1 - t^2) P' = N (P_{N-1} - t P_N), whose derivative is -N (N + 1) P_N
        const double step = (t * p - before) / ((order + 1) * p);
        t -= step;
        if (std::abs(step) < 1e-16) {
          break;
        }
      }
    }
    x[i] = 0.5 * (1 + t);
    x[order - i] = 1 - x[i];
  }
  return x;
}

}  // namespace

std::vector<double> family_nodes(NodeFamily family, int order) {
  if (family == NodeFamily::gauss_lobatto) {
    return gauss_lobatto_nodes(order);
  }
  std::vector<double> x(order + 1);
  for (int i = 0; i <= order; ++i) {
    x[i] = static_cast<double>(i) / order;
  }
  return x;
}

std::vector<double> lagrange_values(std::span<const double> nodes, std::span<const double> at) {
  const std::size_t n = nodes.size();
  std::vector<double> values(at.size() * n, 1.0);
  for (std::size_t a = 0; a < at.size(); ++a) {
    for (std::size_t i = 0; i < n; ++i) {
      for (std::size_t j = 0; j < n; ++j) {
        if (j != i) {
          values[a * n + i] *= (at[a] - nodes[j]) / (nodes[i] - nodes[j]);
        }
      }
    }
  }
  return values;
}

std::vector<double> lagrange_derivatives(std::span<const double> nodes, std::span<const double> at) {
  const std::size_t n = nodes.size();
  std::vector<double> slopes(at.size() * n, 0.0);
  for (std::size_t a = 0; a < at.size(); ++a) {
    for (std::size_t i = 0; i < n; ++i) {
      for (std::size_t l = 0; l < n; ++l) {
        if (l == i) {
          continue;
        }
        double product = 1 / (nodes[i] - nodes[l]);
        for (std::size_t j = 0; j < n; ++j) {
          if (j != i && j != l) {
            product *= (at[a] - nodes[j]) / (nodes[i] - nodes[j]);
          }
        }
        slopes[a * n + i] += product;
      }
    }
  }
  return slopes;
}

}  // namespace vasohex
