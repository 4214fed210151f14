// Nodes of a blocks' wall onto the surface: along their line, or to the closest point.

#include "vasohex/mesh/wall_node.h"

#include <gtest/gtest.h>

#include <cmath>

namespace vasohex {
namespace {

/// Below z = height exp(-(x / .1)^2): a plane with a narrow spike, or a dent.
class Spiked final : public ImplicitSurface {
 public:
  Spiked(double height, bool round) : height_(height), round_(round) {}
  double value(const Vec3& x) const override {
    Vec3 gradient;
    return value(x, gradient);
  }
  double value(const Vec3& x, Vec3& gradient) const override {
    const double t = x.x() / 0.1, high = height_ * std::exp(-t * t);
    gradient = Vec3(2 * t / 0.1 * high, 0, 1);
    return x.z() - high;
  }
  double radius(const Vec3&) const override { return 1; }
  bool is_round() const override { return round_; }

 private:
  double height_;
  bool round_;
};

TEST(WallNode, FollowsItsLineIntoSpikesAndDents) {
  for (const double height : {0.3, -0.3}) {
    const Spiked surface(height, false);
    const Vec3 up = Vec3::UnitZ(), plane = Vec3::UnitY();
    for (const double x : {-0.2, -0.03, 0.0, 0.02, 0.07, 0.4}) {
      for (const double z : {-0.01, 0.0, 0.02}) {
        for (const Vec3* within : {static_cast<const Vec3*>(nullptr), &plane}) {
          SCOPED_TRACE(testing::Message() << height << " at " << x << ", " << z);
          const Vec3 start(x, 0.5, z);
          const WallNode w = onto_wall(surface, start, within ? Vec3(up + 0.5 * plane).normalized() : up, within, 1);
          ASSERT_TRUE(w.converged);
          EXPECT_NEAR(surface.value(w.point), 0, 1e-8);
          EXPECT_NEAR((w.point - Vec3(x, 0.5, surface.value(start))).head<2>().norm(), 0, 1e-9);
          EXPECT_NEAR(w.normal.norm(), 1, 1e-12);
          EXPECT_GT(w.normal.z(), 0);
        }
      }
    }
  }
}

TEST(WallNode, GoesToTheClosestPointOfRoundVesselsAndWhereItsLineMeetsNothing) {
  const Vec3 start(0.05, 0, 0.02);
  const Vec3 up = Vec3::UnitZ();
  const WallNode on_spike = onto_wall(Spiked(0.3, false), start, up, nullptr, 1);
  const WallNode closest = onto_wall(Spiked(0.3, true), start, up, nullptr, 1);
  ASSERT_TRUE(on_spike.converged && closest.converged);
  EXPECT_GT((on_spike.point - start).norm(), 1.5 * (closest.point - start).norm());
  const WallNode beside = onto_wall(Spiked(0, false), Vec3(0, 0, -0.1), Vec3::UnitX(), nullptr, 1);
  ASSERT_TRUE(beside.converged);
  EXPECT_NEAR((beside.point - Vec3::Zero()).norm(), 0, 1e-9);
  EXPECT_FALSE(onto_wall(Spiked(0, true), Vec3(0, 0, -1.5 * kFurthestShift), up, nullptr, 1).converged);
}

}  // namespace
}  // namespace vasohex
