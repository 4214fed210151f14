#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <random>

#include "curved_box.h"
#include "vasohex/quality/jacobian_kernel_isa.h"
#include "vasohex/quality/quality_report.h"
#include "vasohex/quality/scaled_jacobian.h"
#include "vasohex/quality/skewness.h"

namespace vasohex {
namespace {

constexpr NodeFamily kFamilies[] = {NodeFamily::equispaced, NodeFamily::gauss_lobatto};

template <class Map>
std::vector<Vec3> element_nodes(int order, NodeFamily family, Map map) {
  const std::vector<double> t = family_nodes(family, order);
  std::vector<Vec3> nodes;
  for (int k = 0; k <= order; ++k) {
    for (int j = 0; j <= order; ++j) {
      for (int i = 0; i <= order; ++i) {
        nodes.push_back(map(t[i], t[j], t[k]));
      }
    }
  }
  return nodes;
}

std::vector<int> counting(std::size_t n) {
  std::vector<int> ids(n);
  for (std::size_t i = 0; i < n; ++i) {
    ids[i] = static_cast<int>(i);
  }
  return ids;
}

template <class Map>
Validity certify_map(int order, Map map, NodeFamily family = NodeFamily::equispaced) {
  const std::vector<Vec3> nodes = element_nodes(order, family, map);
  return certify(order, family, nodes, counting(nodes.size())).at(0);
}

/// Elements around the unit cube, every node moved by up to `shift`; nothing is shared.
std::vector<Vec3> random_elements(int order, NodeFamily family, int count, double shift, unsigned seed) {
  std::mt19937 generator(seed);
  std::uniform_real_distribution<double> move(-1, 1);
  std::vector<Vec3> all;
  for (int e = 0; e < count; ++e) {
    for (const Vec3& x : element_nodes(order, family, [](double u, double v, double w) { return Vec3(u, v, w); })) {
      all.push_back(x + shift * Vec3(move(generator), move(generator), move(generator)));
    }
  }
  return all;
}

using Jacobian = std::array<std::array<long double, 3>, 3>;  ///< [direction][component]

/// Straight from the definition, in long double.
Jacobian jacobian_at(int order, NodeFamily family, const Vec3* x, const std::array<double, 3>& at) {
  const std::vector<double> t = family_nodes(family, order);
  const int n = order + 1;
  std::array<std::vector<long double>, 3> value, slope;
  for (int d = 0; d < 3; ++d) {
    for (int i = 0; i < n; ++i) {
      long double v = 1, s = 0;
      for (int j = 0; j < n; ++j) {
        if (j == i) {
          continue;
        }
        v *= (static_cast<long double>(at[d]) - t[j]) / (static_cast<long double>(t[i]) - t[j]);
        long double product = 1 / (static_cast<long double>(t[i]) - t[j]);
        for (int l = 0; l < n; ++l) {
          if (l != i && l != j) {
            product *= (static_cast<long double>(at[d]) - t[l]) / (static_cast<long double>(t[i]) - t[l]);
          }
        }
        s += product;
      }
      value[d].push_back(v);
      slope[d].push_back(s);
    }
  }
  Jacobian result{};
  for (int k = 0; k < n; ++k) {
    for (int j = 0; j < n; ++j) {
      for (int i = 0; i < n; ++i) {
        for (int c = 0; c < 3; ++c) {
          const long double coordinate = x[i + n * (j + n * k)][c];
          result[0][c] += slope[0][i] * value[1][j] * value[2][k] * coordinate;
          result[1][c] += value[0][i] * slope[1][j] * value[2][k] * coordinate;
          result[2][c] += value[0][i] * value[1][j] * slope[2][k] * coordinate;
        }
      }
    }
  }
  return result;
}

long double det(const Jacobian& j) {
  return j[0][0] * (j[1][1] * j[2][2] - j[1][2] * j[2][1]) - j[0][1] * (j[1][0] * j[2][2] - j[1][2] * j[2][0]) +
         j[0][2] * (j[1][0] * j[2][1] - j[1][1] * j[2][0]);
}

long double length(const std::array<long double, 3>& v) { return std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]); }

/// Least det J over the lattice of cuts + 1 points per direction.
long double least_det(int order, NodeFamily family, const Vec3* x, int cuts) {
  long double least = std::numeric_limits<long double>::infinity();
  for (int k = 0; k <= cuts; ++k) {
    for (int j = 0; j <= cuts; ++j) {
      for (int i = 0; i <= cuts; ++i) {
        least = std::min(least,
                         det(jacobian_at(order, family, x, {double(i) / cuts, double(j) / cuts, double(k) / cuts})));
      }
    }
  }
  return least;
}

