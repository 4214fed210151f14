#include "vasohex/skeleton/spline.h"

#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <algorithm>
#include <array>
#include <cmath>

namespace vasohex {
namespace {

/// Knot i of data that may be closed: index of the value, and position on the unrolled line.
struct Knot {
  int index = 0;
  double t = 0;
};

Knot knot(const KnotData& data, int i) {
  const int n = static_cast<int>(data.values.rows());
  if (!data.closed) {
    return {i, data.t[i]};
  }
  const int turn = i >= 0 ? i / n : -((n - 1 - i) / n);
  return {i - turn * n, data.t[i - turn * n] + turn * (data.t[n] - data.t[0])};
}

}  // namespace

SpaceSpline::Value SpaceSpline::at(std::size_t piece, double s) const {
  const double h = t[piece + 1] - t[piece];
  const double b = (s - t[piece]) / h, a = 1 - b;
  const Vec3 &p0 = points[piece], &p1 = points[piece + 1], &m0 = derivatives[piece], &m1 = derivatives[piece + 1];
  Value value;
  value.position = a * p0 + b * p1 + h * h / 6 * ((a * a * a - a) * m0 + (b * b * b - b) * m1);
  value.first = (p1 - p0) / h + h / 6 * ((1 - 3 * a * a) * m0 + (3 * b * b - 1) * m1);
  value.second = a * m0 + b * m1;
  return value;
}

double curvature(const SpaceSpline::Value& value) {
  const double speed = value.first.norm();
  return value.first.cross(value.second).norm() / (speed * speed * speed);
}

Smoothed smooth(const KnotData& data, std::span<const double> compliance) {
  using Triplet = Eigen::Triplet<double>;
  const int n = static_cast<int>(data.values.rows());
  const int first = data.closed ? 0 : 1;  // knots with an unknown second derivative
  const int count = data.closed ? n : n - 2;
  Smoothed result{data.values, Eigen::MatrixXd::Zero(n, data.values.cols())};
  if (count <= 0) {
    return result;
  }

  // Second derivatives g of the spline through x satisfy R g = Q^T x
  std::vector<Triplet> q, r;
  std::array<double, 2> run_out{0, 0};
  for (int k = 0; k < count; ++k) {
    const Knot left = knot(data, first + k - 1), mid = knot(data, first + k), right = knot(data, first + k + 1);
    const double h0 = mid.t - left.t, h1 = right.t - mid.t;
    q.emplace_back(left.index, k, 1 / h0);
    q.emplace_back(mid.index, k, -1 / h0 - 1 / h1);
    q.emplace_back(right.index, k, 1 / h1);
    r.emplace_back(k, k, (h0 + h1) / 3);
    if (data.closed || k + 1 < count) {
      r.emplace_back(k, (k + 1) % count, h1 / 6);
      r.emplace_back((k + 1) % count, k, h1 / 6);
    }
    // constant curvature in the first and last piece follows an arc to its end; less where that piece is long
    // against its neighbour, as the curvature there says little about it
    if (!data.closed && k == 0) {
      run_out[0] = std::min(1.0, h1 * h1 / (h0 * h0));
      r.emplace_back(k, k, run_out[0] * h0 / 6);
    }
    if (!data.closed && k == count - 1) {
      run_out[1] = std::min(1.0, h0 * h0 / (h1 * h1));
      r.emplace_back(k, k, run_out[1] * h1 / 6);
    }
  }
  Eigen::SparseMatrix<double> Q(n, count), R(count, count);
  Q.setFromTriplets(q.begin(), q.end());
  R.setFromTriplets(r.begin(), r.end());
  const Eigen::Map<const Eigen::VectorXd> c(compliance.data(), n);
  const Eigen::SparseMatrix<double> K = R + Eigen::SparseMatrix<double>(Q.transpose() * c.asDiagonal() * Q);
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver(K);
  const Eigen::MatrixXd g = solver.solve(Q.transpose() * data.values);
  result.values -= c.asDiagonal() * (Q * g);
  result.second.middleRows(first, count) = g;
  if (!data.closed) {
    result.second.row(0) = run_out[0] * g.row(0);
    result.second.row(n - 1) = run_out[1] * g.row(count - 1);
  }
  return result;
}

SpaceSpline spline_through(const KnotData& data, const Smoothed& fit) {
  const int n = static_cast<int>(data.values.rows());
  SpaceSpline spline{data.t, {}, {}};
  for (int i = 0; i < static_cast<int>(data.t.size()); ++i) {
    spline.points.push_back(fit.values.row(i % n).transpose());
    spline.derivatives.push_back(fit.second.row(i % n).transpose());
  }
  return spline;
}

std::vector<double> noise_level(const KnotData& data) {
  const int n = static_cast<int>(data.values.rows());
  const int points = std::min(5, n);  // of one difference
  std::vector<double> level(n, 0.0);
  if (points < 3) {
    return level;
  }
  const int differences = data.closed ? n : n - points + 1;
  std::vector<double> square(differences);
  for (int k = 0; k < differences; ++k) {
    Eigen::RowVectorXd sum = Eigen::RowVectorXd::Zero(data.values.cols());
    double weights = 0;
    const double scale = knot(data, k + points - 1).t - knot(data, k).t;
    for (int i = 0; i < points; ++i) {
      double w = 1;
      for (int j = 0; j < points; ++j) {
        w *= i == j ? 1 : scale / (knot(data, k + i).t - knot(data, k + j).t);
      }
      sum += w * data.values.row(knot(data, k + i).index);
      weights += w * w;
    }
    square[k] = sum.squaredNorm() / (weights * static_cast<double>(data.values.cols()));
  }
  constexpr int reach = 6;  // differences to either side whose mean is taken
  for (int i = 0; i < n; ++i) {
    const int middle = i - points / 2;
    double sum = 0;
    int terms = 0;
    for (int k = middle - reach; k <= middle + reach; ++k) {
      if (data.closed || (k >= 0 && k < differences)) {
        sum += square[((k % differences) + differences) % differences];
        ++terms;
      }
    }
    level[i] = std::sqrt(sum / terms);
  }
  return level;
}

std::vector<double> monotone_slopes(std::span<const double> t, std::span<const double> y) {
  const int n = static_cast<int>(y.size());
  std::vector<double> slopes(n, 0.0);
  const auto step = [&](int i) { return t[i + 1] - t[i]; };
  const auto secant = [&](int i) { return (y[i + 1] - y[i]) / step(i); };
  for (int i = 1; i + 1 < n; ++i) {
    const double a = secant(i - 1), b = secant(i), ha = step(i - 1), hb = step(i);
    if (a * b > 0) {
      slopes[i] = 3 * (ha + hb) / ((2 * hb + ha) / a + (hb + 2 * ha) / b);
    }
  }
  const auto end_slope = [](double d0, double d1, double h0, double h1) {
    const double d = ((2 * h0 + h1) * d0 - h0 * d1) / (h0 + h1);
    if (d * d0 <= 0) {
      return 0.0;
    }
    return d0 * d1 <= 0 && std::abs(d) > 3 * std::abs(d0) ? 3 * d0 : d;
  };
  if (n == 2) {
    slopes[0] = slopes[1] = secant(0);
  } else {
    slopes[0] = end_slope(secant(0), secant(1), step(0), step(1));
    slopes[n - 1] = end_slope(secant(n - 2), secant(n - 3), step(n - 2), step(n - 3));
  }
  return slopes;
}

}  // namespace vasohex
