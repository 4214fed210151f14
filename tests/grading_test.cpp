#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "vasohex/core/error.h"
#include "vasohex/grading/division.h"

namespace vasohex {
namespace {

TEST(Divide, FollowsTheLaw) {
  const std::vector<double> uniform = divide(UniformLaw{}, 4);
  EXPECT_EQ(uniform, (std::vector<double>{0, 0.25, 0.5, 0.75, 1}));
  const std::vector<double> geometric = divide(GeometricLaw{1.5}, 5);
  for (int i = 2; i <= 5; ++i) {
    EXPECT_NEAR((geometric[i] - geometric[i - 1]) / (geometric[i - 1] - geometric[i - 2]), 1.5, 1e-12);
  }
  const std::vector<double> tanh = divide(TanhLaw{2}, 6);
  EXPECT_LT(tanh[1], 1 / 6.0);
  EXPECT_NEAR(tanh[2] + tanh[4], 1, 1e-14);
  EXPECT_NEAR(divide(CustomLaw{[](double t) { return t * t; }}, 4)[2], 0.25, 1e-15);
  EXPECT_TRUE(is_symmetric(TanhLaw{}, 5));
  EXPECT_FALSE(is_symmetric(GeometricLaw{1.1}, 5));
}

TEST(Divide, RefusesALawThatDoesNotIncrease) {
  try {
    divide(CustomLaw{[](double t) { return std::sin(3 * t); }}, 8);
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ErrorCode::bad_input);
    EXPECT_NE(std::string(e.what()).find("must increase"), std::string::npos);
  }
}

TEST(WallLine, HasTheLayersAndFillsTheRest) {
  bool shrunk = true;
  const std::vector<double> d = divide_wall_line({6, 0.02, true, 1.3}, 0.02, 9, 0.4, shrunk);
  EXPECT_FALSE(shrunk);
  ASSERT_EQ(d.size(), 10u);
  EXPECT_NEAR(d[1], 0.02, 1e-15);
  for (int i = 2; i <= 6; ++i) {
    EXPECT_NEAR((d[i] - d[i - 1]) / (d[i - 1] - d[i - 2]), 1.3, 1e-12);
  }
  EXPECT_DOUBLE_EQ(d[9], 0.4);
  for (int i = 7; i <= 9; ++i) {
    EXPECT_GT(d[i], d[i - 1]);
  }
  const double g = (d[8] - d[7]) / (d[7] - d[6]);
  EXPECT_NEAR((d[9] - d[8]) / (d[8] - d[7]), g, 1e-9);
  EXPECT_NEAR((d[7] - d[6]) / (d[6] - d[5]), g, 1e-9);
}

TEST(WallLine, ShrinksLayersThatDoNotFit) {
  constexpr double kFirst = 0.02;
  bool shrunk = false;
  const std::vector<double> d = divide_wall_line({6, kFirst, true, 1.3}, kFirst, 8, 0.2, shrunk);
  EXPECT_TRUE(shrunk);
  EXPECT_NEAR(d[1], kFirst, 1e-12) << "the first layer keeps its height as long as equal ones fit";
  EXPECT_LE(d[6], 0.75 * 0.2);
  EXPECT_GT(d[6], 0.65 * 0.2);
  for (int i = 2; i <= 6; ++i) {
    EXPECT_NEAR((d[i] - d[i - 1]) / (d[i - 1] - d[i - 2]), (d[2] - d[1]) / d[1], 1e-9);
  }
  EXPECT_DOUBLE_EQ(d[8], 0.2);
  // far too short: all of one height
  const std::vector<double> e = divide_wall_line({6, kFirst, true, 1.3}, kFirst, 8, 0.02, shrunk);
  EXPECT_TRUE(shrunk);
  for (int i = 1; i <= 6; ++i) {
    EXPECT_NEAR(e[i] - e[i - 1], 0.75 * 0.02 / 6, 1e-9);
  }
}

TEST(WallLine, HasNoKinkAsTheLineGetsShorter) {
  // second differences over the length stay bounded as the step is halved: at a kink they double
  for (const WallLayers& layers : {WallLayers{6, 0.02, true, 1.3}, WallLayers{1, 0.1, true, 1.2},
                                   WallLayers{3, 0.05, true, 0.8}, WallLayers{8, 0.01, true, 1.0}}) {
    const auto roughness = [&](double h) {
      double most = 0;
      for (double length = 0.02; length < 0.6; length += h) {
        std::array<std::vector<double>, 3> d;
        bool shrunk = false;
        for (int i = 0; i < 3; ++i) {
          d[i] = divide_wall_line(layers, layers.first_height, layers.layers + 3, length + (i - 1) * h, shrunk);
        }
        for (int k = 0; k <= layers.layers + 3; ++k) {
          EXPECT_TRUE(k == 0 || d[1][k] > d[1][k - 1]);
          most = std::max(most, std::abs(d[0][k] - 2 * d[1][k] + d[2][k]) / (h * h));
        }
      }
      return most;
    };
    EXPECT_LT(roughness(0.0005), 1.2 * roughness(0.001)) << layers.layers << " layers";
  }
}

}  // namespace
}  // namespace vasohex
