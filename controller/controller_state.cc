#include "controller/controller_state.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "controller/angle.h"
#include "controller/assert.h"

namespace gauntlet::controller {
namespace {

/// Throws for what does not fit together, before anything is built from it.
const ControllerConfig& Checked(const RobotConfig& robot, const ControllerConfig& config) {
  CheckSettings(config);
  WithinSetting("timing", [&] { CheckSettings(robot.timing); });
  const Timing& timing = robot.timing;
  const double ticks_per_sample = timing.tick_rate_hz / timing.sample_rate_hz();
  if (std::abs(ticks_per_sample - timing.ticks_per_sample) > 0.5 + 1e-9) {
    throw SettingError("timing.glove_rate_hz",
                       "is " + NumberText(timing.glove_rate_hz) + ", which is a sample at every " +
                           NumberText(ticks_per_sample) + " steps, must be that of " +
                           "ticks_per_sample, " + std::to_string(timing.ticks_per_sample));
  }
  const GloveCalibration& glove = robot.glove;
  if (glove.frame_number_bits < kLeastFrameNumberBits ||
      glove.frame_number_bits > kMostFrameNumberBits) {
    throw SettingError("calibration.frame_number_bits",
                       "is " + std::to_string(glove.frame_number_bits) + ", must be from " +
                           std::to_string(kLeastFrameNumberBits) + " to " +
                           std::to_string(kMostFrameNumberBits));
  }
  CheckNames("calibration.channel_names", glove.channel_names);
  if (glove.low_counts.size() != glove.channel_names.size()) {
    throw SettingError("calibration", "has " + std::to_string(glove.channel_names.size()) +
                                          " names of channels and " +
                                          std::to_string(glove.low_counts.size()) +
                                          " poses, must have one for each");
  }
  ConvertersOf(glove);
  return config;
}

/// A joint loop takes the command for what the joint shall do; a planned one leads it.
void CheckPlanned(const ControllerConfig& config) {
  const JointLoopConfig& loop = config.joint_loop;
  if (config.model_predictive.kind == ModelPredictiveKind::kNone ||
      loop.kind == JointLoopKind::kNone ||
      (loop.proportional == 0.0 && loop.integral_per_s == 0.0)) {
    return;
  }
  throw SettingError("joint_loop.kind",
                     "pi with proportional or integral_per_s above 0 does not go with "
                     "model_predictive, which plans commands ahead of the joint");
}

}  // namespace

Controller::State::State(const RobotConfig& connected_to, const ControllerConfig& config)
    : filter_at(Checked(connected_to, config).filter_at),
      joint_map(WithinSetting("joint_map",
                              [&] {
                                return JointMap(connected_to.joint_map,
                                                connected_to.glove.channel_names,
                                                connected_to.hand);
                              })),
      guard(config.untrusted, connected_to.glove.low_counts, ConvertersOf(connected_to.glove),
            connected_to.timing.sample_rate_hz(), connected_to.glove.frame_number_bits),
      watch(config.untrusted, connected_to.timing, joint_map.channel_count()),
      loop(connected_to.timing),
      tendon_map(connected_to.hand, config.coupling_compensation),
      model_predictive(WithinSetting("model_predictive",
                                     [&] {
                                       return ModelPredictive(config.model_predictive,
                                                              connected_to.hand,
                                                              connected_to.timing.event_rate_hz());
                                     })),
      estimator(connected_to, config, model_predictive.path_length()),
      joint_loop(WithinSetting("joint_loop",
                               [&] {
                                 return JointLoop(config.joint_loop, connected_to.hand,
                                                  connected_to.timing.event_rate_hz());
                               })),
      rounding(config.motor, connected_to.hand, connected_to.timing.event_rate_hz()),
      when_lost(config.untrusted.when_lost),
      lost_step_rad(config.untrusted.lost_speed_deg_s * kRadPerDeg /
                    connected_to.timing.event_rate_hz()),
      rest_rad(estimator.middle_rad().begin(), estimator.middle_rad().end()),
      event_clock(connected_to.timing.TicksOf(connected_to.timing.event_period_ms)),
      linearised_rad(connected_to.glove.channel_names.size()),
      start_counts(linearised_rad.size()),
      lost(linearised_rad.size()),
      lost_rad(linearised_rad.size()),
      target_rad(connected_to.hand.reference_angle_rad),
      path_rad(static_cast<std::size_t>(model_predictive.path_length()) * target_rad.size()),
      planned_rad(target_rad),
      corrected_rad(target_rad),
      sent_rad(target_rad),
      exact_motor_counts(connected_to.hand.counts_per_rad.size()),
      motor_counts(connected_to.hand.center_counts.begin(), connected_to.hand.center_counts.end()) {
  CheckPlanned(config);
  joint_map.ToChannels(tendon_map.reference_angle_rad(), rest_rad);
  Reset(motor_counts);
}

Command Controller::State::Step(const GloveSample* sample) noexcept {
  const LoopStatus loop_status = loop.Tick();
  const bool overdue = watch.Tick(sample != nullptr);
  if (sample != nullptr) AcceptSample(*sample);
  if (overdue) guard.Miss();
  judged = overdue || sample != nullptr;
  const bool event = StepEvent();
  return {.motor_counts = motor_counts, .event = event, .glove = Status(), .loop = loop_status};
}

GloveStatus Controller::State::Status() const noexcept {
  GloveStatus status = watch.too_often() ? GloveStatus::kTooOften : GloveStatus::kGood;
  if (guard.all_trusted() && !watch.on()) return status;
  for (std::size_t i = 0; i < lost.size(); ++i) {
    if (!estimator.channel_active(static_cast<int>(i))) continue;
    if (watch.lost(i)) return GloveStatus::kLost;
    if (!guard.trusted(i)) status = std::max(status, GloveStatus::kHeld);
  }
  return status;
}

void Controller::State::MoveLostChannels() noexcept {
  for (std::size_t i = 0; i < lost.size(); ++i) {
    const int channel = static_cast<int>(i);
    if (!watch.lost(i) || !estimator.channel_active(channel)) {
      lost[i] = 0;
      continue;
    }
    if (lost[i] == 0) lost_rad[i] = estimator.predicted_rad()[i];
    lost[i] = 1;
    const double goal_rad = when_lost == WhenLost::kHold ? linearised_rad[i] : rest_rad[i];
    lost_rad[i] += std::clamp(goal_rad - lost_rad[i], -lost_step_rad, lost_step_rad);
    estimator.Place(channel, lost_rad[i]);
  }
}

void Controller::State::AcceptSample(const GloveSample& sample) noexcept {
  guard.Step(sample, [this](int channel) { estimator.StartChannel(channel); });
  watch.ReadResults(guard);
  if (watch.on()) {  // what was lost and is back starts anew
    for (std::size_t i = 0; i < lost.size(); ++i) {
      if (lost[i] == 0 || !guard.trusted(i)) continue;
      lost[i] = 0;
      estimator.StartChannel(static_cast<int>(i));
    }
  }
  estimator.linearisation().ToAngles(guard.trusted_counts(), linearised_rad);
  if (filter_at == FilterAt::kSample) StepFilters();
}

bool Controller::State::StepEvent() noexcept {
  const bool event = event_clock.Tick();
  if (event) {
    if (filter_at == FilterAt::kEvent) StepFilters();
    if (watch.on()) MoveLostChannels();
    joint_map.ToJoints(estimator.predicted_rad(), target_rad);
    if (model_predictive.on()) PlanCommands();
    const std::vector<double>& wanted_rad = model_predictive.on() ? planned_rad : target_rad;
    if (joint_loop.on()) joint_loop.Step(wanted_rad, corrected_rad);
    const std::vector<double>& command_rad = joint_loop.on() ? corrected_rad : wanted_rad;
    tendon_map.ToExactMotorCounts(command_rad, exact_motor_counts);
    rounding.Step(exact_motor_counts, motor_counts);
    if (model_predictive.on()) {
      tendon_map.ToJointAngles(motor_counts, sent_rad);
      model_predictive.Sent(command_rad, sent_rad);
    }
  }
  return event;
}

void Controller::State::PlanCommands() noexcept {
  const std::size_t joints = target_rad.size();
  const MotionPath& path = estimator.path();
  for (int row = 0; row < path.row_count(); ++row) {
    joint_map.ToJoints(path.Row(row),
                       {path_rad.data() + static_cast<std::size_t>(row) * joints, joints});
  }
  model_predictive.Step(path_rad, planned_rad);
}

void Controller::State::Reset(std::span<const std::int32_t> at_counts) noexcept {
  GAUNTLET_ASSERT(at_counts.size() == motor_counts.size());
  std::copy(at_counts.begin(), at_counts.end(), motor_counts.begin());
  rounding.Reset(motor_counts);
  tendon_map.ToJointAngles(motor_counts, target_rad);
  const std::span<const double> reference_rad = tendon_map.reference_angle_rad();
  for (std::size_t i = 0; i < target_rad.size(); ++i) {
    if (std::isnan(target_rad[i])) target_rad[i] = reference_rad[i];  // springs decide it
  }
  estimator.MoveTo(joint_map, target_rad);
  Reset();
}

void Controller::State::Reset() noexcept {
  estimator.ToCounts(start_counts);
  guard.Reset(start_counts);
  watch.Reset();
  loop.Reset();
  judged = false;
  std::fill(lost.begin(), lost.end(), std::uint8_t{0});
  estimator.Reset(guard.trusted_counts());
  estimator.linearisation().ToAngles(guard.trusted_counts(), linearised_rad);
  rounding.Reset();
  event_clock.Reset();
  joint_map.ToJoints(estimator.predicted_rad(), target_rad);
  model_predictive.Reset(target_rad);
  joint_loop.Reset(target_rad);
}

void Controller::State::SwapMemory(State& before) noexcept {
  GAUNTLET_ASSERT(before.start_counts.size() == start_counts.size());
  GAUNTLET_ASSERT(before.target_rad.size() == target_rad.size());
  GAUNTLET_ASSERT(before.motor_counts.size() == motor_counts.size());
  estimator.linearisation().ToCounts(before.estimator.filtered_rad(), start_counts);
  guard.SwapMemory(before.guard, start_counts);
  watch.SwapMemory(before.watch);
  std::swap(loop, before.loop);
  std::swap(judged, before.judged);
  lost.swap(before.lost);
  lost_rad.swap(before.lost_rad);
  if (!watch.on()) std::fill(lost.begin(), lost.end(), std::uint8_t{0});
  estimator.SwapMemory(before.estimator, start_counts);
  model_predictive.SwapMemory(before.model_predictive, before.target_rad);
  joint_loop.SwapMemory(before.joint_loop, before.target_rad);
  rounding.SwapMemory(before.rounding);
  std::swap(event_clock, before.event_clock);
  linearised_rad.swap(before.linearised_rad);
  target_rad.swap(before.target_rad);
  motor_counts.swap(before.motor_counts);
}

}  // namespace gauntlet::controller
