#include "vasohex/skeleton/sample_axis.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace vasohex {
namespace {

/// A short stretch of the spline inside one of its pieces.
struct Cell {
  std::size_t knot = 0;     ///< of its piece
  double begin = 0;         ///< parameter
  double length = 0;        ///< of the parameter interval
  double arc = 0;           ///< arc length at its begin
  double need = 0;          ///< intervals needed up to its begin
  double need_per_arc = 0;  ///< largest within
};

constexpr std::array<double, 3> kGaussPoints{0.11270166537925831, 0.5, 0.8872983346207417};
constexpr std::array<double, 3> kGaussWeights{5.0 / 18, 8.0 / 18, 5.0 / 18};

/// The next integer; whole numbers stay, whatever rounding did to them: turned copies get as many samples.
double ceil_of(double value) { return std::ceil(value * (1 - 1e-10)); }

double arc_length(const SpaceSpline& spline, std::size_t knot, double begin, double length) {
  double sum = 0;
  for (int g = 0; g < 3; ++g) {
    sum += kGaussWeights[g] * spline.at(knot, begin + kGaussPoints[g] * length).first.norm();
  }
  return sum * length;
}

double radius_at(const SpaceSpline& spline, const AxisPiece& piece, std::size_t knot, double t) {
  const std::size_t k = knot - piece.first;
  const double h = spline.t[knot + 1] - spline.t[knot];
  return hermite(piece.radii[k], piece.slopes[k], piece.radii[k + 1], piece.slopes[k + 1], h,
                 (t - spline.t[knot]) / h);
}

}  // namespace

Branch sample_axis(const SpaceSpline& spline, const AxisPiece& piece) {
  // Cells much finer than the samples
  std::vector<Cell> cells;
  double arc = 0, need = 0;
  for (std::size_t knot = piece.first; knot < piece.last; ++knot) {
    const std::size_t k = knot - piece.first;
    const double h = spline.t[knot + 1] - spline.t[knot];
    const double r = std::min(piece.radii[k], piece.radii[k + 1]);
    const double bent =
        std::max(curvature(spline.at(knot, spline.t[knot])), curvature(spline.at(knot, spline.t[knot + 1])));
    const int count =
        static_cast<int>(std::clamp(ceil_of(h * std::max(10 / r, 20 * std::min(bent, 10 / r))), 2.0, 1e4));
    for (int c = 0; c < count; ++c) {
      Cell cell{knot, spline.t[knot] + h * c / count, h / count, arc, need, 0};
      for (int g = 0; g < 5; ++g) {  // both ends and the Gauss points
        const double u = g == 0 ? 0 : g == 4 ? 1 : kGaussPoints[g - 1];
        const double t = cell.begin + u * cell.length;
        const SpaceSpline::Value value = spline.at(knot, t);
        const double radius = radius_at(spline, piece, knot, t), kappa = curvature(value);
        const double per_arc = std::max(2 / radius, 4 * std::min(kappa, 10 / radius));
        cell.need_per_arc = std::max(cell.need_per_arc, per_arc);
        if (g % 4 != 0) {
          const double ds = kGaussWeights[g - 1] * value.first.norm() * cell.length;
          arc += ds;
          need += ds * per_arc;
        }
      }
      cells.push_back(cell);
    }
  }

  // Equal parts of the need; a few more where the need changes so fast that its mean over an interval is not enough
  std::vector<double> parameters;
  std::vector<std::size_t> cell_of;
  std::vector<double> arcs;
  for (int intervals = std::max(4, static_cast<int>(ceil_of(need)));; intervals += 1 + intervals / 20) {
    parameters.assign(1, cells.front().begin);
    cell_of.assign(1, 0);
    arcs.assign(1, 0.0);
    std::size_t c = 0;
    for (int i = 1; i < intervals; ++i) {
      const double target = need * i / intervals;
      while (c + 1 < cells.size() && cells[c + 1].need <= target) {
        ++c;
      }
      const double end = c + 1 < cells.size() ? cells[c + 1].need : need;
      const double t = cells[c].begin + cells[c].length * (target - cells[c].need) / (end - cells[c].need);
      parameters.push_back(t);
      cell_of.push_back(c);
      arcs.push_back(cells[c].arc + arc_length(spline, cells[c].knot, cells[c].begin, t - cells[c].begin));
    }
    parameters.push_back(spline.t[piece.last]);
    cell_of.push_back(cells.size() - 1);
    arcs.push_back(arc);
    bool enough = true;
    for (int i = 0; i < intervals && enough; ++i) {
      for (std::size_t k = cell_of[i]; k <= cell_of[i + 1] && enough; ++k) {
        enough = (arcs[i + 1] - arcs[i]) * cells[k].need_per_arc <= 1 + 1e-9;
      }
    }
    if (enough || intervals > 4 * need + 100) {
      break;
    }
  }

  Branch branch;
  branch.arc = std::move(arcs);
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    const std::size_t knot = cells[cell_of[i]].knot;
    const SpaceSpline::Value value = spline.at(knot, parameters[i]);
    branch.points.push_back(value.position);
    branch.tangents.push_back(value.first.normalized());
    branch.radii.push_back(radius_at(spline, piece, knot, parameters[i]));
  }
  branch.points.front() = spline.points[piece.first];
  branch.points.back() = spline.points[piece.last];
  return branch;
}

}  // namespace vasohex
