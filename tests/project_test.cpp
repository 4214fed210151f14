#include "vasohex/surface/project.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

namespace vasohex {
namespace {

/// Counts its evaluations; single-threaded.
class Counted : public ImplicitSurface {
 public:
  double value(const Vec3& x) const final {
    Vec3 gradient;
    return value(x, gradient);
  }
  double value(const Vec3& x, Vec3& gradient) const final {
    ++evaluations;
    return field(x, gradient);
  }
  mutable int evaluations = 0;

 private:
  virtual double field(const Vec3& x, Vec3& gradient) const = 0;
};

/// Not a distance: |x|^2 / r^2 - 1.
class Sphere final : public Counted {
 public:
  explicit Sphere(double radius) : radius_(radius) {}
  double radius(const Vec3&) const override { return radius_; }

 private:
  double field(const Vec3& x, Vec3& gradient) const override {
    gradient = 2 * x / (radius_ * radius_);
    return x.squaredNorm() / (radius_ * radius_) - 1;
  }
  double radius_;
};

/// Around z; distance / tube radius - 1.
class Torus final : public Counted {
 public:
  Torus(double bend, double tube) : bend_(bend), tube_(tube) {}
  double radius(const Vec3&) const override { return tube_; }
  double distance(const Vec3& x) const { return std::hypot(std::hypot(x[0], x[1]) - bend_, x[2]) - tube_; }

 private:
  double field(const Vec3& x, Vec3& gradient) const override {
    const double rho = std::hypot(x[0], x[1]), d = std::hypot(rho - bend_, x[2]);
    gradient = Vec3((rho - bend_) * x[0] / rho, (rho - bend_) * x[1] / rho, x[2]) / (d * tube_);
    return d / tube_ - 1;
  }
  double bend_, tube_;
};

/// Two half spaces x < 0 and x > gap, as the union of two vessels with a slit between.
class Slit final : public Counted {
 public:
  explicit Slit(double gap) : gap_(gap) {}
  double radius(const Vec3&) const override { return 1; }

 private:
  double field(const Vec3& x, Vec3& gradient) const override {
    const bool first = x[0] < gap_ - x[0];
    gradient = first ? Vec3(1, 0, 0) : Vec3(-1, 0, 0);
    return first ? x[0] : gap_ - x[0];
  }
  double gap_;
};

Vec3 random_direction(std::mt19937& random) {
  std::normal_distribution<double> normal;
  return Vec3(normal(random), normal(random), normal(random)).normalized();
}

TEST(Project, SphereAtAnyScale) {
  std::mt19937 random(1);
  for (const double scale : {1e-3, 1.0, 1e3}) {
    const Sphere sphere(2 * scale);
    for (int i = 0; i < 100; ++i) {
      const Vec3 direction = random_direction(random);
      const Vec3 x = (0.9 + 0.2 * i / 100) * 2 * scale * direction;
      sphere.evaluations = 0;
      const Projection found = project(sphere, x);
      ASSERT_TRUE(found.converged);
      EXPECT_LT((found.point - 2 * scale * direction).norm(), 1e-10 * 2 * scale);
      EXPECT_LT((found.normal - direction).norm(), 1e-9);
      EXPECT_LE(sphere.evaluations, 5);
    }
  }
}

TEST(Project, DistanceFieldsTakeOneStep) {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> angle(0, 2 * std::numbers::pi), offset(0.6, 1.4);
  const Torus torus(3, 1);
  for (int i = 0; i < 100; ++i) {
    const double a = angle(random), b = angle(random), d = offset(random);
    const Vec3 out(std::cos(a), std::sin(a), 0);
    const Vec3 x = 3 * out + d * (std::cos(b) * out + std::sin(b) * Vec3::UnitZ());
    torus.evaluations = 0;
    const Projection found = project(torus, x);
    ASSERT_TRUE(found.converged);
    EXPECT_LT(std::abs(torus.distance(found.point)), 1e-12);
    EXPECT_LE(torus.evaluations, 3);
  }
}

TEST(Project, FromAfarByStepsWithinTheTrustRegion) {
  const Torus torus(3, 1);
  const Projection found = project(torus, {9, 0, 0.5}, 0.25);
  ASSERT_TRUE(found.converged);
  EXPECT_LT(std::abs(torus.distance(found.point)), 1e-10);
  EXPECT_GT(found.point[0], 3);
  EXPECT_GE(torus.evaluations, 20);
}

TEST(Project, ACriticalPointIsReported) { EXPECT_FALSE(project(Sphere(1), Vec3::Zero()).converged); }

TEST(Shoot, SphereFromAnyPointInside) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> inside(0, 0.95);
  for (const double scale : {1e-3, 1.0, 1e3}) {
    const Sphere sphere(scale);
    for (int i = 0; i < 200; ++i) {
      const Vec3 origin = scale * inside(random) * random_direction(random), direction = random_direction(random);
      const double b = origin.dot(direction);
      const double exact = -b + std::sqrt(b * b + scale * scale - origin.squaredNorm());
      sphere.evaluations = 0;
      const std::optional<double> t = shoot(sphere, origin, direction, scale, 3 * scale);
      ASSERT_TRUE(t);
      EXPECT_NEAR(*t, exact, 2e-12 * scale);
      EXPECT_LE(sphere.evaluations, 25);
    }
  }
}

TEST(Shoot, TorusAcrossTheTube) {
  const Torus torus(3, 1);
  for (int k = 0; k < 16; ++k) {
    const double a = 2 * std::numbers::pi * k / 16;
    torus.evaluations = 0;
    const std::optional<double> t = shoot(torus, {3 + 1e-9, 0, 0}, {std::cos(a), 0, std::sin(a)}, 1, 3);
    ASSERT_TRUE(t);
    EXPECT_NEAR(*t, 1, 1e-8);
    EXPECT_LE(torus.evaluations, 10);
  }
}

TEST(Shoot, NothingToMeet) {
  const Torus torus(3, 1);
  const Vec3 origin(3.2, 0, 0);
  EXPECT_FALSE(shoot(torus, {0, 0, 0.1}, {1, 0, 0}, 1, 10)) << "from outside";
  EXPECT_FALSE(shoot(torus, origin, {1, 0, 0}, 1, 0.79)) << "t_max before the wall";
  EXPECT_TRUE(shoot(torus, origin, {1, 0, 0}, 1, 0.81));
  EXPECT_FALSE(shoot(Sphere(100), {0, 0, 0}, {1, 0, 0}, 1, 50));
}

TEST(Shoot, StopsAtAThinSlit) {
  for (const double start : {-3.0, -0.71, -0.2, -0.011}) {
    const Slit slit(0.1);
    const std::optional<double> t = shoot(slit, {start, 0, 0}, {1, 0, 0}, 1, 5);
    ASSERT_TRUE(t);
    EXPECT_NEAR(*t, -start, 1e-12);
  }
}

}  // namespace
}  // namespace vasohex
