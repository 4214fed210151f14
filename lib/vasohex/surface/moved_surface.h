#pragma once
/// \file A surface seen from outside the frame it was made in.

#include <memory>
#include <utility>

#include "vasohex/skeleton/own_frame.h"
#include "vasohex/surface/implicit_surface.h"

namespace vasohex {

class MovedSurface final : public ImplicitSurface {
 public:
  MovedSurface(std::shared_ptr<const ImplicitSurface> surface, const OwnFrame& frame)
      : surface_(std::move(surface)), frame_(frame) {}

  double value(const Vec3& x) const override { return surface_->value(frame_.inward(x)); }
  double value(const Vec3& x, Vec3& gradient) const override {
    const double v = surface_->value(frame_.inward(x), gradient);
    gradient = frame_.rotation * gradient / frame_.scale;
    return v;
  }
  double radius(const Vec3& x) const override { return frame_.scale * surface_->radius(frame_.inward(x)); }
  bool is_round() const override { return surface_->is_round(); }
  /// Arc lengths are those of the network outside the frame.
  std::shared_ptr<const ImplicitSurface> part(const std::vector<Stretch>& stretches) const override {
    std::vector<Stretch> inside = stretches;
    for (Stretch& stretch : inside) {
      stretch.from /= frame_.scale;
      stretch.to /= frame_.scale;
    }
    return std::make_shared<MovedSurface>(surface_->part(inside), frame_);
  }

 private:
  std::shared_ptr<const ImplicitSurface> surface_;
  OwnFrame frame_;
};

}  // namespace vasohex