TEST(Certify, BernsteinCoefficientsByHand) {
  // det J = 1 - u / 2
  const Validity wedge = certify_map(1, [](double u, double v, double w) { return Vec3(u, v, w * (1 - u / 2)); });
  EXPECT_EQ(wedge.state, ValidityState::certified);
  EXPECT_NEAR(wedge.bound, 0.5 / 0.75, 1e-13);
  // det J = 1 + a^2 (2 w - 1)^2 has coefficients 1 + a^2, 1 - a^2, 1 + a^2 along w; its halves have 1 + a^2, 1, 1
  for (const double a : {0.5, 1.1}) {
    const Validity twist = certify_map(
        1, [a](double u, double v, double w) { return Vec3(u + a * v * (2 * w - 1), v - a * u * (2 * w - 1), w); });
    EXPECT_EQ(twist.state, ValidityState::certified);
    EXPECT_NEAR(twist.bound, (a < 1 ? 1 - a * a : 1) / (1 + a * a / 3), 1e-13);
  }
}

TEST(Certify, NeitherClaimIsEverWrong) {
  int certified = 0, invalid = 0, undecided = 0;
  for (int order = 1; order <= 5; ++order) {
    for (const NodeFamily family : kFamilies) {
      const int count = order <= 3 ? 40 : 12;
      const std::size_t per_element = (order + 1) * (order + 1) * (order + 1);
      for (const double shift : {0.1, 0.2, 0.3}) {
        const std::vector<Vec3> nodes = random_elements(order, family, count, shift / order, order);
        const std::vector<Validity> result = certify(order, family, nodes, counting(nodes.size()));
        for (int e = 0; e < count; ++e) {
          const Vec3* x = nodes.data() + e * per_element;
          const Validity& v = result[e];
          long double least = least_det(order, family, x, 8);
          EXPECT_EQ(v.bound > 0, v.state == ValidityState::certified);
          if (v.state == ValidityState::certified) {
            ++certified;
            EXPECT_GT(least, 0);
          } else if (v.state == ValidityState::invalid) {
            ++invalid;
            if (least >= 0) {  // a small inverted part: seen at the corners of the pieces only
              least = least_det(order, family, x, 32);
            }
            EXPECT_LT(least, 0) << "order " << order << " element " << e;
          } else {
            ++undecided;
          }
          if (least < -1e-9) {
            EXPECT_EQ(v.state, ValidityState::invalid);
          }
        }
      }
    }
  }
  EXPECT_GT(certified, 300);
  EXPECT_GT(invalid, 200);
  EXPECT_LT(undecided, 3);
}

TEST(Certify, BoundIsALowerBound) {
  for (int order = 1; order <= 4; ++order) {
    const std::vector<Vec3> nodes = random_elements(order, NodeFamily::equispaced, 10, 0.25 / order, 7);
    const std::size_t per_element = nodes.size() / 10;
    const std::vector<Validity> result = certify(order, NodeFamily::equispaced, nodes, counting(nodes.size()));
    for (int e = 0; e < 10; ++e) {
      const Vec3* x = nodes.data() + e * per_element;
      // the mean by the midpoint rule is good to some per mille
      long double mean = 0;
      const int cuts = 12;
      for (int m = 0; m < cuts * cuts * cuts; ++m) {
        mean += det(jacobian_at(
                    order, NodeFamily::equispaced, x,
                    {(m % cuts + 0.5) / cuts, (m / cuts % cuts + 0.5) / cuts, (m / cuts / cuts + 0.5) / cuts})) /
                (cuts * cuts * cuts);
      }
      const long double least = least_det(order, NodeFamily::equispaced, x, 8) / std::abs(mean);
      EXPECT_LE(result[e].bound, least + 0.01L * std::abs(least));
    }
  }
}

TEST(Certify, SmallMinimaInsideNeedSubdivision) {
  // det J = 4 (w - 1/3)^2 + epsilon
  const auto with = [](double epsilon) {
    return [epsilon](double u, double v, double w) {
      return Vec3(u, v, 4.0 / 3 * std::pow(w - 1.0 / 3, 3) + epsilon * w);
    };
  };
  for (const NodeFamily family : kFamilies) {
    for (const int order : {3, 5}) {
      EXPECT_EQ(certify_map(order, with(1e-2), family).state, ValidityState::certified);
      EXPECT_EQ(certify_map(order, with(1e-3), family).state, ValidityState::certified);
      EXPECT_EQ(certify_map(order, with(0), family).state, ValidityState::undecided);
      EXPECT_EQ(certify_map(order, with(-1e-3), family).state, ValidityState::invalid);
    }
  }
}

