// Compiled once per instruction set, VASOHEX_ISA names the namespace. The lanes of a vector are elements.

#include "vasohex/quality/jacobian_kernel_isa.h"

namespace vasohex::kernel::VASOHEX_ISA {
namespace {

#if defined(__AVX512F__)
constexpr int kLanes = 8;
#elif defined(__AVX__)
constexpr int kLanes = 4;
#else
constexpr int kLanes = 2;
#endif
typedef double Lanes __attribute__((vector_size(8 * kLanes)));

inline Lanes all(double x) { return Lanes{} + x; }
inline Lanes lesser(Lanes a, Lanes b) { return a < b ? a : b; }
inline Lanes greater(Lanes a, Lanes b) { return a > b ? a : b; }
inline Lanes magnitude(Lanes a) { return a < 0.0 ? -a : a; }
inline Lanes square_root(Lanes a) {
  for (int l = 0; l < kLanes; ++l) {
    a[l] = __builtin_sqrt(a[l]);
  }
  return a;
}

/// Error of fl(a + b) [Knuth].
inline Lanes sum_error(Lanes a, Lanes b, Lanes sum) {
  const Lanes t = sum - a;
  return (a - (sum - t)) + (b - t);
}

/// Leading half of a double, so that products of halves are exact [Dekker].
template <class T>
inline T leading_half(T a) {
  const T t = a * 134217729.0;
  return t - (t - a);
}

template <int P>
constexpr int kNodes = (P + 1) * (P + 1) * (P + 1);

/// Coordinates from the element's first node, scaled by a power of two so that the largest lies in [1/2, 1): exact as
/// the sum high + low. Returns lanes of 0, or of NaN where a coordinate is not finite.
template <int P>
Lanes gather(const ElementGroup& group, Lanes (*high)[kNodes<P>], Lanes (*low)[kNodes<P>]) {
  const int* ids[kLanes];
  for (int l = 0; l < kLanes; ++l) {
    // the last group is filled up with copies of its last element
    ids[l] = group.elements + static_cast<long>(l < group.count ? l : group.count - 1) * kNodes<P>;
  }
  Lanes origin[3], extent = {}, flaw = {};
  for (int n = 0; n < kNodes<P>; ++n) {
    double x[3][kLanes];
    for (int l = 0; l < kLanes; ++l) {
      const double* at = group.nodes + 3 * static_cast<long>(ids[l][n]);
      x[0][l] = at[0];
      x[1][l] = at[1];
      x[2][l] = at[2];
    }
    for (int d = 0; d < 3; ++d) {
      Lanes at;
      __builtin_memcpy(&at, x[d], sizeof at);
      if (n == 0) {
        origin[d] = at;
      }
      high[d][n] = at - origin[d];
      low[d][n] = sum_error(at, -origin[d], high[d][n]);
      extent = greater(extent, magnitude(high[d][n]));
      flaw += high[d][n] * 0.0;
    }
  }
  Lanes scale = {};
  for (int l = 0; l < kLanes; ++l) {
    int exponent = 0;
    if (flaw[l] == 0.0) {
      __builtin_frexp(extent[l], &exponent);
    }
    scale[l] = __builtin_ldexp(1.0, -exponent);
  }
  for (int d = 0; d < 3; ++d) {
    for (int n = 0; n < kNodes<P>; ++n) {
      high[d][n] *= scale;
      low[d][n] *= scale;
    }
  }
  return flaw;
}

/// Applies the Bernstein matrix to each line of the lattice along one direction, in twice the working precision
/// [Ogita, Rump, Oishi 2005, Dot2].
template <int P>
void convert_lines(const BernsteinMatrix& matrix, int stride, Lanes* high, Lanes* low) {
  constexpr int N = P + 1;
  double front[N * N], back[N * N];
  for (int m = 0; m < N * N; ++m) {
    front[m] = leading_half(matrix.high[m]);
    back[m] = matrix.high[m] - front[m];
  }
  for (int line = 0; line < N * N; ++line) {
    const int base = stride == 1 ? line * N : stride == N ? line % N + line / N * N * N : line;
    Lanes x[N], y[N], x_front[N], x_back[N];
    for (int c = 0; c < N; ++c) {
      x[c] = high[base + c * stride];
      y[c] = low[base + c * stride];
      x_front[c] = leading_half(x[c]);
      x_back[c] = x[c] - x_front[c];
    }
    // the end points of a line are their own control points
    for (int r = 1; r < P; ++r) {
      Lanes sum = {}, rest = {};
      for (int c = 0; c < N; ++c) {
        const int m = r * N + c;
        const Lanes product = x[c] * matrix.high[m];
        const Lanes lost =
            ((x_front[c] * front[m] - product) + x_front[c] * back[m] + x_back[c] * front[m]) + x_back[c] * back[m];
        const Lanes next = sum + product;
        rest += sum_error(sum, product, next) + (lost + (x[c] * matrix.low[m] + y[c] * matrix.high[m]));
        sum = next;
      }
      const Lanes total = sum + rest;
      high[base + r * stride] = total;
      low[base + r * stride] = rest - (total - sum);
    }
  }
}

template <int N>
struct Binomials {
  double of[N + 1][N + 1] = {};
  constexpr Binomials() {
    for (int n = 0; n <= N; ++n) {
      of[n][0] = 1;
      for (int k = 1; k <= n; ++k) {
        of[n][k] = of[n - 1][k - 1] + (k < n ? of[n - 1][k] : 0);
      }
    }
  }
};
constexpr Binomials<3 * kMaxOrder - 1> kBinomial;

template <int P>
struct DeterminantScratch {
  static constexpr int kDerivative = P * (P + 1) * (P + 1);
  static constexpr int kCross = (2 * P + 1) * 2 * P * 2 * P;
  Lanes det[27 * P * P * P];
  Lanes high[3][kNodes<P>], low[3][kNodes<P>];
  Lanes derivative[3][3][kDerivative];  ///< [direction][component], scaled by binomials
  Lanes cross[3][kCross];
};

/// Control points of dx/du_d over the degree, each times the product of its three binomials: in this scaled form the
/// product of two polynomials is the plain convolution of their coefficients. Returns the largest control vector.
template <int P, int D>
Lanes differentiate(DeterminantScratch<P>& s) {
  constexpr int N = P + 1, ni = D == 0 ? P : N, nj = D == 1 ? P : N, nk = D == 2 ? P : N;
  constexpr int step = D == 0 ? 1 : D == 1 ? N : N * N;
  Lanes largest = {};
  for (int k = 0; k < nk; ++k) {
    for (int j = 0; j < nj; ++j) {
      for (int i = 0; i < ni; ++i) {
        const int from = i + N * (j + N * k), to = i + ni * (j + nj * k);
        const double binomials = kBinomial.of[ni - 1][i] * kBinomial.of[nj - 1][j] * kBinomial.of[nk - 1][k];
        Lanes square = {};
        for (int c = 0; c < 3; ++c) {
          const Lanes a = s.high[c][from + step], b = -s.high[c][from], difference = a + b;
          const Lanes v = difference + (sum_error(a, b, difference) + (s.low[c][from + step] - s.low[c][from]));
          square += v * v;
          s.derivative[D][c][to] = v * binomials;
        }
        largest = greater(largest, square);
      }
    }
  }
  return square_root(largest);
}

/// sum[a + b] += x[a] * y[b]
template <int A, int B>
inline void add_product(Lanes* __restrict sum, const Lanes* __restrict x, const Lanes* __restrict y) {
#pragma GCC unroll 32
  for (int a = 0; a < A; ++a) {
    const Lanes xa = x[a];
#pragma GCC unroll 32
    for (int b = 0; b < B; ++b) {
      sum[a + b] += xa * y[b];
    }
  }
}
template <int A, int B>
inline void subtract_product(Lanes* __restrict sum, const Lanes* __restrict x, const Lanes* __restrict y) {
#pragma GCC unroll 32
  for (int a = 0; a < A; ++a) {
    const Lanes xa = x[a];
#pragma GCC unroll 32
    for (int b = 0; b < B; ++b) {
      sum[a + b] -= xa * y[b];
    }
  }
}

/// Component c of x_v x x_w, degrees 2P, 2P - 1, 2P - 1.
template <int P>
void cross_product(DeterminantScratch<P>& s, int c) {
  constexpr int N = P + 1, M = 2 * P + 1;
  const int c1 = (c + 1) % 3, c2 = (c + 2) % 3;
  for (int k = 0; k < 2 * P; ++k) {
    for (int j = 0; j < 2 * P; ++j) {
      Lanes row[M] = {};
      // x_v has N x P x N control points, x_w has N x N x P
      for (int kv = k < P ? 0 : k - P + 1; kv <= (k < P ? k : P); ++kv) {
        for (int jv = j <= P ? 0 : j - P; jv <= (j < P ? j : P - 1); ++jv) {
          const int v = N * (jv + P * kv), w = N * ((j - jv) + N * (k - kv));
          add_product<N, N>(row, s.derivative[1][c1] + v, s.derivative[2][c2] + w);
          subtract_product<N, N>(row, s.derivative[1][c2] + v, s.derivative[2][c1] + w);
        }
      }
      for (int i = 0; i < M; ++i) {
        s.cross[c][i + M * (j + 2 * P * k)] = row[i];
      }
    }
  }
}

template <int P>
void determinant(const ElementGroup& group, const BernsteinMatrix& matrix, void* scratch, DeterminantSummary& out) {
  constexpr int N = P + 1, M = 2 * P + 1, Q = 3 * P;
  DeterminantScratch<P>& s = *static_cast<DeterminantScratch<P>*>(scratch);
  const Lanes flaw = gather<P>(group, s.high, s.low);
  for (int c = 0; c < 3; ++c) {
    convert_lines<P>(matrix, 1, s.high[c], s.low[c]);
    convert_lines<P>(matrix, N, s.high[c], s.low[c]);
    convert_lines<P>(matrix, N * N, s.high[c], s.low[c]);
  }
  const Lanes u = differentiate<P, 0>(s), v = differentiate<P, 1>(s), w = differentiate<P, 2>(s);
  for (int c = 0; c < 3; ++c) {
    cross_product<P>(s, c);
  }

  double inverse[Q];
  for (int i = 0; i < Q; ++i) {
    inverse[i] = 1 / kBinomial.of[Q - 1][i];
  }
  Lanes least = all(__builtin_huge_val()), corner = least, total = {};
  for (int k = 0; k < Q; ++k) {
    for (int j = 0; j < Q; ++j) {
      Lanes row[Q] = {};
      // x_u has P x N x N control points, the cross product M x 2P x 2P
      for (int kc = k <= P ? 0 : k - P; kc <= (k < 2 * P ? k : 2 * P - 1); ++kc) {
        for (int jc = j <= P ? 0 : j - P; jc <= (j < 2 * P ? j : 2 * P - 1); ++jc) {
          const int a = M * (jc + 2 * P * kc), b = P * ((j - jc) + N * (k - kc));
          add_product<M, P>(row, s.cross[0] + a, s.derivative[0][0] + b);
          add_product<M, P>(row, s.cross[1] + a, s.derivative[0][1] + b);
          add_product<M, P>(row, s.cross[2] + a, s.derivative[0][2] + b);
        }
      }
      const double unscale = inverse[j] * inverse[k];
      for (int i = 0; i < Q; ++i) {
        const Lanes x = row[i] * (inverse[i] * unscale);
        s.det[i + Q * (j + Q * k)] = x;
        least = lesser(least, x);
        total += x;
        if (i % (Q - 1) == 0 && j % (Q - 1) == 0 && k % (Q - 1) == 0) {
          corner = lesser(corner, x);
        }
      }
    }
  }
  const Lanes allowance = matrix.product_error * (u * v * w) + 2.4 * matrix.point_error * (u * v + v * w + w * u);
  for (int l = 0; l < kLanes; ++l) {
    out.least[l] = least[l] + flaw[l];
    out.corner[l] = corner[l] + flaw[l];
    out.mean[l] = total[l] / (Q * Q * Q) + flaw[l];
    out.allowance[l] = allowance[l] + flaw[l];
  }
}

template <int P>
struct ScaledJacobianScratch {
  static constexpr int N = P + 1, M = 2 * P + 1;
  Lanes high[3][kNodes<P>], low[3][kNodes<P>];
  Lanes along_i[2][3][M * N * N];  ///< [value, slope in i][component][a][k][j]
  Lanes along_j[M * M][9][N];      ///< [a, b][slope in i, slope in j, value][component][k]
};

template <int N>
inline Lanes dot(const double* weights, const Lanes* x) {
  Lanes sum = x[0] * weights[0];
  for (int n = 1; n < N; ++n) {
    sum += x[n] * weights[n];
  }
  return sum;
}

template <int P>
void least_scaled_jacobian(const ElementGroup& group, const double* value, const double* slope, void* scratch,
                           double* out) {
  constexpr int N = P + 1, M = 2 * P + 1;
  ScaledJacobianScratch<P>& s = *static_cast<ScaledJacobianScratch<P>*>(scratch);
  const Lanes flaw = gather<P>(group, s.high, s.low);
  for (int c = 0; c < 3; ++c) {
    for (int k = 0; k < N; ++k) {
      for (int j = 0; j < N; ++j) {
        const Lanes* x = s.high[c] + N * (j + N * k);
        for (int a = 0; a < M; ++a) {
          s.along_i[0][c][j + N * (k + N * a)] = dot<N>(value + a * N, x);
          s.along_i[1][c][j + N * (k + N * a)] = dot<N>(slope + a * N, x);
        }
      }
    }
    for (int a = 0; a < M; ++a) {
      for (int k = 0; k < N; ++k) {
        const Lanes* x = s.along_i[0][c] + N * (k + N * a);
        const Lanes* dx = s.along_i[1][c] + N * (k + N * a);
        for (int b = 0; b < M; ++b) {
          s.along_j[a * M + b][c][k] = dot<N>(value + b * N, dx);
          s.along_j[a * M + b][3 + c][k] = dot<N>(slope + b * N, x);
          s.along_j[a * M + b][6 + c][k] = dot<N>(value + b * N, x);
        }
      }
    }
  }
  // sign(s) s^2 of the scaled Jacobian s has its least value at the same point and needs no roots
  Lanes least = all(1);
  for (int ab = 0; ab < M * M; ++ab) {
    for (int g = 0; g < M; ++g) {
      Lanes j[9];
      for (int t = 0; t < 6; ++t) {
        j[t] = dot<N>(value + g * N, s.along_j[ab][t]);
      }
      for (int t = 6; t < 9; ++t) {
        j[t] = dot<N>(slope + g * N, s.along_j[ab][t]);
      }
      const Lanes det = j[0] * (j[4] * j[8] - j[5] * j[7]) + j[1] * (j[5] * j[6] - j[3] * j[8]) +
                        j[2] * (j[3] * j[7] - j[4] * j[6]);
      const Lanes square = (j[0] * j[0] + j[1] * j[1] + j[2] * j[2]) * (j[3] * j[3] + j[4] * j[4] + j[5] * j[5]) *
                           (j[6] * j[6] + j[7] * j[7] + j[8] * j[8]);
      least = lesser(least, det * magnitude(det) / greater(square, all(1e-300)));
    }
  }
  for (int l = 0; l < kLanes; ++l) {
    const double root = __builtin_sqrt(least[l] < 0 ? -least[l] : least[l]);
    out[l] = (least[l] < 0 ? -root : root) + flaw[l];
  }
}

template <int P>
constexpr unsigned long kScratchBytes = sizeof(DeterminantScratch<P>) > sizeof(ScaledJacobianScratch<P>)
                                            ? sizeof(DeterminantScratch<P>)
                                            : sizeof(ScaledJacobianScratch<P>);

/// Calls f with the order as a constant.
template <class F>
auto with_order(int order, F f) {
  switch (order) {
    case 1:
      return f.template operator()<1>();
    case 2:
      return f.template operator()<2>();
    case 3:
      return f.template operator()<3>();
    case 4:
      return f.template operator()<4>();
    case 5:
      return f.template operator()<5>();
    case 6:
      return f.template operator()<6>();
    case 7:
      return f.template operator()<7>();
    case 8:
      return f.template operator()<8>();
    default:
      return f.template operator()<kMaxOrder>();
  }
}

unsigned long scratch_bytes_of(int order) {
  return with_order(order, []<int P>() { return kScratchBytes<P>; });
}

void determinant_of(const ElementGroup& group, const BernsteinMatrix& matrix, void* scratch,
                    DeterminantSummary& out) {
  with_order(group.order, [&]<int P>() { determinant<P>(group, matrix, scratch, out); });
}

void least_scaled_jacobian_of(const ElementGroup& group, const double* value, const double* slope, void* scratch,
                              double out[kMaxLanes]) {
  with_order(group.order, [&]<int P>() { least_scaled_jacobian<P>(group, value, slope, scratch, out); });
}

}  // namespace

extern const JacobianKernel kJacobianKernel;
const JacobianKernel kJacobianKernel = {kLanes, scratch_bytes_of, determinant_of, least_scaled_jacobian_of};

}  // namespace vasohex::kernel::VASOHEX_ISA
