#include <gtest/gtest.h>

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
  bool shrunk = false;
  const std::vector<double> d = divide_wall_line({6, 0.02, true, 1.3}, 0.02, 8, 0.2, shrunk);
  EXPECT_TRUE(shrunk);
  EXPECT_NEAR(d[6], 0.18, 1e-12);
  EXPECT_DOUBLE_EQ(d[8], 0.2);
}

}  // namespace
}  // namespace vasohex
