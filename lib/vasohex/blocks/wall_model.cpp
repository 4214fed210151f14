#include "vasohex/blocks/wall_model.h"

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
