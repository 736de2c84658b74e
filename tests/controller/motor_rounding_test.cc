#include "controller/motor_rounding.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/controller/test_hand.h"
#include "tests/controller/test_signal.h"

namespace gauntlet::controller {
namespace {

constexpr double kEventsPerSecond = 50.0;

/// One motor's commands for a list of exact ones.
std::vector<std::int32_t> Commands(const MotorRoundingConfig& config,
                                   const std::vector<double>& exact) {
  MotorRounding rounding(config, CoupledHand(1), kEventsPerSecond);
  std::vector<std::int32_t> commands(exact.size());
  for (std::size_t k = 0; k < exact.size(); ++k) rounding.Step({&exact[k], 1}, {&commands[k], 1});
  return commands;
}

/// A slow motion, with noise of a third of a count: where rounding is seen.
std::vector<double> SlowMotion(int events) {
  TestNoise noise(8);
  std::vector<double> exact;
  for (int k = 0; k < events; ++k) exact.push_back(500.0 + 0.01 * k + 0.33 * noise.Normal());
  return exact;
}

int Reversals(const std::vector<std::int32_t>& commands) {
  int reversals = 0;
  int last = 0;
  for (std::size_t k = 1; k < commands.size(); ++k) {
    const int change = commands[k] - commands[k - 1];
    reversals += change * last < 0;
    if (change != 0) last = change;
  }
  return reversals;
}

/// RMS error of the mean over 25 events (0.5 s): what a slow hand feels of the rounding.
double SlowError(const std::vector<std::int32_t>& commands, const std::vector<double>& exact) {
  double sum = 0.0;
  int count = 0;
  for (std::size_t k = 0; k + 25 <= exact.size(); k += 25, ++count) {
    double error = 0.0;
    for (std::size_t i = k; i < k + 25; ++i) error += (commands[i] - exact[i]) / 25.0;
    sum += error * error;
  }
  return std::sqrt(sum / count);
}

TEST(MotorRounding, TradesReversalsAgainstExactness) {
  const std::vector<double> exact = SlowMotion(5000);
  const auto nearest = Commands({.rounding = Rounding::kNearest}, exact);
  const auto hysteresis = Commands({.rounding = Rounding::kHysteresis}, exact);
  const auto shaped = Commands({.rounding = Rounding::kNoiseShaping}, exact);
  // Hysteresis is quiet and keeps an offset; shaping is busy and exact on average.
  EXPECT_LT(Reversals(hysteresis), 0.1 * Reversals(nearest));
  EXPECT_GT(Reversals(shaped), Reversals(nearest));
  EXPECT_LT(SlowError(shaped, exact), 0.6 * SlowError(nearest, exact));
  EXPECT_GT(SlowError(hysteresis, exact), SlowError(nearest, exact));
}

TEST(MotorRounding, KeepsTheMeanOfAConstantBetweenTwoCounts) {
  const std::vector<double> exact(1000, 512.3);
  const auto commands = Commands({.rounding = Rounding::kNoiseShaping}, exact);
  double mean = 0.0;
  for (const std::int32_t command : commands) mean += command / 1000.0;
  EXPECT_NEAR(mean, 512.3, 1e-3);
}

TEST(MotorRounding, HoldsWithinItsHysteresis) {
  const auto commands = Commands({.rounding = Rounding::kHysteresis, .hysteresis_counts = 0.5},
                                 {500.4, 500.9, 501.0, 501.1, 500.2, 500.0});
  EXPECT_EQ(commands, std::vector<std::int32_t>({500, 500, 500, 501, 501, 501}));
}

TEST(MotorRounding, LimitsTheSpeedFromTheCenterOn) {
  // 100 counts per rad, 50 events per second, 5 rad/s: 10 counts per event.
  const auto commands =
      Commands({.speed_limit_rad_s = 5.0}, {545.0, 545.0, 545.0, 545.0, 545.0, 400.0});
  EXPECT_EQ(commands, std::vector<std::int32_t>({522, 532, 542, 545, 545, 535}));
}

TEST(MotorRounding, LimitsTheSpeedOfAMotorThatTurnsTheOtherWay) {
  TendonTransmission hand = CoupledHand(1);
  hand.counts_per_rad = {-100.0};
  MotorRounding rounding({.speed_limit_rad_s = 5.0}, hand, kEventsPerSecond);
  const double exact[] = {545.0, 400.0};
  std::int32_t command = 0;
  rounding.Step({&exact[0], 1}, {&command, 1});
  EXPECT_EQ(command, 522);
  rounding.Step({&exact[1], 1}, {&command, 1});
  EXPECT_EQ(command, 512);
}

TEST(MotorRounding, LimitsTheSpeedFromWhereTheMotorsAre) {
  MotorRounding rounding({.speed_limit_rad_s = 5.0}, CoupledHand(1), kEventsPerSecond);
  const double exact = 745.0;
  std::int32_t command = 700;
  rounding.Reset({&command, 1});
  rounding.Step({&exact, 1}, {&command, 1});
  EXPECT_EQ(command, 710);
  rounding.Reset();  // the motor is where it was sent
  rounding.Step({&exact, 1}, {&command, 1});
  EXPECT_EQ(command, 720);
}

TEST(MotorRounding, StaysInTheMotorsRangeInEveryMode) {
  for (const Rounding rounding :
       {Rounding::kNearest, Rounding::kHysteresis, Rounding::kNoiseShaping}) {
    for (const double end : {0.0, 1023.0}) {
      const std::vector<double> exact(100, end);
      for (const std::int32_t command :
           Commands({.rounding = rounding, .speed_limit_rad_s = 0.0}, exact)) {
        EXPECT_EQ(command, end);
      }
    }
  }
}

}  // namespace
}  // namespace gauntlet::controller
