#include "sim/live/target_scores.h"

#include <array>
#include <cstddef>

#include "sim/trial/latency_of_trace.h"

namespace gauntlet::sim {

namespace {

/// Scores of one joint after the other, which takes little memory beside a running session.
Scores ScoreJoints(const TargetScoring& scoring, const AskedAngles& controller,
                   std::span<const std::size_t> metrics) {
  Scores scores;
  scores.summary.assign(Metrics().size(), 0.0);
  for (std::size_t joint = 0; joint < scoring.joints.size(); ++joint) {
    const std::vector<int> column = {scoring.joints[joint]};
    const Columns reference(*controller.reference_rad, column);
    const Columns asked(*controller.asked_rad, column);
    CountedParts counted;
    ScoreInput input;
    if (controller.counted != nullptr) {
      counted.joints = {(*controller.counted)[joint]};
      input.counted = &counted;
    }
    input.rate_hz = scoring.rate_hz;
    input.reference_angle_rad = &*reference;
    input.hand_angle_rad = &*asked;
    input.earliest_delay_s = controller.earliest_delay_s;
    input.jitter_above_hz = scoring.jitter_above_hz;
    const std::vector<std::string> name = {std::to_string(joint)};
    scores.channels.push_back(ComputeScores(input, ScoreRows(name, {}, {}), metrics).channels[0]);
    TrimSignals();
  }
  return scores;  // the summaries are those of UseCommonParts()
}

}  // namespace

std::vector<TargetScores> ScoreTargets(const TargetScoring& scoring,
                                       std::span<const AskedAngles> controllers) {
  const std::size_t jitter = MetricIndex("jitter_rms_deg");
  const std::size_t delay = MetricIndex("delay_ms");
  const std::size_t tracking = MetricIndex("tracking_rmse_deg");
  const std::array wanted = {jitter, delay, tracking};
  std::vector<Scores> scores;
  for (const AskedAngles& controller : controllers) {
    scores.push_back(ScoreJoints(scoring, controller, wanted));
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
