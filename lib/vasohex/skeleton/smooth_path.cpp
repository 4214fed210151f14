#include "vasohex/skeleton/smooth_path.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "vasohex/skeleton/limit_bends.h"

namespace vasohex {
namespace {

// Noise of standard deviation s at spacing h leaves, after smoothing over a length l, curvature noise of variance
// c s^2 h / l^5 and slope noise of variance c s^2 h / l^3, c = 1 / (8 sqrt 2): l follows from what may be left.
constexpr double kNoise = 0.088388;
constexpr double kCurvatureNoise = 0.05;  // times 1 / radius
constexpr double kSlopeNoise = 0.02;      // of the radius per length
constexpr double kLongestAxis = 1.0;      // smoothing lengths at most, in radii
constexpr double kLongestRadius = 2.0;
constexpr double kMove = 0.2;          // largest displacement, in radii
constexpr double kRadiusChange = 0.2;  // largest relative change
constexpr double kSlope = 0.75;        // steepest change of the radius per length
constexpr double kLongEdge = 10.0;     // in radii: such an edge is meant to be straight
constexpr double kOffEdge = 0.25;      // largest distance from a long edge that needs no help, in radii
constexpr double kCornerBend = 2.2;    // bend radius aimed at between straight edges, in radii
constexpr double kKnotSpacing = 2.0;   // of knots along straight edges, in radii

/// 1 for spacings below 0.75 radii, falling to 0 at 1.25: sparser points are meant, not sampled.
double dense(double spacing_over_radius) {
  const double u = std::clamp((1.25 - spacing_over_radius) / 0.5, 0.0, 1.0);
  return u * u * (3 - 2 * u);
}

/// Lengths from each knot to the one before and after; infinite beyond the ends of an open path.
struct Gaps {
  double before = std::numeric_limits<double>::infinity();
  double after = std::numeric_limits<double>::infinity();
  double mean() const { return std::isinf(before) ? after : std::isinf(after) ? before : (before + after) / 2; }
};

Gaps gaps(const std::vector<double>& t, int n, bool closed, int i) {
  Gaps g;
  if (i > 0 || closed) {
    g.before = i > 0 ? t[i] - t[i - 1] : t[n] - t[n - 1];
  }
  if (i < n - 1 || closed) {
    g.after = t[i + 1] - t[i];
  }
  return g;
}

/// Solves with ever less compliance where a value moves more than allowed. excess(values, i): move / allowed move.
template <class Excess>
Smoothed smooth_within(const KnotData& data, std::vector<double> compliance, const Excess& excess) {
  const int n = static_cast<int>(compliance.size());
  constexpr int rounds = 30;
  for (int round = 0;; ++round) {
    Smoothed fit = smooth(data, compliance);
    std::vector<double> factor(n, 1.0);
    bool within = true;
    for (int i = 0; i < n; ++i) {
      if (const double e = excess(fit.values, i); e > 1) {
        within = false;
        for (int k = -2; k <= 2; ++k) {
          const int j = data.closed ? ((i + k) % n + n) % n : std::clamp(i + k, 0, n - 1);
          factor[j] = std::min(factor[j], round + 2 < rounds ? 0.7 / e : 0.0);
        }
      }
    }
    if (within) {
      return fit;
    }
    if (round == rounds) {
      std::fill(factor.begin(), factor.end(), 0.0);
    }
    for (int i = 0; i < n; ++i) {
      compliance[i] *= factor[i];
    }
  }
}

}  // namespace

std::vector<double> polyline_length(const std::vector<Vec3>& points, bool closed) {
  std::vector<double> t{0};
  for (std::size_t i = 1; i < points.size() + (closed ? 1 : 0); ++i) {
    t.push_back(t.back() + (points[i % points.size()] - points[i - 1]).norm());
  }
  return t;
}

std::vector<double> smooth_radii(const std::vector<double>& t, const std::vector<double>& radii, bool closed) {
  const int n = static_cast<int>(radii.size());
  KnotData data{t, Eigen::MatrixXd(n, 1), closed};
  for (int i = 0; i < n; ++i) {
    data.values(i, 0) = std::log(radii[i]);  // relative changes count, and every result is positive
  }
  const std::vector<double> noise = noise_level(data);
  std::vector<double> compliance(n);
  for (int i = 0; i < n; ++i) {
    const Gaps g = gaps(t, n, closed, i);
    const double r = radii[i], h = g.mean();
    const double length =
        std::min(std::cbrt(kNoise * std::pow(noise[i] * r / kSlopeNoise, 2) * h), kLongestRadius * r);
    compliance[i] = std::pow(length, 4) / h * dense(std::min(g.before, g.after) / r);
  }
  const Smoothed fit = smooth_within(data, compliance, [&](const Eigen::MatrixXd& values, int i) {
    return std::abs(values(i, 0) - data.values(i, 0)) / std::log1p(kRadiusChange);
  });
  std::vector<double> result(n);
  for (int i = 0; i < n; ++i) {
    result[i] = std::exp(fit.values(i, 0));
  }
  return result;
}

std::vector<double> limit_slope(const std::vector<double>& t, std::vector<double> radii, bool closed) {
  const int n = static_cast<int>(radii.size());
  const int steps = closed ? 2 * n : n;  // twice around a closed path reaches every knot from every other
  for (int k = 1; k < steps; ++k) {
    const int i = k % n, before = (k - 1) % n;
    radii[i] = std::min(radii[i], radii[before] + kSlope * gaps(t, n, closed, i).before);
  }
  for (int k = steps - 2; k >= 0; --k) {
    const int i = k % n, after = (k + 1) % n;
    radii[i] = std::min(radii[i], radii[after] + kSlope * gaps(t, n, closed, i).after);
  }
  return radii;
}

SpaceSpline smooth_points(const PathPoints& path, const std::vector<double>& radii) {
  const int n = static_cast<int>(path.points.size());
  KnotData data{polyline_length(path.points, path.closed), Eigen::MatrixXd(n, 3), path.closed};
  for (int i = 0; i < n; ++i) {
    data.values.row(i) = path.points[i].transpose();
  }
  const auto moved_too_far = [&](const Eigen::MatrixXd& values, int i) {
    return (values.row(i) - data.values.row(i)).norm() / (kMove * radii[i]);
  };
  Smoothed fit;
  std::vector<double> compliance(n, 0.0);
  // noise makes the polyline longer than the curve: the second pass measures along the first one's result
  for (int pass = 0; pass < 2; ++pass) {
    const std::vector<double> noise = noise_level(data);
    for (int i = 0; i < n; ++i) {
      if (!path.fixed[i]) {
        const Gaps g = gaps(data.t, n, path.closed, i);
        const double r = radii[i], h = g.mean();
        const double length =
            std::min(std::pow(kNoise * std::pow(noise[i] * r / kCurvatureNoise, 2) * h, 0.2), kLongestAxis * r);
        compliance[i] = std::pow(length, 4) / h * dense(std::min(g.before, g.after) / r);
      }
    }
    fit = smooth_within(data, compliance, moved_too_far);
    if (pass == 0) {
      std::vector<Vec3> smoothed(n);
      for (int i = 0; i < n; ++i) {
        smoothed[i] = fit.values.row(i).transpose();
      }
      const std::vector<double> before = data.t, after = polyline_length(smoothed, path.closed);
      for (std::size_t i = 1; i < data.t.size(); ++i) {
        // knots must stay apart
        data.t[i] = data.t[i - 1] + std::max(after[i] - after[i - 1], 1e-2 * (before[i] - before[i - 1]));
      }
    }
  }
  SpaceSpline spline = spline_through(data, fit);
  for (std::size_t i = 0; i < spline.points.size(); ++i) {
    if (path.fixed[i % n]) {
      spline.points[i] = path.points[i % n];  // to the last bit
    }
  }
  return spline;
}

PathCurve curve_near_all(const PathPoints& path, const std::vector<double>& radii) {
  const std::size_t n = path.points.size(), edges = path.closed ? n : n - 1;
  std::vector<Vec3> direction(edges);
  std::vector<double> length(edges);
  for (std::size_t e = 0; e < edges; ++e) {
    const Vec3 edge = path.points[(e + 1) % n] - path.points[e];
    length[e] = edge.norm();
    direction[e] = edge / length[e];
  }
  // With a knot at distance a from a corner of angle w the spline bends there with a radius of about
  // a cos^2(w / 2) / (2 sqrt 3 sin(w / 2)), and swings out by .03 a^2 over that; beyond 60 degrees less is asked for
  const auto first_knot = [&](std::size_t e, std::size_t end) {
    const std::size_t point = e + end;
    double half_sine = 0;
    if (path.closed || (point > 0 && point < n - 1)) {
      half_sine = (direction[(point + edges - 1) % edges] - direction[point % edges]).norm() / 2;
    }
    const double half_cosine = std::sqrt(std::max(0.5, 1 - half_sine * half_sine));
    return std::max(kKnotSpacing, 2 * std::numbers::sqrt3 * kCornerBend * half_sine / half_cosine) * radii[point % n];
  };
  // Places of the knots within an edge, as parts of its length
  const auto places = [&](std::size_t e) {
    double from = first_knot(e, 0), to = length[e] - first_knot(e, 1);
    if (to - from < kKnotSpacing / 2 * std::max(radii[e], radii[(e + 1) % n])) {
      const double shrink = length[e] / (from + length[e] - to);
      return std::vector<double>{from * shrink / length[e]};
    }
    // close to the corners as dense as there, growing no more than the radius: swings die out within few knots
    const double r0 = radii[e], r1 = radii[(e + 1) % n];
    const double mean = std::abs(r1 / r0 - 1) < 1e-3 ? r0 : (r1 - r0) / std::log(r1 / r0);
    const int count = std::max(1, static_cast<int>(std::floor((to - from) / (kKnotSpacing * mean) + 0.5 + 1e-9)));
    std::vector<double> result;
    for (int k = 0; k <= count; ++k) {
      const double u = static_cast<double>(k) / count;
      const double part = std::abs(r1 / r0 - 1) < 1e-3 ? u : (std::pow(r1 / r0, u) - 1) / (r1 / r0 - 1);
      result.push_back((from + part * (to - from)) / length[e]);
    }
    return result;
  };

  PathCurve curve;
  std::vector<std::size_t> knots;  // of the points
  std::vector<bool> straight(edges, false);
  for (;;) {
    PathPoints all;
    all.closed = path.closed;
    std::vector<double> scale;
    knots.clear();
    for (std::size_t i = 0; i < n; ++i) {
      knots.push_back(all.points.size());
      all.points.push_back(path.points[i]);
      all.fixed.push_back(path.fixed[i]);
      scale.push_back(radii[i]);
      if (i < edges && straight[i]) {
        for (const double u : places(i)) {
          all.points.push_back((1 - u) * path.points[i] + u * path.points[(i + 1) % n]);
          all.fixed.push_back(false);
          scale.push_back((1 - u) * radii[i] + u * radii[(i + 1) % n]);
        }
      }
    }
    if (path.closed) {
      knots.push_back(all.points.size());
    }
    curve.spline = smooth_points(all, scale);
    curve.off_edge = 0;
    bool settled = true;
    for (std::size_t e = 0; e < edges; ++e) {
      const double r0 = radii[e], r1 = radii[(e + 1) % n];
      if (length[e] <= kLongEdge * (r0 + r1) / 2) {
        continue;
      }
      for (std::size_t k = knots[e]; k < knots[e + 1]; ++k) {
        constexpr int steps = 16;
        for (int i = 0; i < steps; ++i) {
          const double step = (curve.spline.t[k + 1] - curve.spline.t[k]) / steps;
          const Vec3 p = curve.spline.at(k, curve.spline.t[k] + i * step).position - path.points[e];
          const double along = std::clamp(p.dot(direction[e]) / length[e], 0.0, 1.0);
          const double off = (p - along * length[e] * direction[e]).norm() / ((1 - along) * r0 + along * r1);
          if (straight[e] && off > curve.off_edge) {
            curve.off_edge = off;
            curve.off_edge_at = (along < 0.5 ? e : e + 1) % n;
          } else if (!straight[e] && off > kOffEdge) {
            straight[e] = true;
            ++curve.straightened;
            settled = false;
          }
        }
      }
    }
    if (!settled) {
      continue;
    }
    for (std::size_t i = 0; i < n; ++i) {
      curve.moved.push_back((curve.spline.points[knots[i]] - path.points[i]).norm() / radii[i]);
    }
    if (path.closed) {
      scale.push_back(scale.front());
      all.fixed.push_back(all.fixed.front());
    }
    LimitedBends limited = limit_bends(curve.spline, scale, all.fixed, path.closed);
    if (!(limited.t.back() > limited.t.front())) {
      // a small loop from a point back to it: the string of beads shrank to nothing
      for (const std::size_t k : knots) {
        curve.t.push_back(curve.spline.t[k]);
      }
      return curve;
    }
    curve.spline = std::move(limited.spline);
    for (const std::size_t k : knots) {
      curve.t.push_back(limited.t[k]);
    }
    for (const LimitedBends::Bend& bend : limited.rounded) {
      const auto after = std::upper_bound(knots.begin(), knots.end(), bend.knot);
      curve.bends.push_back({static_cast<std::size_t>(after - knots.begin() - 1) % n, bend.moved});
    }
    return curve;
  }
}

}  // namespace vasohex
