// Compiled once per instruction set, VASOHEX_ISA names the namespace. The lanes of a vector are blocks, as many as a
// register holds; block b adds to sum b % 8, so the result does not depend on how many that is.

#include "vasohex/blocks/energy_kernel_isa.h"

namespace vasohex::kernel::VASOHEX_ISA {
namespace {

constexpr int kSums = kGroup;
#if defined(__AVX512F__)
constexpr int kLanes = 8;
#elif defined(__AVX__)
constexpr int kLanes = 4;
#else
constexpr int kLanes = 2;
#endif
typedef double Lanes __attribute__((vector_size(8 * kLanes)));

inline Lanes all(double x) { return x - Lanes{}; }
inline Lanes square_root(Lanes x) {
  for (int l = 0; l < kLanes; ++l) {
    x[l] = __builtin_sqrt(x[l]);
  }
  return x;
}
inline Lanes lesser(Lanes a, Lanes b) { return a < b ? a : b; }

/// N nodes per direction.
template <int N>
DistortionOutput distortion_of(const DistortionInput& in, double* gradient) {
  constexpr int N2 = N * N, N3 = N * N * N;
  const int samples = in.samples;
  const Lanes eps2 = all(in.epsilon * in.epsilon);
  const Lanes shape_weight = all(in.shape_weight);
  const Lanes jacobian_weight = all(in.jacobian_weight);
  const Lanes goal_scale = all(1 / (1 - in.jacobian_goal));
  const double sample_weight = 1.0 / (double(in.blocks) * samples * samples * samples);
  Lanes energies[kSums / kLanes] = {}, min_jacobian = all(1e9), min_det = all(1e9);
  for (int first = 0; first < in.blocks; first += kLanes) {
    Lanes& energy = energies[first % kSums / kLanes];
    Lanes weight, inverse[3], X[3][N3], G[3][N3];
    const int* ids[kLanes];
    for (int l = 0; l < kLanes; ++l) {
      // the last group is filled up with copies of the last block, which count nothing
      const int b = first + l < in.blocks ? first + l : in.blocks - 1;
      ids[l] = in.ids + (long)b * N3;
      weight[l] = first + l < in.blocks ? sample_weight : 0.0;
      for (int d = 0; d < 3; ++d) {
        inverse[d][l] = in.inverse_length[3 * b + d];
      }
      for (int n = 0; n < N3; ++n) {
        const double* x = in.nodes + 3 * (long)ids[l][n];
        X[0][n][l] = x[0];
        X[1][n][l] = x[1];
        X[2][n][l] = x[2];
      }
    }
    if (gradient) {
      for (int d = 0; d < 3; ++d) {
        for (int n = 0; n < N3; ++n) {
          G[d][n] = all(0);
        }
      }
    }
    for (int a = 0; a < samples; ++a) {
      const double *va = in.value + a * N, *sa = in.slope + a * N;
      // along i: A values, B derivatives (scaled); the adjoints of both
      Lanes A[3][N2], B[3][N2], gA[3][N2], gB[3][N2];
      for (int d = 0; d < 3; ++d) {
        for (int r = 0; r < N2; ++r) {
          Lanes s = va[0] * X[d][r * N], t = sa[0] * X[d][r * N];
          for (int i = 1; i < N; ++i) {
            s += va[i] * X[d][r * N + i];
            t += sa[i] * X[d][r * N + i];
          }
          A[d][r] = s;
          B[d][r] = t * inverse[0];
          gA[d][r] = all(0);
          gB[d][r] = all(0);
        }
      }
      for (int b = 0; b < samples; ++b) {
        const double *vb = in.value + b * N, *sb = in.slope + b * N;
        Lanes AA[3][N], AD[3][N], BA[3][N];
        Lanes gT[3][3][kMostSamples];  // dE/dT of the samples along k
        for (int d = 0; d < 3; ++d) {
          for (int k = 0; k < N; ++k) {
            Lanes s = vb[0] * A[d][k * N], t = sb[0] * A[d][k * N], u = vb[0] * B[d][k * N];
            for (int j = 1; j < N; ++j) {
              s += vb[j] * A[d][k * N + j];
              t += sb[j] * A[d][k * N + j];
              u += vb[j] * B[d][k * N + j];
            }
            AA[d][k] = s * inverse[2];
            AD[d][k] = t * inverse[1];
            BA[d][k] = u;
          }
        }
        for (int c = 0; c < samples; ++c) {
          const double *vc = in.value + c * N, *sc = in.slope + c * N;
          Lanes T[3][3];  // columns of T
          for (int d = 0; d < 3; ++d) {
            Lanes s = vc[0] * BA[d][0], t = vc[0] * AD[d][0], u = sc[0] * AA[d][0];
            for (int k = 1; k < N; ++k) {
              s += vc[k] * BA[d][k];
              t += vc[k] * AD[d][k];
              u += sc[k] * AA[d][k];
            }
            T[0][d] = s;
            T[1][d] = t;
            T[2][d] = u;
          }
          if (in.added) {
            const long sample = c + samples * (b + samples * (a + (long)samples * (first / kGroup)));
            const double* added = in.added + 9 * kGroup * sample + first % kGroup;
            for (int p = 0; p < 3; ++p) {
              for (int d = 0; d < 3; ++d) {
                Lanes more;
                __builtin_memcpy(&more, added + kGroup * (3 * p + d), sizeof more);
                T[p][d] += more * inverse[p];
              }
            }
          }
          Lanes cross[3][3], norm2[3];
          for (int p = 0; p < 3; ++p) {
            const int q = (p + 1) % 3, r = (p + 2) % 3;
            cross[p][0] = T[q][1] * T[r][2] - T[q][2] * T[r][1];
            cross[p][1] = T[q][2] * T[r][0] - T[q][0] * T[r][2];
            cross[p][2] = T[q][0] * T[r][1] - T[q][1] * T[r][0];
            norm2[p] = T[p][0] * T[p][0] + T[p][1] * T[p][1] + T[p][2] * T[p][2] + 1e-24;
          }
          const Lanes det = T[0][0] * cross[0][0] + T[0][1] * cross[0][1] + T[0][2] * cross[0][2];
          const Lanes inverse_norms = 1.0 / square_root(norm2[0] * norm2[1] * norm2[2]);
          const Lanes sigma = det * inverse_norms;
          min_jacobian = lesser(min_jacobian, sigma);
          min_det = lesser(min_det, det);
          const Lanes root = square_root(det * det + eps2);
          Lanes chi = 0.5 * (det + root);
          chi = chi < 1e-30 ? all(1e-30) : chi;
          const Lanes s = (norm2[0] + norm2[1] + norm2[2]) * (1.0 / 3);
          const Lanes root_s = square_root(s);
          const Lanes inverse_chi = 1.0 / chi;
          const Lanes shape = shape_weight * s * root_s * inverse_chi;
          Lanes e = shape;
          // dE/dT_p = along_cross * cross_p + along_self(p) * T_p
          const Lanes dshape_ddet = -shape * inverse_chi * 0.5 * (1.0 + det / root);
          const Lanes dshape_dT = shape_weight * root_s * inverse_chi;
          Lanes djacobian = all(0);
          if (in.jacobian_weight > 0) {
            const Lanes t = (1.0 - sigma) * goal_scale;
            const Lanes t2 = t * t, t4 = t2 * t2, t7 = t4 * t2 * t;
            const Lanes tp1 = in.power == 8 ? t7 : t7 * t4 * t4;
            e += jacobian_weight * tp1 * t;
            djacobian = -jacobian_weight * double(in.power) * tp1 * goal_scale;
          }
          energy += weight * e;
          if (!gradient) {
            continue;
          }
          const Lanes along_cross = (dshape_ddet + djacobian * inverse_norms) * weight;
          for (int p = 0; p < 3; ++p) {
            const Lanes along_self = (dshape_dT - djacobian * sigma / norm2[p]) * weight;
            for (int d = 0; d < 3; ++d) {
              gT[p][d][c] = along_cross * cross[p][d] + along_self * T[p][d];
            }
          }
        }
        if (gradient) {
          for (int d = 0; d < 3; ++d) {
            for (int k = 0; k < N; ++k) {
              Lanes s = all(0), t = all(0), u = all(0);
              for (int c = 0; c < samples; ++c) {
                s += in.slope[c * N + k] * gT[2][d][c];
                t += in.value[c * N + k] * gT[1][d][c];
                u += in.value[c * N + k] * gT[0][d][c];
              }
              s *= inverse[2];
              t *= inverse[1];
              for (int j = 0; j < N; ++j) {
                gA[d][k * N + j] += vb[j] * s + sb[j] * t;
                gB[d][k * N + j] += vb[j] * u;
              }
            }
          }
        }
      }
      if (gradient) {
        for (int d = 0; d < 3; ++d) {
          for (int r = 0; r < N2; ++r) {
            const Lanes s = gA[d][r], t = gB[d][r] * inverse[0];
            for (int i = 0; i < N; ++i) {
              G[d][r * N + i] += va[i] * s + sa[i] * t;
            }
          }
        }
      }
    }
    if (gradient) {
      for (int l = 0; l < kLanes && first + l < in.blocks; ++l) {
        for (int n = 0; n < N3; ++n) {
          double* g = gradient + 3 * (long)ids[l][n];
          g[0] += G[0][n][l];
          g[1] += G[1][n][l];
          g[2] += G[2][n][l];
        }
      }
    }
  }
  DistortionOutput out{0, 1e9, 1e9};
  for (int b = 0; b < kSums; ++b) {
    out.energy += energies[b / kLanes][b % kLanes];
  }
  for (int l = 0; l < kLanes; ++l) {
    out.min_jacobian = min_jacobian[l] < out.min_jacobian ? min_jacobian[l] : out.min_jacobian;
    out.min_det = min_det[l] < out.min_det ? min_det[l] : out.min_det;
  }
  return out;
}

}  // namespace

DistortionOutput distortion(const DistortionInput& in, double* gradient) {
  switch (in.degree) {
    case 2:
      return distortion_of<3>(in, gradient);
    case 3:
      return distortion_of<4>(in, gradient);
    default:
      return distortion_of<5>(in, gradient);
  }
}

}  // namespace vasohex::kernel::VASOHEX_ISA
