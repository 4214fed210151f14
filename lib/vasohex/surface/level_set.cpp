#include "vasohex/surface/level_set.h"

#include <cmath>

#include "vasohex/core/error.h"
#include "vasohex/surface/cone_tree.h"

namespace vasohex {
namespace {

/// Weights of the four cubic B-splines at t in [0, 1] of a cell, and their derivatives.
struct Weights {
  std::array<double, 4> value, slope;

  explicit Weights(double t) {
    const double s = 1 - t;
    value = {s * s * s / 6, (4 + t * t * (3 * t - 6)) / 6, (4 + s * s * (3 * s - 6)) / 6, t * t * t / 6};
    slope = {-0.5 * s * s, t * (1.5 * t - 2), s * (2 - 1.5 * s), 0.5 * t * t};
  }
};

class LevelSetSurface final : public ImplicitSurface {
 public:
  LevelSetSurface(std::shared_ptr<const LevelSet> level_set, std::vector<ConeSegment> segments)
      : level_set_(std::move(level_set)), tree_(std::move(segments)) {}

  double value(const Vec3& x) const override {
    double value;
    if (level_set_->value(x, value, nullptr)) {
      return value;
    }
    const ConeNearest nearest = tree_.nearest(x);
    return (nearest.ratio - 1) * nearest.radius;
  }
  double value(const Vec3& x, Vec3& gradient) const override {
    double value;
    if (level_set_->value(x, value, &gradient)) {
      return value;
    }
    const ConeNearest nearest = tree_.nearest(x);
    gradient = nearest.radius * nearest.gradient;
    return (nearest.ratio - 1) * nearest.radius;
  }
  double radius(const Vec3& x) const override { return tree_.nearest(x).radius; }

 private:
  std::shared_ptr<const LevelSet> level_set_;
  ConeTree tree_;
};

}  // namespace

LevelSet::LevelSet(const Lattice& lattice) : lattice_(lattice) {
  std::size_t count = 1;
  for (int d = 0; d < 3; ++d) {
    bricks_[d] = (lattice.size[d] + kEdge - 1) / kEdge;
    count *= bricks_[d];
  }
  brick_at_.assign(count, -1);
}

void LevelSet::add_brick(const std::array<int, 3>& place, const std::array<float, kBrickSize>& coefficients) {
  const std::size_t at = place[0] + static_cast<std::size_t>(bricks_[0]) *
                                        (place[1] + static_cast<std::size_t>(bricks_[1]) * place[2]);
  brick_at_[at] = static_cast<int>(coefficients_.size() / kBrickSize);
  coefficients_.insert(coefficients_.end(), coefficients.begin(), coefficients.end());
}

const float* LevelSet::cell(const Vec3& x, Vec3& within) const {
  const Vec3 u = (lattice_.axes.transpose() * (x - lattice_.origin)).cwiseQuotient(lattice_.spacing);
  std::array<int, 3> c{}, b{};
  for (int d = 0; d < 3; ++d) {
    const double floor = std::floor(u[d]);
    if (!(floor >= 0 && floor < bricks_[d] * kEdge)) {
      return nullptr;
    }
    within[d] = u[d] - floor;
    b[d] = static_cast<int>(floor) / kEdge;
    c[d] = static_cast<int>(floor) % kEdge;
  }
  const int brick =
      brick_at_[b[0] + static_cast<std::size_t>(bricks_[0]) * (b[1] + static_cast<std::size_t>(bricks_[1]) * b[2])];
  if (brick < 0) {
    return nullptr;
  }
  return &coefficients_[static_cast<std::size_t>(brick) * kBrickSize] + c[0] + kStored * (c[1] + kStored * c[2]);
}

bool LevelSet::covers(const Vec3& x) const {
  Vec3 within;
  return cell(x, within) != nullptr;
}

bool LevelSet::value(const Vec3& x, double& value, Vec3* gradient) const {
  Vec3 within;
  const float* const coefficients = cell(x, within);
  if (!coefficients) {
    return false;
  }
  const Weights wx(within[0]), wy(within[1]), wz(within[2]);
  double sum = 0;
  Vec3 slope = Vec3::Zero();
  for (int k = 0; k < 4; ++k) {
    double plane = 0, plane_x = 0, plane_y = 0;
    for (int j = 0; j < 4; ++j) {
      const float* const c = coefficients + kStored * (j + kStored * k);
      const double line = wx.value[0] * c[0] + wx.value[1] * c[1] + wx.value[2] * c[2] + wx.value[3] * c[3];
      plane += wy.value[j] * line;
      if (gradient) {
        plane_x += wy.value[j] *
                   (wx.slope[0] * c[0] + wx.slope[1] * c[1] + wx.slope[2] * c[2] + wx.slope[3] * c[3]);
        plane_y += wy.slope[j] * line;
      }
    }
    sum += wz.value[k] * plane;
    slope += Vec3(wz.value[k] * plane_x, wz.value[k] * plane_y, wz.slope[k] * plane);
  }
  value = sum;
  if (gradient) {
    *gradient = lattice_.axes * slope.cwiseQuotient(lattice_.spacing);
  }
  return true;
}

std::unique_ptr<ImplicitSurface> make_level_set_surface(std::shared_ptr<const LevelSet> level_set,
                                                        const Network& network) {
  std::vector<ConeSegment> segments;
  for (const Branch& branch : network.branches) {
    for (std::size_t k = 0; k + 1 < branch.points.size(); ++k) {
      segments.push_back(cone_segment(branch.points[k], branch.radii[k], branch.points[k + 1], branch.radii[k + 1], 0));
    }
  }
  if (segments.empty()) {
    throw Error(ErrorCode::bad_input, "the network has no branch, must have at least one");
  }
  return std::make_unique<LevelSetSurface>(std::move(level_set), std::move(segments));
}

}  // namespace vasohex
