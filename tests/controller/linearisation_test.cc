#include "controller/linearisation/linearisation.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/controller/test_hand.h"
#include "tests/controller/test_signal.h"

namespace gauntlet::controller {
namespace {

using testing::HasSubstr;

constexpr double kRadPerDeg = std::numbers::pi / 180.0;
const std::vector<std::string> kNames = {"thumb", "index"};

ChannelCurve TableOf(std::vector<double> counts, std::vector<double> angle_deg,
                     std::string channel = "") {
  return {.channel = std::move(channel),
          .counts = std::move(counts),
          .angle_deg = std::move(angle_deg),
          .coefficients_deg = {}};
}

LinearisationConfig Tables() {
  return {.kind = LinearisationKind::kTable,
          .channels = {TableOf({100, 300, 700, 900}, {-10, 20, 30, 90}),
                       TableOf({200, 500, 800}, {80, 50, -5})}};
}

LinearisationConfig Polynomials() {
  // Derivatives 45 + 20 u + 15 u^2 and -30 - 6 u keep their sign on [-1, 1].
  return {.kind = LinearisationKind::kPolynomial,
          .channels = {{.channel = "",
                        .counts = {},
                        .angle_deg = {},
                        .coefficients_deg = {45, 45, 10, 5},
                        .center_counts = 500,
                        .scale_counts = 300},
                       {.channel = "",
                        .counts = {},
                        .angle_deg = {},
                        .coefficients_deg = {40, -30, -3},
                        .center_counts = 400,
                        .scale_counts = 200}}};
}

TEST(Linearisation, IsUndoneByItsInverse) {
  for (const LinearisationConfig& config : {LinearisationConfig{}, Tables(), Polynomials()}) {
    const auto map = MakeLinearisation(config, PlainGlove(2), kNames);
    TestNoise noise(2);
    for (int trial = 0; trial < 1000; ++trial) {
      const double counts[] = {1023.0 * noise.Uniform(), 1023.0 * noise.Uniform()};
      double angle[2];
      double back[2];
      map->ToAngles(counts, angle);
      map->ToCounts(angle, back);
      EXPECT_NEAR(back[0], counts[0], 1e-10);
      EXPECT_NEAR(back[1], counts[1], 1e-10);
    }
  }
}

TEST(TableLinearisation, MeetsItsCornersAndGoesOnBeyondThem) {
  const auto map = MakeLinearisation(Tables(), PlainGlove(2), kNames);
  const auto angle_deg = [&map](double counts, int channel) {
    const double input[] = {counts, counts};
    double output[2];
    map->ToAngles(input, output);
    return output[channel] / kRadPerDeg;
  };
  EXPECT_NEAR(angle_deg(300, 0), 20.0, 1e-12);
  EXPECT_NEAR(angle_deg(500, 0), 25.0, 1e-12);
  EXPECT_NEAR(angle_deg(1000, 0), 120.0, 1e-11);
  EXPECT_NEAR(angle_deg(0, 0), -25.0, 1e-12);
  EXPECT_NEAR(angle_deg(650, 1), 22.5, 1e-12);
}

TEST(PolynomialLinearisation, FollowsItsTangentsBeyondItsRange) {
  const auto map = MakeLinearisation(Polynomials(), PlainGlove(2), kNames);
  const double counts[] = {950.0, 400.0};  // u = 1.5 and 0
  double angle[2];
  map->ToAngles(counts, angle);
  EXPECT_NEAR(angle[0] / kRadPerDeg, 105.0 + 80.0 * 0.5, 1e-10);
  EXPECT_NEAR(angle[1] / kRadPerDeg, 40.0, 1e-12);
}

TEST(Linearisation, FindsChannelsByName) {
  LinearisationConfig config = Tables();
  config.channels[0].channel = "index";
  config.channels[1].channel = "thumb";
  const auto map = MakeLinearisation(config, PlainGlove(2), kNames);
  const double counts[] = {500.0, 300.0};
  double angle[2];
  map->ToAngles(counts, angle);
  EXPECT_NEAR(angle[0] / kRadPerDeg, 50.0, 1e-12);
  EXPECT_NEAR(angle[1] / kRadPerDeg, 20.0, 1e-12);
}

std::string ProblemOf(const LinearisationConfig& config) {
  try {
    MakeLinearisation(config, PlainGlove(2), kNames);
  } catch (const SettingError& error) {
    return error.what();
  }
  return "";
}

TEST(Linearisation, RefusesCurvesThatCannotBeUsed) {
  LinearisationConfig config = Tables();
  config.channels[1].angle_deg = {80, 50, 60};
  EXPECT_THAT(ProblemOf(config), HasSubstr("channels[1]: angle_deg must all grow or all fall"));
  config = Tables();
  config.channels[0].counts[1] = 100;
  EXPECT_THAT(ProblemOf(config), HasSubstr("channels[0]: counts must grow"));
  config = Tables();
  config.channels.pop_back();
  EXPECT_THAT(ProblemOf(config), HasSubstr("no curve for channel index"));
  config = Tables();
  config.channels[0].channel = "toe";
  EXPECT_THAT(ProblemOf(config), HasSubstr("toe"));
  config = Polynomials();
  config.channels[0].coefficients_deg = {0, 1, 5};  // slope 1 + 10 u
  EXPECT_THAT(ProblemOf(config), HasSubstr("turns back at"));
}

}  // namespace
}  // namespace gauntlet::controller
