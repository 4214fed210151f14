#include "vasohex/surface/convolution.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "vasohex/core/smooth_step.h"
#include "vasohex/core/parallel.h"
#include "vasohex/surface/blending.h"
#include "vasohex/surface/cone_kernel.h"
#include "vasohex/surface/cone_tree.h"
#include "vasohex/surface/project.h"

namespace vasohex {
namespace {

/// What every piece that reaches a point contributes there; in place for the usual few pieces.
class PieceSums {
 public:
  struct Sum : ConeSum {
    int piece = 0;
  };

  /// That of `piece`, zero if new.
  Sum& of(int piece) {
    for (std::size_t i = count_; i-- > 0;) {
      if (data()[i].piece == piece) {
        return data()[i];
      }
    }
    if (count_ == few_.size() && many_.empty()) {
      many_.assign(few_.begin(), few_.end());
    }
    if (count_ >= few_.size()) {
      many_.emplace_back();
    }
    Sum& sum = data()[count_++];
    sum.piece = piece;
    return sum;
  }
  std::span<const Sum> all() const { return {many_.empty() ? few_.data() : many_.data(), count_}; }

 private:
  Sum* data() { return many_.empty() ? few_.data() : many_.data(); }

  std::array<Sum, 8> few_;
  std::vector<Sum> many_;
  std::size_t count_ = 0;
};

/// value and gradient of the level function for the field F > 0.
template <bool with_gradient>
double level(const ConeSum& field, Vec3* gradient) {
  // On a straight tube F falls as (1 - (d / S r)^2)^(k + 1/2): undone, the square of d / r.
  constexpr double reach2 = kernel_reach * kernel_reach;
  constexpr double turn = 0.1;  // below it, on the axis and inside junctions, the square root has no derivatives
  const double y = std::pow(field.value, 1 / kernel_power);
  const double q = reach2 - (reach2 - 1) * y;
  const double root = std::sqrt(std::max(q, turn));
  const double below = std::min(q - turn, 0.0) / (2 * turn);  // Taylor to second order: C2
  if constexpr (with_gradient) {
    const double slope = (1 - below) / (2 * root);
    *gradient = (-slope * (reach2 - 1) * y / (kernel_power * field.value)) * field.gradient;
  }
  return root * (1 + below - 0.5 * below * below) - 1;
}

/// A field so small that its level is that at the reach to all digits, and its gradient may not be a number.
constexpr double no_field = 1e-100;

class ConvolutionSurface final : public ImplicitSurface {
 public:
  ConvolutionSurface(std::vector<ConeSegment> segments, std::shared_ptr<const Blending> blending)
      : segments_(std::move(segments)), tree_(segments_), blending_(std::move(blending)) {
    std::stable_sort(segments_.begin(), segments_.end(),
                     [](const ConeSegment& a, const ConeSegment& b) { return a.piece < b.piece; });
    std::size_t first = 0;
    for (int piece = 0; piece <= static_cast<int>(blending_->arcs.size()); ++piece) {
      while (first < segments_.size() && segments_[first].piece < piece) {
        ++first;
      }
      first_of_piece_.push_back(static_cast<std::ptrdiff_t>(first));
    }
  }

  double value(const Vec3& x) const override { return evaluate<false>(x, nullptr); }
  double value(const Vec3& x, Vec3& gradient) const override { return evaluate<true>(x, &gradient); }
  bool is_round() const override { return true; }
  double radius(const Vec3& x) const override {
    double field = 0, weighted = 0;
    tree_.for_each_near(x, [&](const ConeSegment& segment) {
      ConeSum sum;
      if (add_cone<false>(segment, x, sum)) {
        field += sum.value;
        weighted += sum.weighted_radius;
      }
    });
    return field > no_field ? weighted / field : tree_.nearest(x).radius;
  }