TEST(Certify, DecidesNearlyDegenerateCorners) {
  // det J = 1 - c w^2, least at the face w = 1
  const auto with = [](double c) {
    return [c](double u, double v, double w) { return Vec3(u + v * w, v + c * u * w, w); };
  };
  for (const int order : {1, 2, 3, 6, 9}) {
    for (const NodeFamily family : kFamilies) {
      EXPECT_EQ(certify_map(order, with(1 - 1e-11), family).state, ValidityState::certified) << order;
      EXPECT_EQ(certify_map(order, with(1 + 1e-11), family).state, ValidityState::invalid) << order;
    }
  }
  EXPECT_EQ(certify_map(1, with(1)).state, ValidityState::undecided);
}

TEST(Certify, DegenerateInvertedAndBroken) {
  const auto collapsed_edge = certify_map(2, [](double u, double v, double w) { return Vec3(u, v * u, w); });
  EXPECT_EQ(collapsed_edge.state, ValidityState::undecided);
  EXPECT_LE(collapsed_edge.bound, 0);
  const auto flat = certify_map(3, [](double u, double v, double) { return Vec3(u, v, 0); });
  EXPECT_EQ(flat.state, ValidityState::undecided);
  EXPECT_EQ(flat.bound, -std::numeric_limits<double>::infinity());
  const auto point = certify_map(1, [](double, double, double) { return Vec3(1, 2, 3); });
  EXPECT_EQ(point.state, ValidityState::undecided);
  const auto mirrored = certify_map(2, [](double u, double v, double w) { return Vec3(u, w, v); });
  EXPECT_EQ(mirrored.state, ValidityState::invalid);
  EXPECT_NEAR(mirrored.bound, -1, 1e-12);
  const auto broken =
      certify_map(1, [](double u, double v, double w) { return Vec3(u, v, u * v * w > 0 ? NAN : w); });
  EXPECT_EQ(broken.state, ValidityState::invalid);
  EXPECT_EQ(broken.bound, -std::numeric_limits<double>::infinity());
}

TEST(Certify, BadArguments) {
  const std::vector<Vec3> nodes(8, Vec3::Zero());
  EXPECT_THROW(certify(0, NodeFamily::equispaced, nodes, counting(1)), Error);
  EXPECT_THROW(certify(10, NodeFamily::equispaced, nodes, {}), Error);
  EXPECT_THROW(certify(1, NodeFamily::equispaced, nodes, counting(7)), Error);
  EXPECT_THROW(certify(1, NodeFamily::equispaced, std::span(nodes).first(7), counting(8)), Error);
  EXPECT_TRUE(certify(1, NodeFamily::equispaced, {}, {}).empty());
}

TEST(Certify, MotionAndScaleDoNotMatter) {
  for (const int order : {1, 2, 3, 5}) {
    std::vector<Vec3> nodes = random_elements(order, NodeFamily::gauss_lobatto, 20, 0.2 / order, 3);
    const std::vector<int> ids = counting(nodes.size());
    const auto before = certify(order, NodeFamily::gauss_lobatto, nodes, ids);
    const auto sj_before = scaled_jacobian(order, NodeFamily::gauss_lobatto, nodes, ids);
    const auto linear_before = scaled_jacobian_linear(order, nodes, ids);
    const auto skew_before = skewness(order, nodes, ids);
    const Eigen::Matrix3d turn = Eigen::AngleAxisd(1.1, Vec3(1, -2, 3).normalized()).toRotationMatrix();
    for (const double scale : {1e-5, 3e4}) {
      std::vector<Vec3> moved = nodes;
      for (Vec3& x : moved) {
        x = scale * (turn * x + Vec3(30, -7, 9));
      }
      const auto after = certify(order, NodeFamily::gauss_lobatto, moved, ids);
      const auto sj = scaled_jacobian(order, NodeFamily::gauss_lobatto, moved, ids);
      const auto linear = scaled_jacobian_linear(order, moved, ids);
      const auto skew = skewness(order, moved, ids);
      for (std::size_t e = 0; e < after.size(); ++e) {
        EXPECT_EQ(after[e].state, before[e].state);
        EXPECT_NEAR(after[e].bound, before[e].bound, 1e-9 * (1 + std::abs(before[e].bound)));
        EXPECT_NEAR(sj[e], sj_before[e], 1e-11);
        EXPECT_NEAR(linear[e], linear_before[e], 1e-11);
        EXPECT_NEAR(skew[e], skew_before[e], 1e-7);
      }
    }
    // not even where the determinant alone would under- or overflow
    for (const int exponent : {-400, 400}) {
      std::vector<Vec3> moved = nodes;
      for (Vec3& x : moved) {
        x *= std::ldexp(1.0, exponent);
      }
      const auto after = certify(order, NodeFamily::gauss_lobatto, moved, ids);
      const auto sj = scaled_jacobian(order, NodeFamily::gauss_lobatto, moved, ids);
      for (std::size_t e = 0; e < after.size(); ++e) {
        EXPECT_EQ(after[e].state, before[e].state);
        EXPECT_EQ(after[e].bound, before[e].bound);
        EXPECT_EQ(sj[e], sj_before[e]);
      }
    }
  }
}

