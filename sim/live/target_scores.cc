#include "sim/live/target_scores.h"

#include <array>
#include <cstddef>

#include "sim/trial/latency_of_trace.h"

namespace gauntlet::sim {

namespace {

/// The summaries are those of UseCommonParts().
Scores ScoreJoints(const TargetScoring& scoring, const AskingController& controller,
                   std::span<const std::size_t> metrics) {
  Scores scores;
  scores.summary.assign(Metrics().size(), 0.0);
  const std::vector<std::string> name = {"joint"};
  const ScoreRows row(name, {}, {});
  for (std::size_t joint = 0; joint < scoring.joints.size(); ++joint) {
    const AskedAngle angle = controller.joint(joint);
    CountedParts counted;
    counted.joints = {angle.counted};
    ScoreInput input;
    input.rate_hz = scoring.rate_hz;
    input.reference_angle_rad = &angle.reference_rad;
    input.hand_angle_rad = &angle.asked_rad;
    input.counted = &counted;
    input.earliest_delay_s = controller.earliest_delay_s;
    input.jitter_above_hz = scoring.jitter_above_hz;
    scores.channels.push_back(ComputeScores(input, row, metrics).channels[0]);
    TrimSignals();
  }
  return scores;
}

}  // namespace

std::vector<TargetScores> ScoreTargets(const TargetScoring& scoring,
                                       std::span<const AskingController> controllers) {
  const std::size_t jitter = MetricIndex("jitter_rms_deg");
  const std::size_t delay = MetricIndex("delay_ms");
  const std::size_t tracking = MetricIndex("tracking_rmse_deg");
  const std::array wanted = {jitter, delay, tracking};
  std::vector<Scores> scores;
  for (const AskingController& controller : controllers) {
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