  std::shared_ptr<const ImplicitSurface> part(const std::vector<Stretch>& stretches) const override {
    std::vector<ConeSegment> segments;
    for (const int piece : blending_->pieces_around(stretches)) {
      segments.insert(segments.end(), segments_.begin() + first_of_piece_[piece],
                      segments_.begin() + first_of_piece_[piece + 1]);
    }
    return std::make_shared<ConvolutionSurface>(std::move(segments), blending_);
  }

  /// The level of `piece` and what blends with it, as if there were no other vessels. Beyond its reach the level
  /// there and no gradient.
  double value_of_piece(int piece, const Vec3& x, Vec3& gradient) const {
    const PieceSums sums = gather<true>(x);
    ConeSum field;
    for (const PieceSums::Sum& sum : sums.all()) {
      if (sum.piece == piece) {
        field = sum;
      }
    }
    const ConeSum own = field;
    for (const int joint : blending_->joints_of[piece]) {
      take_greater(blended<true>(sums.all(), joint, own, x), field);
    }
    if (!(field.value > no_field)) {
      gradient.setZero();
      return kernel_reach - 1;
    }
    return level<true>(field, &gradient);
  }

 private:
  template <bool with_gradient>
  PieceSums gather(const Vec3& x) const {
    PieceSums sums;
    tree_.for_each_near(x, [&](const ConeSegment& segment) {
      ConeSum sum;
      if (add_cone<with_gradient>(segment, x, sum)) {
        PieceSums::Sum& of_piece = sums.of(segment.piece);
        of_piece.value += sum.value;
        of_piece.gradient += sum.gradient;
      }
    });
    return sums;
  }

  bool is_greatest_of(std::span<const PieceSums::Sum> sums, std::size_t i, int joint) const {
    for (std::size_t k = 0; k < sums.size(); ++k) {
      const std::vector<int>& joints = blending_->joints_of[sums[k].piece];
      if ((sums[k].value > sums[i].value || (sums[k].value == sums[i].value && k < i)) &&
          std::find(joints.begin(), joints.end(), joint) != joints.end()) {
        return false;
      }
    }
    return true;
  }

  static void take_greater(const ConeSum& candidate, ConeSum& field) {
    if (candidate.value > field.value) {
      field = candidate;
    }
  }

  /// Takes from `others` the lesser of two pieces that meet at no node, where no third piece of the joint is and they
  /// have parted.
  void separate_siblings(std::span<const PieceSums::Sum> sums, int joint, const ConeSum& greatest, const Vec3& x,
                         ConeSum& others) const {
    constexpr double present = 0.2;  // a field that counts as there; 1 is the wall
    if (blending_->joints[joint].size() < 2) {
      return;
    }
    const ConeSum all{greatest.value + others.value, 0, greatest.gradient + others.gradient};
    const auto in_joint = [&](const PieceSums::Sum& sum) {
      const std::vector<int>& joints = blending_->joints_of[sum.piece];
      return std::find(joints.begin(), joints.end(), joint) != joints.end();
    };
    for (std::size_t i = 0; i < sums.size(); ++i) {
      for (std::size_t k = 0; k < i; ++k) {
        if (!in_joint(sums[i]) || !in_joint(sums[k]) ||
            !blending_->are_siblings(joint, sums[i].piece, sums[k].piece)) {
          continue;
        }
        const ConeSum& lesser = sums[i].value < sums[k].value ? sums[i] : sums[k];
        const double t = std::max(0.0, all.value - sums[i].value - sums[k].value) / present;
        if (t >= 1) {
          continue;
        }
        const double absent = 1 - smooth_step(t);
        const double slope = -30 * t * t * (1 - t) * (1 - t) / present;
        const BlendWeight together = blending_->sibling_weight(joint, sums[i].piece, sums[k].piece, x);
        const double apart = 1 - together.value;
        others.value -= absent * apart * lesser.value;
        others.gradient -= absent * apart * lesser.gradient - absent * lesser.value * together.gradient +
                           slope * apart * lesser.value * (all.gradient - sums[i].gradient - sums[k].gradient);
      }
    }
  }

