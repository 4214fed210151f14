#include "vasohex/blocks/wall_model.h"

#include <algorithm>
#include <cmath>

namespace vasohex {

void WallModel::forget() {
  for (Anchor& anchor : anchors_) {
    anchor.known = Known::nothing;
  }
}

double WallModel::value(std::size_t point, const Vec3& x, Vec3& gradient) {
  Anchor& anchor = anchors_[point];
  const Vec3 away = x - anchor.at;
  if (anchor.known == Known::nothing || !(away.squaredNorm() <= reach_ * reach_)) {
    anchor.at = x;
    anchor.value = surface_->value(x, anchor.gradient);
    anchor.known = Known::gradient;
    gradient = anchor.gradient;
    return anchor.value;
  }
  if (anchor.known == Known::gradient) {
    anchor.hessian = hessian(anchor);
    anchor.known = Known::curvature;
  }
  const Vec3 turn = anchor.hessian * away;
  gradient = anchor.gradient + turn;
  return anchor.value + away.dot(anchor.gradient + 0.5 * turn);
}

double WallModel::value_facing(std::size_t point, const Vec3& x, const Vec3& outward, Vec3& gradient) {
  constexpr double kOpposite = -0.8;  // cosine
  constexpr double kFurthest = 12;    // reaches
  const double value = this->value(point, x, gradient);
  const auto is_opposite = [&](const Vec3& g) { return g.dot(outward) < kOpposite * g.norm(); };
  if (!is_opposite(gradient)) {
    return value;
  }
  Vec3 there = gradient;
  double back = 0, value_there = value;
  while (is_opposite(there) && back < kFurthest * reach_) {
    back += std::max(std::abs(value_there) / there.norm(), reach_);
    value_there = this->value(point, x - back * outward, there);
  }
  const double slope = there.norm();
  if (is_opposite(there) || !(slope > 0)) {
    return value;
  }
  gradient = outward;
  return back + value_there / slope;
}

Eigen::Matrix3d WallModel::hessian(const Anchor& anchor) const {
  const double slope = anchor.gradient.norm();
  if (!(slope > 0)) {
    return Eigen::Matrix3d::Zero();
  }
  const Vec3 normal = anchor.gradient / slope;
  const double step = 1e-3 * reach_;
  Eigen::Matrix3d axes, columns;  // the derivatives of the gradient along two tangents; along the normal by symmetry
  axes.col(0) = normal.unitOrthogonal();
  axes.col(1) = normal.cross(axes.col(0));
  axes.col(2) = normal;
  for (int d = 0; d < 2; ++d) {
    Vec3 gradient;
    surface_->value(anchor.at + step * axes.col(d), gradient);
    columns.col(d) = (gradient - anchor.gradient) / step;
  }
  columns.col(2) = columns.col(0).dot(normal) * axes.col(0) + columns.col(1).dot(normal) * axes.col(1);
  return columns * axes.transpose();
}

}  // namespace vasohex
