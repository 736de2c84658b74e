#include "sim/trial/latency_of_trace.h"

#include <cmath>

namespace gauntlet::sim {
namespace {

/// The low pass of the measurement reaches half a second to both sides; the rest must move.
constexpr double kShortest_s = 2.0;

}  // namespace

std::optional<LatencyBudget> LatencyOfTrace(const HandModel& hand, const Signal& reference_rad,
                                            const WayOfAngles& way, const Signal& hand_angle_rad,
                                            const std::optional<CountedParts>& counted) {
  const LoopTiming& timing = hand.timing();
  if (static_cast<double>(hand_angle_rad.rows()) < kShortest_s * timing.tick_rate_hz()) {
    return std::nullopt;
  }
  LatencyInput input;
  input.rate_hz = timing.tick_rate_hz();
  input.wearer_angle_rad = &reference_rad;
  input.raw_angle_rad = &way.raw;
  input.filtered_angle_rad = &way.filtered;
  input.target_angle_rad = &way.target;
  input.command_angle_rad = &way.command;
  input.hand_angle_rad = &hand_angle_rad;
  input.ticks_per_event = timing.controller.TicksOf(timing.controller.event_period_ms);
  if (counted) input.counted = &counted->joints;
  const ServoNumbers& servo = hand.config().servo.numbers();
  input.ticks_per_servo_frame = timing.controller.TicksOf(servo.frame_ms);
  // The servo's clock starts with the first command that arrives. Of those that run free, each has
  // its own phase: half a frame stands for all.
  const double late = servo.free_running ? 0.5 * input.ticks_per_servo_frame : 0.0;
  input.first_servo_frame = timing.event_delay_ticks + static_cast<int>(late);
  LatencyBudget budget = MeasureLatency(input);
  if (!std::isfinite(budget.total_ms)) return std::nullopt;
  return budget;
}

}  // namespace gauntlet::sim
