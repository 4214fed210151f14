#include "vasohex/surface/jet.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>

namespace vasohex {

Jet fit_jet(const Vec3& origin, const Vec3& normal, double size, const std::vector<Vec3>& points) {
  Jet jet;
  jet.origin = origin;
  jet.axes.row(2) = normal;
  jet.axes.row(0) = normal.unitOrthogonal();
  jet.axes.row(1) = normal.cross(Vec3(jet.axes.row(0)));
  const auto n = static_cast<Eigen::Index>(points.size());
  Eigen::MatrixXd local(n, 3);
  for (Eigen::Index i = 0; i < n; ++i) {
    local.row(i) = (jet.axes * (points[i] - origin)).transpose() / size;
  }
  for (int degree = 3; degree >= 1; --degree) {
    const Eigen::Index terms = (degree + 1) * (degree + 2) / 2;
    if (n < terms + terms / 2) {
      continue;
    }
    Eigen::MatrixXd a(n, terms);
    Eigen::VectorXd b(n);
    for (Eigen::Index i = 0; i < n; ++i) {
      const double u = local(i, 0), v = local(i, 1);
      const std::array<double, 10> terms_at{1, u, v, u * u, u * v, v * v, u * u * u, u * u * v, u * v * v, v * v * v};
      const double weight = 1 / (1 + local.row(i).squaredNorm());
      for (Eigen::Index k = 0; k < terms; ++k) {
        a(i, k) = weight * terms_at[k];
      }
      b[i] = weight * local(i, 2);
    }
    Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(a);
    qr.setThreshold(1e-3);
    if (qr.rank() < terms) {
      continue;
    }
    const Eigen::VectorXd c = qr.solve(b);
    Jet trial = jet;
    trial.degree = degree;
    const std::array<double, 10> scale{size,
                                       1,
                                       1,
                                       1 / size,
                                       1 / size,
                                       1 / size,
                                       1 / (size * size),
                                       1 / (size * size),
                                       1 / (size * size),
                                       1 / (size * size)};
    for (Eigen::Index k = 0; k < terms; ++k) {
      trial.c[k] = c[k] * scale[k];
    }
    bool good = std::abs(trial.c[0]) < 0.2 * size;
    for (Eigen::Index i = 0; i < n && good; ++i) {
      if (local.row(i).norm() < 1.6) {
        Vec3 gradient;
        const double off = trial.value(points[i], gradient);
        good = gradient.norm() < 2 && std::abs(off) < 0.2 * size;
      }
    }
    if (good) {
      return trial;
    }
  }
  return jet;
}

}  // namespace vasohex
