#include "controller/loop_watch.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "controller/controller.h"
#include "controller/settings.h"
#include "tests/controller/test_hand.h"

namespace gauntlet::controller {
namespace {

Controller MadeFor(double tick_rate_hz) {
  return {{}, PlainGlove(3), CoupledHand(3), {.tick_rate_hz = tick_rate_hz}};
}

TEST(LoopWatch, CountsStepsThatComeLate) {
  Controller controller = MadeFor(1000.0);
  for (int tick = 0; tick < 1000; ++tick) {
    const bool is_late = tick % 100 == 99;
    controller.TakeElapsedTime(is_late ? 3.2 : 0.97);
    const Command command = controller.Step();
    EXPECT_EQ(command.loop, is_late ? LoopStatus::kOverrun : LoopStatus::kInTime) << tick;
  }
  EXPECT_EQ(controller.overruns(), 10);
  controller.Reset();
  EXPECT_EQ(controller.overruns(), 0);
  EXPECT_TRUE(std::isnan(controller.measured_tick_rate_hz()));
}

TEST(LoopWatch, ReportsALoopOfAnotherRate) {
  // The file says 1080 Hz, as of a glove of 90 Hz; the loop is one of 1000 Hz.
  Controller controller = MadeFor(1080.0);
  Command command;
  for (int tick = 0; tick < 256; ++tick) {
    EXPECT_EQ(command.loop, LoopStatus::kInTime);
    controller.TakeElapsedTime(1.0);
    command = controller.Step();
  }
  EXPECT_EQ(command.loop, LoopStatus::kWrongRate);
  EXPECT_NEAR(controller.measured_tick_rate_hz(), 1000.0, 1e-9);
  EXPECT_EQ(controller.overruns(), 0);
  Controller next = controller.Prepare({});
  EXPECT_TRUE(controller.Swap(next));
  EXPECT_EQ(controller.Step().loop, LoopStatus::kWrongRate) << "a swap keeps it";
}

TEST(LoopWatch, TakesALoopThatMeasuresNothingForOneInTime) {
  Controller controller = MadeFor(1000.0);
  for (int tick = 0; tick < 600; ++tick) {
    for (const double none : {0.0, -1.0, std::nan("")}) controller.TakeElapsedTime(none);
    EXPECT_EQ(controller.Step().loop, LoopStatus::kInTime);
  }
}

TEST(LoopWatch, BearsJitterOfTheRightRate) {
  Controller controller = MadeFor(1000.0);
  for (int tick = 0; tick < 1000; ++tick) {
    controller.TakeElapsedTime(tick % 3 == 0 ? 1.4 : 0.8);
    EXPECT_EQ(controller.Step().loop, LoopStatus::kInTime);
  }
}

TEST(Timing, OfAnotherLoopKeepsTheRateOfTheGlove) {
  const Timing sim{.tick_rate_hz = 1080.0, .ticks_per_sample = 12};
  const Timing robot = WithTickRate(sim, 1000.0);
  EXPECT_EQ(robot.tick_rate_hz, 1000.0);
  EXPECT_EQ(robot.ticks_per_sample, 11);
  EXPECT_EQ(robot.sample_rate_hz(), 90.0);
  EXPECT_EQ(robot.event_period_ms, sim.event_period_ms);
  const Timing whole = WithTickRate(sim, 900.0);
  EXPECT_EQ(whole.ticks_per_sample, 10);
  EXPECT_EQ(whole.glove_rate_hz, 0.0) << "needs none";
  EXPECT_THROW(WithTickRate(sim, 80.0), SettingError);
  EXPECT_THROW(WithTickRate(sim, std::nan("")), SettingError);
  Timing wrong = robot;
  wrong.glove_rate_hz = 200.0;
  EXPECT_THROW(Controller({}, PlainGlove(3), CoupledHand(3), wrong), SettingError);
}

}  // namespace
}  // namespace gauntlet::controller
