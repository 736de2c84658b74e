#include "sim/trial/latency_of_trace.h"

#include <algorithm>
#include <cmath>
#include <variant>

#include "controller/prediction/horizon.h"

namespace gauntlet::sim {
namespace {

/// The low pass of the measurement reaches half a second to both sides; the rest must move.
constexpr double kShortest_s = 2.0;

double LongestHorizon_s(const controller::ControllerConfig& controller) {
  const std::vector<double>* const horizon_ms =
      std::visit([](const auto& settings) { return controller::HorizonOf(settings); },
                 controller.prediction.settings);
  return horizon_ms == nullptr ? 0.0 : 1e-3 * std::ranges::max(*horizon_ms);
}

}  // namespace

double EarliestDelay_s(const HandModel& hand, const controller::ControllerConfig& controller) {
  if (controller.model_predictive.kind != controller::ModelPredictiveKind::kNone) return 0.0;
  const LoopTiming& timing = hand.timing();
  return timing.event_delay_ticks / timing.tick_rate_hz() - LongestHorizon_s(controller);
}

std::optional<LatencyBudget> LatencyOfTrace(const HandModel& hand,
                                            const controller::ControllerConfig& controller,
                                            const Signal& reference_rad, const WayOfAngles& way,
                                            const Signal& hand_angle_rad,
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
  input.look_ahead_s = LongestHorizon_s(controller);
  input.earliest_delay_s = EarliestDelay_s(hand, controller);
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
