#include "sim/live/target_scores.h"

#include <array>

#include "sim/trial/latency_of_trace.h"

namespace gauntlet::sim {

std::vector<TargetScores> ScoreTargets(const TargetScoring& scoring,
                                       std::span<const AskedAngles> controllers) {
  const std::size_t jitter = MetricIndex("jitter_rms_deg");
  const std::size_t delay = MetricIndex("delay_ms");
  const std::size_t tracking = MetricIndex("tracking_rmse_deg");
  const std::array wanted = {jitter, delay, tracking};
  const ScoreRows rows(scoring.joint_names, {}, {});
  std::vector<Scores> scores;
  for (const AskedAngles& controller : controllers) {
    const Columns reference(*controller.reference_rad, scoring.joints);
    const Columns asked(*controller.asked_rad, scoring.joints);
    ScoreInput input;
    input.rate_hz = scoring.rate_hz;
    input.reference_angle_rad = &*reference;
    input.hand_angle_rad = &*asked;
    CountedParts counted;
    if (controller.counted != nullptr) {
      counted.joints = *controller.counted;
      input.counted = &counted;
    }
    input.earliest_delay_s = controller.earliest_delay_s;
    input.jitter_above_hz = scoring.jitter_above_hz;
    scores.push_back(ComputeScores(input, rows, wanted));
  }
  std::vector<Scores*> trials;
  for (Scores& one : scores) trials.push_back(&one);
  UseCommonParts(trials);
  std::vector<TargetScores> result;
  for (const Scores& one : scores) {
    result.push_back({.jitter_rms_deg = one.summary[jitter],
                      .delay_ms = one.summary[delay],
                      .tracking_rmse_deg = one.summary[tracking]});
  }
  return result;
}

double EarliestAskedDelay_s(const HandModel& hand, const controller::ControllerConfig& controller) {
  const LoopTiming& timing = hand.timing();
  return EarliestDelay_s(hand, controller) - timing.event_delay_ticks / timing.tick_rate_hz();
}

}  // namespace gauntlet::sim
