#include "vasohex/quality/validity.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "vasohex/quality/element_loop.h"
#include "vasohex/quality/jacobian_kernel.h"

namespace vasohex {
namespace {

constexpr int kMaxDepth = 6;
constexpr int kMaxSubdivisions = 160;  ///< per element; a hopeless element costs as much as some hundred good ones

/// A number as the unevaluated sum of two doubles, about 32 digits.
struct TwoDoubles {
  double high = 0, low = 0;
};

TwoDoubles exact_sum(double a, double b) {
  const double sum = a + b, t = sum - a;
  return {sum, (a - (sum - t)) + (b - t)};
}

TwoDoubles operator*(TwoDoubles a, TwoDoubles b) {
  const double p = a.high * b.high;
  const double rest = std::fma(a.high, b.high, -p) + (a.high * b.low + a.low * b.high);
  const double high = p + rest;
  return {high, rest - (high - p)};
}

TwoDoubles operator+(TwoDoubles a, TwoDoubles b) {
  const TwoDoubles s = exact_sum(a.high, b.high);
  const double rest = s.low + (a.low + b.low);
  const double high = s.high + rest;
  return {high, rest - (high - s.high)};
}

TwoDoubles operator/(TwoDoubles a, TwoDoubles b) {
  const double first = a.high / b.high;
  const TwoDoubles product = TwoDoubles{first, 0} * b;
  const TwoDoubles left = a + TwoDoubles{-product.high, -product.low};
  return exact_sum(first, left.high / b.high);
}

/// Column j are the Bernstein coefficients of the Lagrange polynomial of node j, a product of factors
/// (t - x_k) / (x_j - x_k) whose coefficients are -x_k <= 0 and 1 - x_k >= 0: no sum below ever cancels.
struct BernsteinConversion {
  std::vector<double> high, low;  ///< [order + 1][order + 1]
  double norm = 0;                ///< largest sum of magnitudes in a row
};

double binomial(int n, int k) {
  double b = 1;
  for (int i = 1; i <= k; ++i) {
    b = b * (n - k + i) / i;
  }
  return b;
}

BernsteinConversion bernstein_conversion(NodeFamily family, int order) {
  const std::vector<double> x = family_nodes(family, order);
  const int n = order + 1;
  BernsteinConversion m{std::vector<double>(n * n), std::vector<double>(n * n), 0};
  for (int j = 0; j < n; ++j) {
    std::vector<TwoDoubles> product{{1, 0}};
    TwoDoubles divisor{1, 0};
    for (int k = 0; k < n; ++k) {
      if (k == j) {
        continue;
      }
      divisor = divisor * exact_sum(x[j], -x[k]);
      std::vector<TwoDoubles> next(product.size() + 1);
      for (std::size_t i = 0; i < product.size(); ++i) {
        next[i] = next[i] + product[i] * TwoDoubles{-x[k], 0};
        next[i + 1] = next[i + 1] + product[i] * exact_sum(1, -x[k]);
      }
      product = std::move(next);
    }
    for (int i = 0; i < n; ++i) {
      const TwoDoubles entry = product[i] / (divisor * TwoDoubles{binomial(order, i), 0});
      m.high[i * n + j] = entry.high;
      m.low[i * n + j] = entry.low;
    }
  }
  for (int i = 0; i < n; ++i) {
    double sum = 0;
    for (int j = 0; j < n; ++j) {
      sum += std::abs(m.high[i * n + j]);
    }
    m.norm = std::max(m.norm, sum);
  }
  return m;
}

/// Bernstein coefficients of one piece of an element, [size^3].
struct Piece {
  std::vector<double> coefficients;
  double least = 0;
  double corner = 0;  ///< least of the 8 at the corners, which are values of det J
  int depth = 0;
};

/// Halves a piece along the direction of the given stride by de Casteljau: `coefficients` becomes the lower half.
void halve(int size, int stride, std::vector<double>& coefficients, std::vector<double>& upper) {
  upper.resize(coefficients.size());
  // lines side by side in memory are worked on together
  const int outer = size * size * size / (stride * size);
  for (int o = 0; o < outer; ++o) {
    double* a = coefficients.data() + static_cast<std::ptrdiff_t>(o) * stride * size;
    double* b = upper.data() + static_cast<std::ptrdiff_t>(o) * stride * size;
    const auto keep = [&](int i) { std::copy_n(a + (size - 1) * stride, stride, b + i * stride); };
    keep(size - 1);
    for (int level = 1; level < size; ++level) {
      for (int i = size - 1; i >= level; --i) {
        double* to = a + i * stride;
        const double* from = to - stride;
        for (int l = 0; l < stride; ++l) {
          to[l] = 0.5 * (to[l] + from[l]);
        }
      }
      keep(size - 1 - level);
    }
  }
}

double least_corner(int size, const std::vector<double>& c) {
  double least = std::numeric_limits<double>::infinity();
  for (int corner = 0; corner < 8; ++corner) {
    const int last = size - 1;
    least = std::min(least, c[(corner & 1) * last + size * ((corner >> 1 & 1) * last + size * (corner >> 2) * last)]);
  }
  return least;
}

/// Subdivides until det J is bounded away from 0 by the allowance, or a value below 0 or a limit is met. The worst
/// piece of each generation goes first, since one value below 0 ends the search.
Validity decide(Piece root, int size, double allowance) {
  const double root_least = root.least;
  double least = std::numeric_limits<double>::infinity();  // over the pieces done with
  bool open = false;
  int subdivisions = 0;
  std::vector<Piece> waiting;
  waiting.push_back(std::move(root));
  while (!waiting.empty()) {
    Piece piece = std::move(waiting.back());
    waiting.pop_back();
    if (piece.depth == kMaxDepth || subdivisions == kMaxSubdivisions) {
      open = true;
      least = std::min(least, piece.least);
      continue;
    }
    ++subdivisions;
    std::array<Piece, 8> octants;
    octants[0].coefficients = std::move(piece.coefficients);
    for (int d = 0, stride = 1; d < 3; ++d, stride *= size) {
      for (int o = 0; o < 1 << d; ++o) {
        halve(size, stride, octants[o].coefficients, octants[o + (1 << d)].coefficients);
      }
    }
    for (Piece& octant : octants) {
      octant.depth = piece.depth + 1;
      octant.least = *std::min_element(octant.coefficients.begin(), octant.coefficients.end());
      octant.corner = least_corner(size, octant.coefficients);
      if (octant.corner < -allowance) {
        return {ValidityState::invalid, root_least - allowance};
      }
    }
    std::stable_sort(octants.begin(), octants.end(),
                     [](const Piece& a, const Piece& b) { return a.least > b.least; });
    for (Piece& octant : octants) {
      if (octant.least > allowance) {
        least = std::min(least, octant.least);
      } else if (octant.least >= -allowance && octant.corner <= allowance) {
        // nothing below 0 is to be found here, and nothing above 0 can be proven
        open = true;
        least = std::min(least, octant.least);
      } else {
        waiting.push_back(std::move(octant));
      }
    }
  }
  return {open ? ValidityState::undecided : ValidityState::certified, least - allowance};
}

}  // namespace

std::vector<Validity> certify(int order, NodeFamily family, std::span<const Vec3> nodes,
                              std::span<const int> elements, const Run& run) {
  const std::size_t count = checked_element_count(order, nodes, elements);
  const BernsteinConversion conversion = bernstein_conversion(family, order);
  const double unit = std::numeric_limits<double>::epsilon() / 2;
  const int n = order + 1, size = 3 * order;
  kernel::BernsteinMatrix matrix{};
  matrix.high = conversion.high.data();
  matrix.low = conversion.low.data();
  // Three passes of n-term sums in twice the working precision, on coordinates below 1, and one rounding of each
  // difference of control points (which, relative to it, is counted in product_error).
  matrix.point_error = 3 * std::pow(4 * n * unit, 2) * std::pow(conversion.norm, 3);
  // A coefficient of det J is a sum of 3 order n^2 products with a coefficient of the cross product, that of 2 order
  // n^2 products; a convolution in Bernstein form averages, and the six products of a determinant are together at
  // most 6 / sqrt(27) |J1||J2||J3| (Carlen, Lieb, Loss: permanents). 30 more roundings: factors, binomials, the sums
  // that form the allowance. Each halving rounds every average, 3 (size - 1) times per subdivision.
  const double roundings = 5.0 * order * n * n + 30 + 3.0 * kMaxDepth * (size - 1);
  matrix.product_error = 1.16 * roundings * unit;

  const kernel::JacobianKernel& kernel = kernel::jacobian_kernel();
  const std::size_t per_element = nodes_per_hex(order), lanes = kernel.lanes;
  std::vector<Validity> result(count);
  // groups of kMaxLanes elements: the ranges must not depend on the processor
  const std::size_t grain = order <= 3 ? 64 * kernel::kMaxLanes : kernel::kMaxLanes;
  for_elements(run, "certify", count, grain, [&](std::size_t begin, std::size_t end) {
    KernelScratch scratch(kernel.scratch_bytes(order));
    const double* coefficients = static_cast<const double*>(scratch.get());
    for (std::size_t e = begin; e < end; e += lanes) {
      const std::size_t used = std::min(lanes, end - e);
      kernel::DeterminantSummary s;
      kernel.determinant({order, static_cast<int>(used), nodes.data()->data(), elements.data() + e * per_element},
                         matrix, scratch.get(), s);
      for (std::size_t l = 0; l < used; ++l) {
        Validity& v = result[e + l];
        const double allowance = s.allowance[l];
        if (!std::isfinite(allowance)) {
          v = {ValidityState::invalid, -std::numeric_limits<double>::infinity()};
          continue;
        }
        if (s.least[l] > allowance) {
          v = {ValidityState::certified, s.least[l] - allowance};
        } else if (s.corner[l] < -allowance) {
          v = {ValidityState::invalid, s.least[l] - allowance};
        } else if (allowance == 0) {  // a point, or flat along one of its directions
          v = {ValidityState::undecided, 0};
        } else {
          Piece root{std::vector<double>(static_cast<std::size_t>(size) * size * size), s.least[l], s.corner[l], 0};
          for (std::size_t i = 0; i < root.coefficients.size(); ++i) {
            root.coefficients[i] = coefficients[i * lanes + l];
          }
          v = decide(std::move(root), size, allowance);
        }
        const double mean = std::abs(s.mean[l]);
        v.bound = mean > 0 ? v.bound / mean : -std::numeric_limits<double>::infinity();
      }
    }
  });
  return result;
}

std::vector<Validity> certify(const HexMesh& mesh, const Run& run) {
  return certify(mesh.order, mesh.family, mesh.nodes, mesh.elements, run);
}

}  // namespace vasohex
