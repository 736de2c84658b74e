// A glove that says nothing any more, and loops that are not what Timing says.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "controller/angle.h"
#include "controller/controller.h"
#include "controller/number.h"
#include "tests/controller/allocation_counter.h"
#include "tests/controller/test_hand.h"

namespace gauntlet::controller {
namespace {

using testing::Each;

constexpr int kWatched = 3;

/// A hand that leads by 50 ms, and counts that rise by 1 per sample.
ControllerConfig LeadingConfig() {
  ControllerConfig config;
  config.prediction.settings = LinearPredictionConfig{};
  config.untrusted.stuck_after_ms = 0.0;
  return config;
}

Controller MakeWatched(const ControllerConfig& config,
                       const Timing& timing = {.event_period_ms = 1.0}) {
  return Controller(config, PlainGlove(kWatched), CoupledHand(kWatched), timing);
}

Command RiseCounts(Controller& controller, int samples, double from = 400.0) {
  Command command;
  for (int k = 0; k < samples; ++k) {
    const std::vector<double> counts(kWatched, from + k);
    command = controller.Step({.counts = counts});
  }
  return command;
}

TEST(DeadGlove, IsCountedAndReportedAndMovesNothingByDefault) {
  Controller controller = MakeWatched(LeadingConfig());
  Command command = RiseCounts(controller, 100);
  EXPECT_EQ(command.glove, GloveStatus::kGood);
  EXPECT_EQ(controller.sample_age_ms(1), 0.0);
  const std::vector<double> before(controller.target_angle_rad().begin(),
                                   controller.target_angle_rad().end());
  const long allocations = AllocationCount();
  for (int k = 0; k < 1000; ++k) command = controller.Step();
  EXPECT_EQ(AllocationCount(), allocations);
  EXPECT_EQ(command.glove, GloveStatus::kHeld);
  EXPECT_EQ(controller.sample_age_ms(1), 1000.0);
  EXPECT_THAT(controller.untrusted_samples(Untrusted::kMissing), Each(1000));
  EXPECT_THAT(controller.untrusted_samples(), Each(1000));
  EXPECT_THAT(controller.target_angle_rad(), testing::ElementsAreArray(before));
  EXPECT_TRUE(std::isnan(controller.sample_age_ms(kWatched)));

  command = RiseCounts(controller, 1, 500.0);
  EXPECT_EQ(command.glove, GloveStatus::kGood);
  EXPECT_EQ(controller.sample_age_ms(1), 0.0);
  controller.Reset();
  EXPECT_THAT(controller.untrusted_samples(), Each(0));
}

TEST(DeadGlove, IsNoticedBeforeItsFirstSample) {
  Controller controller = MakeWatched(LeadingConfig());
  EXPECT_EQ(controller.Step().glove, GloveStatus::kHeld);
  EXPECT_THAT(controller.untrusted_samples(Untrusted::kMissing), Each(1));
}

TEST(LateSamples, AreNotMissingUntilHalfTheirPeriodHasPassed) {
  const Timing timing = {.ticks_per_sample = 10, .event_period_ms = 1.0};
  Controller controller = MakeWatched(LeadingConfig(), timing);
  const std::vector<double> counts(kWatched, 400.0);
  int next = 0;  // tick of the next sample: up to 4 ticks late, never early
  for (int tick = 0; tick < 2000; ++tick) {
    const bool fresh = tick == next;
    if (fresh) next = 10 * (tick / 10 + 1) + 3 * (tick / 10) % 5;
    const Command command = fresh ? controller.Step({.counts = counts}) : controller.Step();
    ASSERT_EQ(command.glove, GloveStatus::kGood) << tick;
  }
  EXPECT_THAT(controller.untrusted_samples(), Each(0));
  controller.Step({.counts = counts});
  for (int tick = 1; tick <= 100; ++tick) controller.Step();
  // Overdue after 15, 25, .. 95 ticks.
  EXPECT_THAT(controller.untrusted_samples(Untrusted::kMissing), Each(9));
}

TEST(Samples, ThatComeTooOftenAreNoticed) {
  const Timing timing = {.ticks_per_sample = 10, .event_period_ms = 1.0};
  const std::vector<double> counts(kWatched, 500.0);
  for (const int period : {1, 7, 8, 10}) {
    Controller controller = MakeWatched(LeadingConfig(), timing);
    Command command;
    for (int tick = 0; tick < 2000; ++tick) {
      command = tick % period == 0 ? controller.Step({.counts = counts}) : controller.Step();
    }
    EXPECT_EQ(command.glove, period < 8 ? GloveStatus::kTooOften : GloveStatus::kGood) << period;
  }
}

TEST(LostChannels, LetGoOfThePredictionAndHoldTheLastValue) {
  ControllerConfig config = LeadingConfig();
  config.untrusted.lost_after_ms = 100.0;
  config.untrusted.lost_speed_deg_s = 20.0;
  Controller controller = MakeWatched(config);
  RiseCounts(controller, 100);
  const double last_rad = controller.linearised_angle_rad()[0];
  double angle_rad = controller.target_angle_rad()[0];
  EXPECT_GT(angle_rad - last_rad, 0.05) << "the prediction leads";
  for (int k = 1; k <= 1000; ++k) {
    const Command command = controller.Step();
    EXPECT_EQ(command.glove, k < 100 ? GloveStatus::kHeld : GloveStatus::kLost) << k;
    const double moved_rad = controller.target_angle_rad()[0] - angle_rad;
    angle_rad += moved_rad;
    if (k < 100) {
      EXPECT_EQ(moved_rad, 0.0) << k;
    }
    EXPECT_LE(std::abs(moved_rad), 20.0 * kRadPerDeg * 1e-3 + 1e-12) << k;
  }
  EXPECT_NEAR(angle_rad, last_rad, 1e-12);
}

TEST(LostChannels, GoToTheReferencePostureAndComeBack) {
  ControllerConfig config = LeadingConfig();
  config.untrusted.lost_after_ms = 50.0;
  config.untrusted.when_lost = WhenLost::kRest;
  config.untrusted.lost_speed_deg_s = 60.0;
  for (const bool planned : {false, true}) {
    if (planned) {
      config.model_predictive.kind = ModelPredictiveKind::kSecondOrder;
      config.prediction.settings = AdaptivePredictionConfig{};
    }
    Controller controller = MakeWatched(config, {});
    RiseCounts(controller, 200);
    // One channel alone: its joint rests, the others follow.
    for (int k = 0; k < 2000; ++k) {
      const std::vector<double> counts = {600.0 + 0.01 * k, kNaN, 600.0 + 0.01 * k};
      controller.Step({.counts = counts});
    }
    EXPECT_NEAR(controller.target_angle_rad()[1], 0.0, 1e-9) << planned;
    EXPECT_NEAR(controller.target_angle_rad()[0], 1.05, 0.02) << planned;
    EXPECT_EQ(controller.sample_age_ms(1), 2000.0);
    EXPECT_EQ(controller.sample_age_ms(0), 0.0);
    Command command;
    for (int k = 0; k < 2000; ++k) {
      const std::vector<double> counts(kWatched, 620.0 + 0.01 * k);
      command = controller.Step({.counts = counts});
    }
    EXPECT_EQ(command.glove, GloveStatus::kGood);
    EXPECT_NEAR(controller.target_angle_rad()[1], 1.1, 0.02) << planned;
    // The whole glove: all motors at their centers.
    for (int k = 0; k < 5000; ++k) command = controller.Step();
    EXPECT_EQ(command.glove, GloveStatus::kLost);
    EXPECT_THAT(command.motor_counts, Each(512)) << planned;
  }
}

TEST(LostChannels, ThatAreSwitchedOffAreNotReported) {
  ControllerConfig config = LeadingConfig();
  config.untrusted.lost_after_ms = 50.0;
  config.untrusted.when_lost = WhenLost::kRest;
  Controller controller = MakeWatched(config);
  RiseCounts(controller, 100);
  controller.SetChannelActive(1, false);
  const double held_rad = controller.target_angle_rad()[1];
  Command command;
  for (int k = 0; k < 500; ++k) {
    const std::vector<double> counts = {500.0 + 0.01 * k, kNaN, 500.0};
    command = controller.Step({.counts = counts});
  }
  EXPECT_EQ(command.glove, GloveStatus::kGood);
  EXPECT_NEAR(controller.target_angle_rad()[1], held_rad, 1e-12);
}

TEST(LostChannels, KeepTheirClockOverASwap) {
  ControllerConfig config = LeadingConfig();
  Controller controller = MakeWatched(config);
  RiseCounts(controller, 100);
  for (int k = 0; k < 80; ++k) controller.Step();
  config.untrusted.lost_after_ms = 100.0;
  controller.Load(config);
  EXPECT_EQ(controller.sample_age_ms(0), 80.0);
  for (int k = 81; k < 100; ++k) EXPECT_EQ(controller.Step().glove, GloveStatus::kHeld) << k;
  EXPECT_EQ(controller.Step().glove, GloveStatus::kLost);
}

}  // namespace
}  // namespace gauntlet::controller