  /// (1 - w) `greatest` + w (sum of the pieces of a joint).
  template <bool with_gradient>
  ConeSum blended(std::span<const PieceSums::Sum> sums, int joint, const ConeSum& greatest, const Vec3& x) const {
    ConeSum others;  // sum - greatest
    others.value = -greatest.value;
    others.gradient = -greatest.gradient;
    for (const PieceSums::Sum& sum : sums) {
      const std::vector<int>& joints = blending_->joints_of[sum.piece];
      if (std::find(joints.begin(), joints.end(), joint) != joints.end()) {
        others.value += sum.value;
        others.gradient += sum.gradient;
      }
    }
    separate_siblings(sums, joint, greatest, x, others);
    const BlendWeight weight = blending_->weight(joint, x);
    ConeSum field = greatest;
    field.value += weight.value * others.value;
    if constexpr (with_gradient) {
      field.gradient += weight.value * others.gradient + others.value * weight.gradient;
    }
    return field;
  }

  template <bool with_gradient>
  double evaluate(const Vec3& x, Vec3* gradient) const {
    const PieceSums sums = gather<with_gradient>(x);
    const std::span<const PieceSums::Sum> all = sums.all();
    ConeSum field;
    for (const PieceSums::Sum& sum : all) {
      take_greater(sum, field);
    }
    // The greatest of a joint that does not hold the greatest of all may still win by the sum: try each joint, with
    // the greatest of its own.
    for (std::size_t i = 0; all.size() > 1 && i < all.size(); ++i) {
      for (const int joint : blending_->joints_of[all[i].piece]) {
        if (is_greatest_of(all, i, joint)) {
          take_greater(blended<with_gradient>(all, joint, all[i], x), field);
        }
      }
    }
    if (field.value > no_field) {
      return level<with_gradient>(field, gradient);
    }
    const ConeNearest nearest = tree_.nearest(x);
    if constexpr (with_gradient) {
      *gradient = nearest.gradient;
    }
    return nearest.ratio - 1;
  }