TEST(Certify, SameBitsForAnyNumberOfThreads) {
  const std::vector<Vec3> nodes = random_elements(3, NodeFamily::equispaced, 301, 0.1, 11);
  const std::vector<int> ids = counting(nodes.size());
  vasohex::Run one, three;
  one.threads = 1;
  three.threads = 3;
  const auto a = certify(3, NodeFamily::equispaced, nodes, ids, one);
  const auto b = certify(3, NodeFamily::equispaced, nodes, ids, three);
  for (std::size_t e = 0; e < a.size(); ++e) {
    EXPECT_EQ(a[e].state, b[e].state);
    EXPECT_EQ(a[e].bound, b[e].bound);
  }
  EXPECT_EQ(scaled_jacobian(3, NodeFamily::equispaced, nodes, ids, one),
            scaled_jacobian(3, NodeFamily::equispaced, nodes, ids, three));
  vasohex::Run stop;
  stop.on_progress = [](std::string_view, double) { return false; };
  EXPECT_THROW(certify(3, NodeFamily::equispaced, nodes, ids, stop), Error);
}

/// All that a kernel computes of some elements.
struct KernelOutput {
  std::vector<double> coefficients, scaled_jacobian;
  kernel::DeterminantSummary summary{};
};

KernelOutput run_kernel(const kernel::JacobianKernel& k, int order, const std::vector<Vec3>& nodes) {
  KernelOutput out;
  const std::size_t n = order + 1, per_element = n * n * n, count = nodes.size() / per_element;
  const std::size_t coefficients = 27 * order * order * order;
  std::vector<double> memory(k.scratch_bytes(order) / sizeof(double) + 8);
  void* scratch = memory.data();
  std::size_t space = memory.size() * sizeof(double);
  std::align(64, k.scratch_bytes(order), scratch, space);
  // any matrix does: all kernels get the same
  std::vector<double> high(n * n), low(n * n);
  for (std::size_t i = 0; i < n * n; ++i) {
    high[i] = std::sin(1.0 + static_cast<double>(i));
    low[i] = 1e-17 * std::cos(static_cast<double>(i));
  }
  const std::vector<double> base = family_nodes(NodeFamily::equispaced, order);
  const std::vector<double> lattice = family_nodes(NodeFamily::equispaced, 2 * order);
  const std::vector<double> value = lagrange_values(base, lattice), slope = lagrange_derivatives(base, lattice);
  const std::vector<int> ids = counting(nodes.size());
  out.coefficients.resize(count * coefficients);
  out.scaled_jacobian.resize(count);
  for (std::size_t e = 0; e < count; e += k.lanes) {
    const std::size_t used = std::min<std::size_t>(k.lanes, count - e);
    const kernel::ElementGroup group{order, static_cast<int>(used), nodes.data()->data(),
                                     ids.data() + e * per_element};
    kernel::DeterminantSummary s;
    k.determinant(group, {high.data(), low.data(), 1e-20, 1e-13}, scratch, s);
    for (std::size_t l = 0; l < used; ++l) {
      for (std::size_t c = 0; c < coefficients; ++c) {
        out.coefficients[(e + l) * coefficients + c] = static_cast<double*>(scratch)[c * k.lanes + l];
      }
      out.summary.least[e + l] = s.least[l];
      out.summary.corner[e + l] = s.corner[l];
      out.summary.mean[e + l] = s.mean[l];
      out.summary.allowance[e + l] = s.allowance[l];
    }
    double least[kernel::kMaxLanes];
    k.least_scaled_jacobian(group, value.data(), slope.data(), scratch, least);
    std::copy_n(least, used, out.scaled_jacobian.begin() + e);
  }
  return out;
}

