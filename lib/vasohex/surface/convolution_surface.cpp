#include "vasohex/surface/convolution_surface.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "vasohex/core/smooth_step.h"

namespace vasohex {
namespace {

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

void take_greater(const ConeSum& candidate, ConeSum& field) {
  if (candidate.value > field.value) {
    field = candidate;
  }
}

}  // namespace

/// What every piece that reaches a point contributes there; in place for the usual few pieces.
class ConvolutionSurface::PieceSums {
 public:
  /// That of `piece`, zero if new.
  PieceSum& of(int piece) {
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
    PieceSum& sum = data()[count_++];
    sum.piece = piece;
    return sum;
  }
  std::span<const PieceSum> all() const { return {many_.empty() ? few_.data() : many_.data(), count_}; }

 private:
  PieceSum* data() { return many_.empty() ? few_.data() : many_.data(); }

  std::array<PieceSum, 8> few_;
  std::vector<PieceSum> many_;
  std::size_t count_ = 0;
};

ConvolutionSurface::PieceSums ConvolutionSurface::gather(const Vec3& x) const {
  PieceSums sums;
  tree_.for_each_sum(x, [&](int piece, const kernel::GroupSum& sum) {
    PieceSum& of_piece = sums.of(piece);
    of_piece.value += sum.value;
    of_piece.gradient += Vec3::Map(sum.gradient);
  });
  return sums;
}

bool ConvolutionSurface::is_greatest_of(std::span<const PieceSum> sums, std::size_t i, int joint) const {
  for (std::size_t k = 0; k < sums.size(); ++k) {
    const std::vector<int>& joints = blending_->joints_of[sums[k].piece];
    if ((sums[k].value > sums[i].value || (sums[k].value == sums[i].value && k < i)) &&
        std::find(joints.begin(), joints.end(), joint) != joints.end()) {
      return false;
    }
  }
  return true;
}

/// Takes from `others` the lesser of two pieces that meet at no node, where no third piece of the joint is and they
/// have parted.
void ConvolutionSurface::separate_siblings(std::span<const PieceSum> sums, int joint, const ConeSum& greatest,
                                           const Vec3& x, ConeSum& others) const {
  constexpr double present = 0.2;  // a field that counts as there; 1 is the wall
  if (blending_->joints[joint].size() < 2) {
    return;
  }
  const ConeSum all{greatest.value + others.value, greatest.gradient + others.gradient};
  const auto in_joint = [&](const PieceSum& sum) {
    const std::vector<int>& joints = blending_->joints_of[sum.piece];
    return std::find(joints.begin(), joints.end(), joint) != joints.end();
  };
  for (std::size_t i = 0; i < sums.size(); ++i) {
    for (std::size_t k = 0; k < i; ++k) {
      if (!in_joint(sums[i]) || !in_joint(sums[k]) || !blending_->are_siblings(joint, sums[i].piece, sums[k].piece)) {
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
ConeSum ConvolutionSurface::blended(std::span<const PieceSum> sums, int joint, const ConeSum& greatest,
                                    const Vec3& x) const {
  ConeSum others;  // sum - greatest
  others.value = -greatest.value;
  others.gradient = -greatest.gradient;
  for (const PieceSum& sum : sums) {
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
double ConvolutionSurface::evaluate(const Vec3& x, Vec3* gradient) const {
  const PieceSums sums = gather(x);
  const std::span<const PieceSum> all = sums.all();
  ConeSum field;
  for (const PieceSum& sum : all) {
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

ConvolutionSurface::ConvolutionSurface(std::vector<ConeSegment> segments, std::shared_ptr<const Blending> blending)
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

double ConvolutionSurface::value(const Vec3& x) const { return evaluate<false>(x, nullptr); }

double ConvolutionSurface::value(const Vec3& x, Vec3& gradient) const { return evaluate<true>(x, &gradient); }

double ConvolutionSurface::radius(const Vec3& x) const {
  double field = 0, weighted = 0;
  tree_.for_each_sum(x, [&](int, const kernel::GroupSum& sum) {
    field += sum.value;
    weighted += sum.weighted_radius;
  });
  return field > no_field ? weighted / field : tree_.nearest(x).radius;
}

std::shared_ptr<const ImplicitSurface> ConvolutionSurface::part(const std::vector<Stretch>& stretches) const {
  std::vector<ConeSegment> segments;
  for (const int piece : blending_->pieces_around(stretches)) {
    segments.insert(segments.end(), segments_.begin() + first_of_piece_[piece],
                    segments_.begin() + first_of_piece_[piece + 1]);
  }
  return std::make_shared<ConvolutionSurface>(std::move(segments), blending_);
}

double ConvolutionSurface::value_of_piece(int piece, const Vec3& x, Vec3& gradient) const {
  const PieceSums sums = gather(x);
  ConeSum field;
  for (const PieceSum& sum : sums.all()) {
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

}  // namespace vasohex
