#include "vasohex/surface/convolved_axis.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "vasohex/core/equal_shares.h"
#include "vasohex/core/smooth_step.h"

namespace vasohex {
namespace {

/// Arc lengths from `from` to `to`, both included, about .45 local radii apart, and more than 2.
std::vector<double> sample_arc(const Branch& branch, double from, double to) {
  // distances in local radii, by the trapezoidal rule at steps fine against the samples of the branch
  const int fine = std::max(8, static_cast<int>(4 * branch.points.size()));
  std::vector<double> measure(fine + 1, 0);
  const auto at = [&](int k) { return from + (to - from) * k / fine; };
  double inverse = 1 / axis_point(branch, from).radius;
  for (int k = 1; k <= fine; ++k) {
    const double next = 1 / axis_point(branch, at(k)).radius;
    measure[k] = measure[k - 1] + 0.5 * (inverse + next) * (to - from) / fine;
    inverse = next;
  }
  // a hair less than a whole number: rounding must not add a sample
  const int pieces = std::max(2, static_cast<int>(std::ceil(measure.back() / 0.45 - 1e-6)));
  std::vector<double> arc{from};
  for (const auto& [index, part] : equal_shares(measure, pieces)) {
    const int k = static_cast<int>(index);
    arc.push_back(at(k) + part * (at(k + 1) - at(k)));
  }
  arc.push_back(to);
  return arc;
}

/// A direction across `tangent` that turns with the network: towards the first of its points that is well off the
/// line. Where there is none the network is a straight tube, round, and any direction does.
Vec3 across(const Network& network, const Branch& branch, const Vec3& origin, const Vec3& tangent) {
  const auto off = [&](const Vec3& point) {
    return Vec3((point - origin) - (point - origin).dot(tangent) * tangent);
  };
  for (const Vec3& point : branch.points) {
    if (off(point).norm() > 0.1 * (point - origin).norm()) {
      return off(point).normalized();
    }
  }
  for (const NetworkNode& node : network.nodes) {
    if (off(node.position).norm() > 0.1 * (node.position - origin).norm()) {
      return off(node.position).normalized();
    }
  }
  return tangent.unitOrthogonal();
}

/// Lets a segment fade beyond the plane of a free end.
void fade_beyond(const ConvolvedAxis& axis, bool at_last, ConeSegment& segment) {
  const AxisPoint& end = at_last ? axis.target.back() : axis.target.front();
  segment.end_normal = at_last ? end.tangent : Vec3(-end.tangent);
  segment.end_offset = segment.end_normal.dot(end.position);
  segment.end_fade = end_fade_radii * end.radius;
}

/// Prolongs an end at `sample` (the first or the last) by the reach of the kernel.
void prolong(const ConvolvedAxis& axis, bool at_last, std::vector<ConeSegment>& segments) {
  const std::size_t n = axis.arc.size(), sample = at_last ? n - 1 : 0;
  const AxisPoint& end = axis.target[sample];
  const std::size_t back = at_last ? n - 1 - std::min<std::size_t>(n - 1, 2) : std::min<std::size_t>(n - 1, 2);
  const double slope =
      std::clamp((end.radius - axis.target[back].radius) / std::abs(axis.arc[sample] - axis.arc[back]), -0.3, 0.3);
  const Vec3 outward = at_last ? end.tangent : Vec3(-end.tangent);
  const Vec3 start = end.position + axis.shift[sample];
  constexpr int parts = 4;
  const double step = kernel_reach * end.radius / parts;
  const int piece = at_last ? axis.piece.back() : axis.piece.front();
  for (int k = 0; k < parts; ++k) {
    segments.push_back(cone_segment(start + k * step * outward, axis.factor[sample] * (end.radius + slope * k * step),
                                    start + (k + 1) * step * outward,
                                    axis.factor[sample] * (end.radius + slope * (k + 1) * step), piece));
    fade_beyond(axis, at_last, segments.back());
  }
}

/// The same for the segment after sample k, if its kernel may reach a free end of its branch: by arc length, since a
/// coil's next turn does not end there. Of two ends that near, the nearer.
void fade_near_ends(const ConvolvedAxis& axis, const std::array<bool, 2>& free, std::size_t k, ConeSegment& segment) {
  const std::array<double, 2> distance{axis.arc[k], axis.arc.back() - axis.arc[k + 1]};
  const std::array<double, 2> radius{axis.target.front().radius, axis.target.back().radius};
  std::array<bool, 2> near{};
  for (int side = 0; side < 2; ++side) {
    near[side] = free[side] && distance[side] < 2 * kernel_reach * radius[side];
  }
  if (near[0] || near[1]) {
    fade_beyond(axis, near[1] && (!near[0] || distance[1] < distance[0]), segment);
  }
}

/// For the segment after sample k: at most what keeps its kernel positive.
Vec3 curvature(const ConvolvedAxis& axis, std::size_t k, const ConeSegment& segment) {
  const Vec3 turn = axis.target[k + 1].tangent - axis.target[k].tangent;
  const Vec3 bend =
      bend_correction / (axis.arc[k + 1] - axis.arc[k]) * (turn - turn.dot(segment.direction) * segment.direction);
  const double most =
      0.9 / (kernel_reach * std::max(segment.radius, segment.radius + segment.slope * segment.length));
  return bend.norm() > most ? Vec3(most * bend.normalized()) : bend;
}

}  // namespace

ConvolvedAxis make_axis(const Network& network, int index, const Blending& blending) {
  const Branch& branch = network.branches[index];
  ConvolvedAxis axis;
  std::vector<double> stops = blending.cuts[index];
  stops.insert(stops.begin(), 0.0);
  stops.push_back(branch.length());
  axis.arc.push_back(0);
  for (std::size_t k = 0; k + 1 < stops.size(); ++k) {
    const std::vector<double> arc = sample_arc(branch, stops[k], stops[k + 1]);
    axis.arc.insert(axis.arc.end(), arc.begin() + 1, arc.end());
    axis.piece.insert(axis.piece.end(), arc.size() - 1, blending.first_piece[index] + static_cast<int>(k));
  }
  std::vector<BlendBall> siblings;
  for (int piece = blending.first_piece[index];
       piece < blending.first_piece[index] + static_cast<int>(stops.size()) - 1; ++piece) {
    for (const int joint : blending.joints_of[piece]) {
      for (const SiblingBall& s : blending.siblings[joint]) {
        if (s.pieces[0] == piece || s.pieces[1] == piece) {
          siblings.push_back(s.ball);
        }
      }
    }
  }
  for (const double s : axis.arc) {
    axis.target.push_back(axis_point(branch, s));
    double freedom = 1;
    for (int side = 0; side < 2; ++side) {
      if (network.nodes[branch.nodes[side]].degree > 2) {
        const BlendBall& ball = blending.node_balls[branch.nodes[side]];
        const double r = 0.5 * (ball.outer - ball.inner);
        freedom *= smooth_step(((side == 0 ? s : branch.length() - s) - (ball.inner - 0.5 * r)) / r);
      }
    }
    for (const BlendBall& ball : siblings) {
      const double r = 0.5 * (ball.outer - ball.inner);
      freedom *= smooth_step(((axis.target.back().position - ball.center).norm() - (ball.inner - 0.5 * r)) / r);
    }
    axis.freedom.push_back(freedom);
    const Vec3& tangent = axis.target.back().tangent;
    if (axis.normal.empty()) {
      axis.normal.push_back(across(network, branch, axis.target[0].position, tangent));
    } else {
      const Vec3 turned = axis.normal.back() - axis.normal.back().dot(tangent) * tangent;
      axis.normal.push_back(turned.norm() > 0.1 ? Vec3(turned.normalized()) : Vec3(tangent.unitOrthogonal()));
    }
  }
  axis.shift.assign(axis.arc.size(), Vec3::Zero());
  axis.factor.assign(axis.arc.size(), 1.0);
  return axis;
}

std::vector<ConeSegment> make_segments(const Network& network, const std::vector<ConvolvedAxis>& axes) {
  std::vector<ConeSegment> segments;
  for (std::size_t b = 0; b < axes.size(); ++b) {
    const ConvolvedAxis& axis = axes[b];
    std::array<bool, 2> free{};
    for (int side = 0; side < 2; ++side) {
      free[side] = network.nodes[network.branches[b].nodes[side]].degree == 1;
    }
    const auto point = [&](std::size_t k) { return Vec3(axis.target[k].position + axis.shift[k]); };
    const auto radius = [&](std::size_t k) { return axis.factor[k] * axis.target[k].radius; };
    for (std::size_t k = 0; k + 1 < axis.arc.size(); ++k) {
      if (point(k) != point(k + 1)) {
        ConeSegment segment = cone_segment(point(k), radius(k), point(k + 1), radius(k + 1), axis.piece[k]);
        segment.curvature = curvature(axis, k, segment);
        fade_near_ends(axis, free, k, segment);
        segments.push_back(segment);
      }
    }
    for (int side = 0; side < 2; ++side) {
      if (free[side]) {
        prolong(axis, side == 1, segments);
      }
    }
  }
  return segments;
}

}  // namespace vasohex