TEST(JacobianKernel, SameBitsOnEveryProcessor) {
  for (const int order : {1, 2, 3, 5, 9}) {
    const std::vector<Vec3> nodes = random_elements(order, NodeFamily::equispaced, 7, 0.2, 5);
    const KernelOutput base = run_kernel(kernel::baseline::kJacobianKernel, order, nodes);
    std::vector<const kernel::JacobianKernel*> others{&kernel::jacobian_kernel()};
#ifdef __x86_64__
    if (__builtin_cpu_supports("avx2")) {
      others.push_back(&kernel::avx2::kJacobianKernel);
    }
#endif
    for (const kernel::JacobianKernel* k : others) {
      const KernelOutput other = run_kernel(*k, order, nodes);
      EXPECT_EQ(base.coefficients, other.coefficients);
      EXPECT_EQ(base.scaled_jacobian, other.scaled_jacobian);
      for (int e = 0; e < 7; ++e) {
        EXPECT_EQ(base.summary.least[e], other.summary.least[e]);
        EXPECT_EQ(base.summary.corner[e], other.summary.corner[e]);
        EXPECT_EQ(base.summary.mean[e], other.summary.mean[e]);
        EXPECT_EQ(base.summary.allowance[e], other.summary.allowance[e]);
      }
    }
  }
}

TEST(ScaledJacobian, EqualsTheDefinition) {
  for (int order = 1; order <= 4; ++order) {
    for (const NodeFamily family : kFamilies) {
      const int count = 11, cuts = 2 * order;
      const std::vector<Vec3> nodes = random_elements(order, family, count, 0.35 / order, 17);
      const std::vector<double> result = scaled_jacobian(order, family, nodes, counting(nodes.size()));
      for (int e = 0; e < count; ++e) {
        long double least = 1;
        for (int m = 0; m < (cuts + 1) * (cuts + 1) * (cuts + 1); ++m) {
          const Jacobian j = jacobian_at(order, family, nodes.data() + e * (nodes.size() / count),
                                         {double(m % (cuts + 1)) / cuts, double(m / (cuts + 1) % (cuts + 1)) / cuts,
                                          double(m / (cuts + 1) / (cuts + 1)) / cuts});
          least = std::min(least, det(j) / (length(j[0]) * length(j[1]) * length(j[2])));
        }
        EXPECT_NEAR(result[e], least, 1e-12);
      }
    }
  }
}

TEST(ScaledJacobian, KnownShapes) {
  const auto both = [](auto map, double wanted) {
    for (const int order : {1, 3}) {
      const std::vector<Vec3> nodes = element_nodes(order, NodeFamily::equispaced, map);
      EXPECT_NEAR(scaled_jacobian_linear(order, nodes, counting(nodes.size())).at(0), wanted, 1e-14);
      EXPECT_NEAR(scaled_jacobian(order, NodeFamily::equispaced, nodes, counting(nodes.size())).at(0), wanted, 1e-14);
    }
  };
  both([](double u, double v, double w) { return Vec3(3 * u, 2 * v, w); }, 1);
  both([](double u, double v, double w) { return Vec3(u + v / std::sqrt(3.0), v, w); }, std::sqrt(3.0) / 2);
  both([](double u, double v, double w) { return Vec3(v, u, w); }, -1);
  both([](double u, double v, double) { return Vec3(u, v, 0); }, 0);
  both([](double u, double v, double w) { return Vec3(u, v * w > 0 && u > 0 ? INFINITY : v, w); }, -1);
  // corner (1, 1, 1) of a cube moved along its diagonal: the other corners stay better
  const std::vector<Vec3> dented = element_nodes(1, NodeFamily::equispaced, [](double u, double v, double w) {
    return Vec3(Vec3(u, v, w) - 0.4 * u * v * w * Vec3(1, 1, 1));
  });
  const Vec3 a(0.6, -0.4, -0.4), b(-0.4, 0.6, -0.4), c(-0.4, -0.4, 0.6);
  EXPECT_NEAR(scaled_jacobian_linear(1, dented, counting(8)).at(0),
              a.cross(b).dot(c) / (a.norm() * b.norm() * c.norm()), 1e-14);
}