  std::vector<ConeSegment> segments_;           ///< ascending by piece
  std::vector<std::ptrdiff_t> first_of_piece_;  ///< [pieces + 1]
  ConeTree tree_;
  std::shared_ptr<const Blending> blending_;
};

/// A branch, resampled at about half a radius, and what calibration made of it.
struct Axis {
  std::vector<double> arc;
  std::vector<AxisPoint> target;  ///< the vessel asked for
  std::vector<int> piece;         ///< [samples - 1], of the segment that follows
  std::vector<double> freedom;    ///< 1: may be corrected, 0: near a junction
  std::vector<Vec3> normal;       ///< unit, across the axis: the direction of the first ray
  std::vector<Vec3> shift;        ///< of the centre that is convolved from the target
  std::vector<double> factor;     ///< of the radius that is convolved to the target
};

void check(const Network& network) {
  if (network.branches.empty()) {
    throw Error(ErrorCode::bad_input, "a network without branches has no surface");
  }
  for (std::size_t b = 0; b < network.branches.size(); ++b) {
    const Branch& branch = network.branches[b];
    const auto fail = [b](const std::string& what) {
      throw Error(ErrorCode::bad_input, "branch " + std::to_string(b) + ": " + what);
    };
    const std::size_t n = branch.points.size();
    if (n < 2 || branch.radii.size() != n || branch.tangents.size() != n || branch.arc.size() != n) {
      fail("needs at least 2 points, and a radius, a tangent and an arc length for each");
    }
    for (const int node : branch.nodes) {
      if (node < 0 || node >= static_cast<int>(network.nodes.size())) {
        fail("node " + std::to_string(node) + " does not exist");
      }
    }
    for (std::size_t k = 0; k < n; ++k) {
      if (!(branch.radii[k] > 0 && std::isfinite(branch.radii[k])) || !branch.points[k].allFinite()) {
        fail("point " + std::to_string(k) + " has radius " + std::to_string(branch.radii[k]) +
             ", must be finite and > 0, at a finite place");
      }
      if (k > 0 && !(branch.arc[k] > branch.arc[k - 1])) {
        fail("arc length does not increase at point " + std::to_string(k));
      }
    }
  }
}

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
  int k = 0;
  for (int i = 1; i < pieces; ++i) {
    const double target = measure.back() * i / pieces;
    while (measure[k + 1] < target) {
      ++k;
    }
    const double part = (target - measure[k]) / (measure[k + 1] - measure[k]);
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

Axis make_axis(const Network& network, int index, const Blending& blending) {
  const Branch& branch = network.branches[index];
  Axis axis;
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
  for (int piece = blending.first_piece[index]; piece < blending.first_piece[index] + static_cast<int>(stops.size()) - 1;
       ++piece) {
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

/// Lets a segment fade beyond the plane of a free end.
void fade_beyond(const Axis& axis, bool at_last, ConeSegment& segment) {
  const AxisPoint& end = at_last ? axis.target.back() : axis.target.front();
  segment.end_normal = at_last ? end.tangent : Vec3(-end.tangent);
  segment.end_offset = segment.end_normal.dot(end.position);
  segment.end_fade = end_fade_radii * end.radius;
}

/// Prolongs an end at `sample` (the first or the last) by the reach of the kernel.
void prolong(const Axis& axis, bool at_last, std::vector<ConeSegment>& segments) {
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
void fade_near_ends(const Axis& axis, const std::array<bool, 2>& free, std::size_t k, ConeSegment& segment) {
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
Vec3 curvature(const Axis& axis, std::size_t k, const ConeSegment& segment) {
  const Vec3 turn = axis.target[k + 1].tangent - axis.target[k].tangent;
  const Vec3 bend =
      bend_correction / (axis.arc[k + 1] - axis.arc[k]) * (turn - turn.dot(segment.direction) * segment.direction);
  const double most =
      0.9 / (kernel_reach * std::max(segment.radius, segment.radius + segment.slope * segment.length));
  return bend.norm() > most ? Vec3(most * bend.normalized()) : bend;
}

std::vector<ConeSegment> make_segments(const Network& network, const std::vector<Axis>& axes) {
  std::vector<ConeSegment> segments;
  for (std::size_t b = 0; b < axes.size(); ++b) {
    const Axis& axis = axes[b];
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

/// What the rays in the normal plane of a sample met: distances from the target's axis, in target radii.
struct Section {
  double mean = 1;
  Vec3 shift = Vec3::Zero();
};

/// The surface as one piece sees it, so that rays pass through other vessels.
class PieceView final : public ImplicitSurface {
 public:
  PieceView(const ConvolutionSurface& surface, int piece) : surface_(surface), piece_(piece) {}
  double value(const Vec3& x) const override {
    Vec3 gradient;
    return value(x, gradient);
  }
  double value(const Vec3& x, Vec3& gradient) const override { return surface_.value_of_piece(piece_, x, gradient); }
  bool is_round() const override { return true; }
  double radius(const Vec3& x) const override { return surface_.radius(x); }

 private:
  const ConvolutionSurface& surface_;
  int piece_;
};

/// Distance / radius along a unit direction across the axis: Newton from the radius asked for, as all but wild shapes
/// are near it; else the search that cannot fail but by there being nothing.
std::optional<double> ray_length(const PieceView& surface, const AxisPoint& from, const Vec3& direction) {
  double t = from.radius;
  for (int iteration = 0; iteration < 4; ++iteration) {
    Vec3 gradient;
    const double value = surface.value(from.position + t * direction, gradient);
    const double step = -value / gradient.dot(direction);
    if (!(std::abs(step) < 0.25 * from.radius && gradient.dot(direction) > 0)) {
      break;
    }
    t += step;
    if (std::abs(step) < 1e-3 * from.radius) {  // the next would be of its square
      return t / from.radius;
    }
  }
  const std::optional<double> hit = shoot(surface, from.position, direction, from.radius, 2 * from.radius);
  return hit ? std::optional(*hit / from.radius) : std::nullopt;
}

std::optional<Section> measure(const PieceView& surface, const AxisPoint& target, const Vec3& normal) {
  constexpr int rays = 8;
  const Vec3 binormal = target.tangent.cross(normal);
  Section section;
  section.mean = 0;
  for (int k = 0; k < rays; ++k) {
    const double angle = 2 * std::numbers::pi * k / rays;
    const Vec3 direction = std::cos(angle) * normal + std::sin(angle) * binormal;
    const std::optional<double> length = ray_length(surface, target, direction);
    if (!length) {
      return std::nullopt;
    }
    section.mean += *length / rays;
    section.shift += (2 * *length / rays) * direction;
  }
  return section;
}

/// One round of corrections.
void calibrate(const Network& network, const ConvolutionSurface& surface, const Run& run, std::vector<Axis>& axes) {
  std::vector<std::pair<int, int>> samples;
  for (std::size_t b = 0; b < axes.size(); ++b) {
    for (std::size_t k = 0; k < axes[b].arc.size(); ++k) {
      if (axes[b].freedom[k] > 0) {
        samples.emplace_back(b, k);
      }
    }
  }
  parallel_for(run, samples.size(), 16, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const auto [b, k] = samples[i];
      Axis& axis = axes[b];
      const AxisPoint& target = axis.target[k];
      const PieceView view(surface, axis.piece[std::min<std::size_t>(k, axis.piece.size() - 1)]);
      const std::optional<Section> section = measure(view, target, axis.normal[k]);
      if (section) {
        const double factor = std::clamp(1 / section->mean, 0.8, 1.25);
        axis.factor[k] = std::clamp(axis.factor[k] * (1 + axis.freedom[k] * (factor - 1)), 0.5, 2.0);
        // the whole shift overshoots where bends are narrow
        Vec3 shift = axis.shift[k] - (0.8 * axis.freedom[k] * target.radius) * section->shift;
        const double longest = 0.5 * target.radius;
        axis.shift[k] = shift.norm() > longest ? Vec3(longest * shift.normalized()) : shift;
      }
    }
  });
  // Where a branch goes on in another, or in itself, both sides must stay together.
  std::vector<std::vector<std::pair<int, int>>> ends(network.nodes.size());
  for (std::size_t b = 0; b < axes.size(); ++b) {
    ends[network.branches[b].nodes[0]].emplace_back(b, 0);
    ends[network.branches[b].nodes[1]].emplace_back(b, static_cast<int>(axes[b].arc.size()) - 1);
  }
  for (const std::vector<std::pair<int, int>>& pair : ends) {
    if (pair.size() == 2) {
      const auto [b, k] = pair[0];
      const auto [c, l] = pair[1];
      axes[b].factor[k] = axes[c].factor[l] = 0.5 * (axes[b].factor[k] + axes[c].factor[l]);
      axes[b].shift[k] = axes[c].shift[l] = 0.5 * (axes[b].shift[k] + axes[c].shift[l]);
    }
  }
}

}  // namespace

std::unique_ptr<ImplicitSurface> make_convolution_surface(const Network& network, const ConvolutionOptions& options,
                                                          const Run& run) {
  check(network);
  const auto blending = std::make_shared<const Blending>(make_blending(network));
  std::vector<Axis> axes(network.branches.size());
  parallel_for(run, axes.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t b = begin; b < end; ++b) {
      axes[b] = make_axis(network, static_cast<int>(b), *blending);
    }
  });
  auto surface = std::make_unique<ConvolutionSurface>(make_segments(network, axes), blending);
  for (int pass = 0; pass < options.calibration_passes; ++pass) {
    run.progress("surface", static_cast<double>(pass) / options.calibration_passes);
    calibrate(network, *surface, run, axes);
    surface = std::make_unique<ConvolutionSurface>(make_segments(network, axes), blending);
  }
  run.progress("surface", 1);
  return surface;
}

}  // namespace vasohex
