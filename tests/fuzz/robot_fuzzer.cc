// The settings of a robot as its program in C reads them, from a text that somebody changed by hand
// (see edited_copy.h). What they make has to step, and keeps its motors in their ranges.
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <string_view>
#include <vector>

#include "controller/c_api/gauntlet_controller.h"
#include "controller/robot_text.h"
#include "sim/settings/robot_constants.h"
#include "tests/controller/test_hand.h"
#include "tests/fuzz/edited_copy.h"

namespace gauntlet::controller {
namespace {

std::string GoodText() {
  RobotConfig robot;
  robot.glove = PlainGlove(2);
  robot.hand = CoupledHand(2);
  robot.controller.filters = {{HampelConfig{}}, {KalmanConfig{.noise = {.r = {15.0}}}}};
  robot.controller.motor.rounding = Rounding::kHysteresis;
  robot.timing = {.tick_rate_hz = 1000.0, .ticks_per_sample = 2, .event_period_ms = 3.0};
  return sim::RobotToText(robot, {});
}

void Run(const std::string& text) {
  std::array<char, 200> error = {'x'};
  const std::unique_ptr<gauntlet_controller, decltype(&gauntlet_controller_destroy)> made(
      gauntlet_controller_create(text.data(), text.size(), error.data(), error.size()),
      gauntlet_controller_destroy);
  const std::string_view problem = error.data();
  if ((made == nullptr) == problem.empty() || problem.find('\n') != std::string_view::npos) {
    std::abort();
  }
  if (made == nullptr) return;
  const RobotConfig robot = RobotFromText(text);
  const std::size_t channels = gauntlet_controller_channel_count(made.get());
  std::vector<std::int32_t> motors(gauntlet_controller_motor_count(made.get()));
  std::vector<double> counts(channels);
  for (int tick = 0; tick < 20; ++tick) {
    for (std::size_t c = 0; c < channels; ++c) {
      counts[c] = tick % 7 == 3 ? std::nan("") : 300.0 * (1 + (tick / 5 + c) % 3);
    }
    const bool fresh = tick % gauntlet_controller_ticks_per_sample(made.get()) == 0;
    const gauntlet_result result =
        gauntlet_controller_step(made.get(), fresh ? counts.data() : nullptr, fresh ? channels : 0,
                                 motors.data(), motors.size());
    if (result < 0) std::abort();
    for (std::size_t m = 0; m < motors.size(); ++m) {
      if (motors[m] < robot.hand.min_counts[m] || motors[m] > robot.hand.max_counts[m]) {
        std::abort();
      }
    }
  }
}

}  // namespace
}  // namespace gauntlet::controller

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const std::string good = gauntlet::controller::GoodText();
  gauntlet::controller::Run(gauntlet::sim::EditedCopy(good, data, size));
  return 0;
}
