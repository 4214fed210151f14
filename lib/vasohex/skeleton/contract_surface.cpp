#include "vasohex/skeleton/contract_surface.h"

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <array>
#include <cmath>

#include "vasohex/core/error.h"

namespace vasohex {
namespace {

constexpr int kSteps = 10;
constexpr double kThin = 0.01;  ///< mean width that is left, in terms of the first: contracted
/// Triangles narrower than this count as if they were so wide, in terms of the longest edge squared: without negative
/// weights or a bound on the angles, but with this bound, the matrix keeps to be that of an energy, so definite.
constexpr double kLeastArea = 1e-4;

Eigen::SparseMatrix<double> laplacian(const SizedLumen& lumen, const std::vector<Vec3>& points) {
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(lumen.surface.triangles.size() * 12);
  for (const auto& t : lumen.surface.triangles) {
    const std::array<Vec3, 3> edges{points[t[2]] - points[t[1]], points[t[0]] - points[t[2]],
                                    points[t[1]] - points[t[0]]};
    const double longest = std::max({edges[0].squaredNorm(), edges[1].squaredNorm(), edges[2].squaredNorm()});
    const double twice_area = std::max({edges[0].cross(edges[1]).norm(), kLeastArea * longest, 1e-300});
    for (int k = 0; k < 3; ++k) {
      const int a = t[(k + 1) % 3], b = t[(k + 2) % 3];
      const double w = -edges[(k + 1) % 3].dot(edges[(k + 2) % 3]) / (2 * twice_area);
      entries.emplace_back(a, a, w);
      entries.emplace_back(b, b, w);
      entries.emplace_back(a, b, -w);
      entries.emplace_back(b, a, -w);
    }
  }
  const auto n = static_cast<Eigen::Index>(points.size());
  Eigen::SparseMatrix<double> result(n, n);
  result.setFromTriplets(entries.begin(), entries.end());
  return result;
}

/// Area around each point, of the lumen before contraction, over the square of its width.
Eigen::VectorXd masses(const SizedLumen& lumen) {
  Eigen::VectorXd result = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(lumen.surface.points.size()));
  for (const auto& t : lumen.surface.triangles) {
    const Vec3& p = lumen.surface.points[t[0]];
    const double area = (lumen.surface.points[t[1]] - p).cross(lumen.surface.points[t[2]] - p).norm() / 2;
    for (const int i : t) {
      result[i] += area / 3 / (lumen.widths[i] * lumen.widths[i]);
    }
  }
  const double least = 1e-6 * result.maxCoeff();
  result = result.cwiseMax(least);
  for (const int a : lumen.anchors) {
    result[a] = 1e8;
  }
  return result;
}

/// Area in terms of the local width squared.
double relative_area(const SizedLumen& lumen, const std::vector<Vec3>& points) {
  double sum = 0;
  for (const auto& t : lumen.surface.triangles) {
    const double width = lumen.widths[t[0]];
    sum += (points[t[1]] - points[t[0]]).cross(points[t[2]] - points[t[0]]).norm() / (2 * width * width);
  }
  return sum;
}

}  // namespace

std::vector<Vec3> contract_surface(const SizedLumen& lumen, const Run& run) {
  const Eigen::VectorXd mass = masses(lumen);
  const double first = relative_area(lumen, lumen.surface.points);
  std::vector<Vec3> points = lumen.surface.points;
  const auto n = static_cast<Eigen::Index>(points.size());
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver;
  for (int step = 0; step < kSteps; ++step) {
    run.progress("contract", static_cast<double>(step) / kSteps);
    Eigen::SparseMatrix<double> system = laplacian(lumen, points);
    system.diagonal() += mass;
    if (step == 0) {
      solver.analyzePattern(system);
    }
    solver.factorize(system);
    Eigen::MatrixXd x(n, 3);
    for (Eigen::Index i = 0; i < n; ++i) {
      x.row(i) = mass[i] * points[i].transpose();
    }
    x = solver.solve(x).eval();
    if (solver.info() != Eigen::Success || !x.allFinite()) {
      throw Error(ErrorCode::internal,
                  "contraction: the system of step " + std::to_string(step + 1) + " could not be solved");
    }
    for (Eigen::Index i = 0; i < n; ++i) {
      points[i] = x.row(i).transpose();
    }
    const double left = relative_area(lumen, points) / first;
    run.log("contract: step " + std::to_string(step + 1) + ", area " + std::to_string(left));
    if (left < kThin) {
      break;
    }
  }
  return points;
}

}  // namespace vasohex