TEST(Skewness, ByHand) {
  const auto of = [](auto map, int order = 1) {
    const std::vector<Vec3> nodes = element_nodes(order, NodeFamily::equispaced, map);
    return skewness(order, nodes, counting(nodes.size())).at(0);
  };
  EXPECT_NEAR(of([](double u, double v, double w) { return Vec3(3 * u, 2 * v, w); }), 0, 1e-15);
  EXPECT_NEAR(of([](double u, double v, double w) { return Vec3(u + v / std::sqrt(3.0), v, w); }, 3), 1.0 / 3, 1e-14);
  // the right angle of a trapezium becomes 45 and 135 degrees
  EXPECT_NEAR(of([](double u, double v, double w) { return Vec3(u * (1 + v), v, w); }), 0.5, 1e-14);
  EXPECT_EQ(of([](double u, double, double w) { return Vec3(u, 0, w); }), 1);
  EXPECT_EQ(of([](double u, double v, double w) { return Vec3(u, v, u > 0 && v > 0 ? NAN : w); }), 1);
  // every angle, one by one
  const std::vector<Vec3> x = random_elements(1, NodeFamily::equispaced, 30, 0.3, 23);
  const std::vector<double> result = skewness(1, x, counting(x.size()));
  for (int e = 0; e < 30; ++e) {
    double worst = 0;
    for (int c = 0; c < 8; ++c) {
      for (int d = 0; d < 3; ++d) {
        const Vec3 u = (x[8 * e + (c ^ 1 << d)] - x[8 * e + c]).normalized();
        const Vec3 v = (x[8 * e + (c ^ 1 << (d + 1) % 3)] - x[8 * e + c]).normalized();
        worst = std::max(worst, std::abs(std::acos(u.dot(v)) * 180 / std::numbers::pi - 90) / 90);
      }
    }
    EXPECT_NEAR(result[e], worst, 1e-12);
  }
}

TEST(QualityReport, GathersTheMeasures) {
  HexMesh mesh = curved_box(2, {5, 4, 5});
  const QualityReport r = measure_quality(mesh);
  ASSERT_EQ(r.element_scaled_jacobian.size(), 100u);
  std::vector<double> sorted = r.element_scaled_jacobian;
  std::sort(sorted.begin(), sorted.end());
  EXPECT_EQ(r.scaled_jacobian.min, sorted[0]);
  EXPECT_NEAR(r.scaled_jacobian.p1, 0.01 * sorted[0] + 0.99 * sorted[1], 1e-15);
  EXPECT_EQ(r.certified, 100);
  EXPECT_EQ(r.invalid + r.undecided, 0);
  EXPECT_GT(r.bound_min, 0);
  EXPECT_LT(r.bound_min, 1);
  ASSERT_EQ(r.worst.size(), 10u);
  for (int i = 0; i < 10; ++i) {
    const QualityReport::Element& w = r.worst[i];
    EXPECT_EQ(w.scaled_jacobian, sorted[i]);
    EXPECT_EQ(r.element_scaled_jacobian[w.element], w.scaled_jacobian);
    EXPECT_EQ(w.block, 10 + w.element);
    EXPECT_EQ(w.branch, -1 - w.element);
  }
  EXPECT_EQ(r.skewness.max, *std::max_element(r.element_skewness.begin(), r.element_skewness.end()));
  EXPECT_GE(r.skewness.max, r.skewness.p99);
  EXPECT_GE(r.skewness.p99, r.skewness.mean);

  mesh.element_block.clear();
  mesh.element_branch.clear();
  std::swap(mesh.elements[0], mesh.elements[2]);  // element 0 folded at a corner
  const QualityReport folded = measure_quality(mesh);
  EXPECT_EQ(folded.invalid, 1);
  EXPECT_EQ(folded.worst[0].element, 0);
  EXPECT_FALSE(folded.worst[0].block || folded.worst[0].branch);
  Vec3 centre = Vec3::Zero();
  for (const int at : {0, 2, 6, 8, 18, 20, 24, 26}) {
    centre += mesh.nodes[mesh.elements[at]] / 8;
  }
  EXPECT_LT((folded.worst[0].centre - centre).norm(), 1e-14);
}

TEST(QualityReport, EmptyMesh) {
  const QualityReport r = measure_quality(HexMesh{});
  EXPECT_TRUE(std::isnan(r.scaled_jacobian.min) && std::isnan(r.skewness.p99) && std::isnan(r.bound_min));
  EXPECT_TRUE(r.worst.empty());
}

}  // namespace
}  // namespace vasohex
