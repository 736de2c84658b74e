// One concept, two ways through it: samples one by one, as a robot has them, and many at once.
#include "controller/angle_estimator.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <span>
#include <string>
#include <vector>

#include "tests/controller/test_hand.h"

namespace gauntlet::controller {
namespace {

constexpr int kChannels = 5;
constexpr int kSamples = 300;

struct EstimatorCase {
  std::string name;
  ControllerConfig config;
};
void PrintTo(const EstimatorCase& tested, std::ostream* out) { *out << tested.name; }

LinearisationConfig Curves(LinearisationKind kind) {
  LinearisationConfig config{.kind = kind, .channels = {}};
  for (int i = 0; i < kChannels; ++i) {
    ChannelCurve& curve = config.channels.emplace_back();
    if (kind == LinearisationKind::kTable) {
      curve.counts = {0.0, 300.0 + 10.0 * i, 1023.0};
      curve.angle_deg = {0.0, 20.0, 90.0};
    } else {
      curve.coefficients_deg = {40.0 + i, 40.0, 5.0};
    }
  }
  return config;
}

std::vector<EstimatorCase> EstimatorCases() {
  const KalmanConfig kalman{.noise = {.r = {15.0}}};
  const KalmanConfig kalman_of_angles{.noise = {.r = {1e-5}}};
  const PredictionConfig linear{LinearPredictionConfig{.horizon_ms = {30.0}}};
  std::vector<EstimatorCase> cases(7);
  cases[0].name = "no_filter";
  cases[1].name = "of_counts";
  cases[1].config.filters = {{kalman}};
  cases[2].name = "of_angles";
  cases[2].config.filters = {{kalman_of_angles}};
  cases[2].config.filter_on = FilterOn::kAngle;
  cases[3].name = "chain";
  cases[3].config.filters = {{MedianConfig{.window = 5}}, {kalman}};
  cases[3].config.prediction = linear;
  cases[4].name = "prediction_alone";
  cases[4].config.prediction = linear;
  cases[5].name = "table";
  cases[5].config.filters = {{kalman}};
  cases[5].config.linearisation = Curves(LinearisationKind::kTable);
  cases[6].name = "polynomial";
  cases[6].config.filters = {{kalman}};
  cases[6].config.linearisation = Curves(LinearisationKind::kPolynomial);
  return cases;
}

RobotConfig RobotOf(const ControllerConfig& config) {
  RobotConfig robot;
  robot.controller = config;
  robot.glove = PlainGlove(kChannels);
  robot.hand = CoupledHand(kChannels);
  return robot;
}

std::vector<double> CountsOfAHand() {
  std::vector<double> counts;
  for (int k = 0; k < kSamples; ++k) {
    for (int i = 0; i < kChannels; ++i) {
      counts.push_back(std::round(500.0 + 200.0 * std::sin(0.02 * k + i)));
    }
  }
  return counts;
}

class AngleEstimatorTest : public ::testing::TestWithParam<EstimatorCase> {};
INSTANTIATE_TEST_SUITE_P(Each, AngleEstimatorTest, ::testing::ValuesIn(EstimatorCases()),
                         [](const auto& one) { return one.param.name; });

TEST_P(AngleEstimatorTest, GivesManySamplesTheBitsOfOneByOne) {
  const RobotConfig robot = RobotOf(GetParam().config);
  const std::vector<double> counts = CountsOfAHand();
  const std::span<const double> all(counts);
  for (const bool all_active : {true, false}) {
    AngleEstimator alone(robot, robot.controller, 3);
    AngleEstimator together(robot, robot.controller, 3);
    for (AngleEstimator* estimator : {&alone, &together}) {
      estimator->Reset(all.first(kChannels));
      estimator->SetChannelActive(2, all_active);
    }
    std::vector<double> expected;
    std::vector<double> linearised(kChannels);
    for (int k = 0; k < kSamples; ++k) {
      const auto sample = all.subspan(static_cast<std::size_t>(k) * kChannels, kChannels);
      alone.linearisation().ToAngles(sample, linearised);
      alone.StepLinearised(sample, linearised);
      expected.insert(expected.end(), alone.predicted_rad().begin(), alone.predicted_rad().end());
    }
    std::vector<double> predicted(counts.size());
    const std::size_t parts[] = {0, 1, 120, 121, kSamples};
    for (std::size_t i = 0; i + 1 < std::size(parts); ++i) {
      const std::size_t at = parts[i] * kChannels;
      const std::size_t size = (parts[i + 1] - parts[i]) * kChannels;
      together.Step(all.subspan(at, size), std::span(predicted).subspan(at, size));
    }
    EXPECT_EQ(predicted, expected);
    EXPECT_TRUE(std::ranges::equal(together.predicted_rad(), alone.predicted_rad()));
    EXPECT_TRUE(std::ranges::equal(together.filtered_rad(), alone.filtered_rad()));
    for (int row = 0; row < 3; ++row) {
      EXPECT_TRUE(std::ranges::equal(together.path().Row(row), alone.path().Row(row))) << row;
    }
    EXPECT_GT(std::abs(predicted.back() - predicted.front()), 0.01);
  }
}

TEST(AngleEstimator, StandsWhereTheJointsAre) {
  const RobotConfig robot = RobotOf({});
  AngleEstimator estimator(robot, {});
  const JointMap joint_map({}, robot.glove.channel_names, robot.hand);
  estimator.MoveTo(joint_map, std::vector<double>(kChannels, 0.75));
  std::vector<double> counts(kChannels);
  estimator.ToCounts(counts);
  for (const double value : counts) EXPECT_NEAR(value, 500.0, 1e-9);  // see PlainGlove()
}

}  // namespace
}  // namespace gauntlet::controller
