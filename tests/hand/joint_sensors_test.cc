#include "sim/hand/joint_sensors.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "sim/base/signal.h"

namespace gauntlet::sim {
namespace {

constexpr controller::Timing kTiming;  // ticks of 1 ms

JointSensorsConfig Exact() {
  return {.kind = JointSensorsKind::kEncoder, .resolution_bits = 24, .noise_deg = 0.0};
}

TEST(JointSensors, ReadAtTheirRateAndTellAfterTheirDelay) {
  JointSensorsConfig config = Exact();
  config.rate_hz = 100.0;
  config.delay_ms = 7.0;
  JointSensors sensors(config, kTiming, 2);
  for (int run = 0; run < 2; ++run) {
    for (int tick = 0; tick < 200; ++tick) {
      const double angle_rad[] = {1e-3 * tick, -1e-3 * tick};
      const auto reading = sensors.Step(angle_rad);
      const bool due = tick >= 7 && (tick - 7) % 10 == 0;
      ASSERT_EQ(!reading.empty(), due) << tick;
      if (!due) continue;
      EXPECT_NEAR(reading[0], 1e-3 * (tick - 7), 1e-6);
      EXPECT_NEAR(reading[1], -1e-3 * (tick - 7), 1e-6);
    }
    sensors.Reset();
  }
  config.delay_ms = 0.0;
  config.rate_hz = 10000.0;  // no more often than there are ticks
  JointSensors quick(config, kTiming, 1);
  for (double angle_rad : {0.1, 0.2, 0.3}) {
    EXPECT_NEAR(quick.Step({&angle_rad, 1})[0], angle_rad, 1e-6);
  }
}

TEST(JointSensors, RoundToStepsOfATurnAndHaveTheirNoise) {
  JointSensorsConfig config = Exact();
  config.resolution_bits = 10;
  config.rate_hz = 1000.0;
  config.delay_ms = 0.0;
  JointSensors coarse(config, kTiming, 1);
  const double step_rad = 2.0 * std::numbers::pi / 1024;
  for (double angle_rad : {-1.0, 0.0, 0.777}) {
    const double reading = coarse.Step({&angle_rad, 1})[0] / step_rad;
    EXPECT_NEAR(reading, std::round(angle_rad / step_rad), 1e-9);
  }
  config = Exact();
  config.rate_hz = 1000.0;
  config.delay_ms = 0.0;
  config.noise_deg = 0.2;
  JointSensors noisy(config, kTiming, 2);
  double squares = 0.0, products = 0.0, first = 0.0;
  for (int k = 0; k < 10000; ++k) {
    const double still[] = {0.5, 0.5};
    const auto reading = noisy.Step(still);
    const double error[] = {(reading[0] - 0.5) * kDegPerRad, (reading[1] - 0.5) * kDegPerRad};
    if (k == 0) first = error[0];
    squares += error[0] * error[0] / 10000;
    products += error[0] * error[1] / 10000;
  }
  EXPECT_NEAR(std::sqrt(squares), 0.2, 0.006);
  EXPECT_NEAR(products, 0.0, 0.002) << "each joint has noise of its own";
  noisy.Reset();
  const double still[] = {0.5, 0.5};
  EXPECT_EQ((noisy.Step(still)[0] - 0.5) * kDegPerRad, first);
}

TEST(JointSensors, AreNotThereByDefault) {
  JointSensors none({}, kTiming, 1);
  const double angle_rad = 0.3;
  for (int tick = 0; tick < 100; ++tick) EXPECT_TRUE(none.Step({&angle_rad, 1}).empty());
}

}  // namespace
}  // namespace gauntlet::sim
