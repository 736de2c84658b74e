#include "controller/controller_state.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "controller/prediction/predictor.h"

namespace gauntlet::controller {
namespace {

const ControllerConfig& Checked(const ControllerConfig& config) {
  CheckSettings(config);
  return config;
}

/// Throws for what does not fit together, before anything is built from it.
const RobotConfig& Checked(const RobotConfig& robot) {
  WithinSetting("timing", [&] { CheckSettings(robot.timing); });
  const GloveCalibration& glove = robot.glove;
  if (!(glove.full_scale_counts > 0.0) || !std::isfinite(glove.full_scale_counts)) {
    throw SettingError("calibration.full_scale_counts", "must be finite and above 0");
  }
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
  return robot;
}

/// The middle of each channel's two known poses.
std::vector<double> MiddleOf(const GloveCalibration& glove) {
  std::vector<double> middle_rad;
  for (std::size_t i = 0; i < glove.low_angle_rad.size(); ++i) {
    middle_rad.push_back(0.5 * (glove.low_angle_rad[i] + glove.high_angle_rad[i]));
  }
  return middle_rad;
}

/// The paper's R is in counts; a filter of angles that is not given another one would be far off.
void CheckUnitOfR(const FilterConfig& filter, FilterOn filter_on) {
  if (filter_on == FilterOn::kCounts) return;
  const std::vector<double>* r = std::visit(
      [](const auto& settings) { return MeasurementVarianceOf(settings); }, filter.settings);
  if (r == nullptr || !IsDefaultMeasurementVariance(*r)) return;
  throw SettingError("r",
                     "must be given with filter_on angle, in rad^2: the default is the paper's, in "
                     "counts^2");
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

/// How often filters step.
double StepRate(const ControllerConfig& config, const Timing& timing) {
  return config.filter_at == FilterAt::kSample ? timing.sample_rate_hz() : timing.event_rate_hz();
}

}  // namespace

Controller::State::State(const RobotConfig& robot, const ControllerConfig& config)
    : filter_on(Checked(config).filter_on),
      filter_at(config.filter_at),
      step_rate_hz(StepRate(config, Checked(robot).timing)),
      linearisation(
          MakeLinearisation(config.linearisation, robot.glove, robot.glove.channel_names)),
      joint_map(WithinSetting(
          "joint_map",
          [&] { return JointMap(robot.joint_map, robot.glove.channel_names, robot.hand); })),
      guard(config.untrusted, robot.glove.low_counts, robot.glove.full_scale_counts,
            robot.timing.sample_rate_hz(), robot.glove.frame_number_bits),
      tendon_map(robot.hand, config.coupling_compensation),
      model_predictive(WithinSetting("model_predictive",
                                     [&] {
                                       return ModelPredictive(config.model_predictive, robot.hand,
                                                              robot.timing.event_rate_hz());
                                     })),
      path(WithinSetting("prediction",
                         [&] {
                           return MotionPath(config.prediction, linearisation->channel_count(),
                                             step_rate_hz, model_predictive.path_length(),
                                             robot.timing.event_period_ms);
                         })),
      joint_loop(WithinSetting(
          "joint_loop",
          [&] { return JointLoop(config.joint_loop, robot.hand, robot.timing.event_rate_hz()); })),
      rounding(config.motor, robot.hand, robot.timing.event_rate_hz()),
      event_clock(robot.timing.TicksOf(robot.timing.event_period_ms)),
      active(robot.glove.channel_names.size(), 1),
      middle_rad(MiddleOf(robot.glove)),
      linearised_rad(active.size()),
      filtered_counts(active.size()),
      filtered_rad(active.size()),
      predicted_rad(active.size()),
      held_rad(active.size()),
      target_rad(robot.hand.reference_angle_rad),
      path_rad(static_cast<std::size_t>(model_predictive.path_length()) * target_rad.size()),
      planned_rad(target_rad),
      corrected_rad(target_rad),
      sent_rad(target_rad),
      exact_motor_counts(robot.hand.counts_per_rad.size()),
      motor_counts(robot.hand.center_counts.begin(), robot.hand.center_counts.end()) {
  CheckPlanned(config);
  const int channels = linearisation->channel_count();
  for (std::size_t i = 0; i < config.filters.size(); ++i) {
    chain.push_back(WithinSetting("filter[" + std::to_string(i) + "]", [&] {
      CheckUnitOfR(config.filters[i], config.filter_on);
      return MakeFilter(config.filters[i], channels, step_rate_hz);
    }));
  }
  predictor = WithinSetting(
      "prediction", [&] { return MakePredictor(config.prediction, channels, step_rate_hz); });
  Reset(motor_counts);
}

void Controller::State::TakeSample(const GloveSample& sample) noexcept {
  guard.Take(sample, [this](int channel) { StartChannel(channel); });
  linearisation->ToAngles(guard.trusted_counts(), linearised_rad);
  if (filter_at == FilterAt::kSample) StepFilters();
}

Command Controller::State::StepEvent() noexcept {
  const bool event = event_clock.Tick();
  if (event) {
    if (filter_at == FilterAt::kEvent) StepFilters();
    joint_map.ToJoints(predicted_rad, target_rad);
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
  return {.motor_counts = motor_counts, .event = event};
}

void Controller::State::PlanCommands() noexcept {
  const std::size_t joints = target_rad.size();
  for (int row = 0; row < path.row_count(); ++row) {
    joint_map.ToJoints(path.Row(row),
                       {path_rad.data() + static_cast<std::size_t>(row) * joints, joints});
  }
  model_predictive.Step(path_rad, planned_rad);
}

void Controller::State::StartChannel(int channel) noexcept {
  for (const auto& filter : chain) filter->ResetChannel(channel);
  if (predictor) predictor->ResetChannel(channel);
  path.ResetChannel(channel);
}

void Controller::State::StepFilters() noexcept {
  if (filter_on == FilterOn::kCounts) {
    const auto counts = guard.trusted_counts();
    std::copy(counts.begin(), counts.end(), filtered_counts.begin());
    for (const auto& filter : chain) filter->Step(filtered_counts, filtered_counts);
    linearisation->ToAngles(filtered_counts, filtered_rad);
  } else {
    std::copy(linearised_rad.begin(), linearised_rad.end(), filtered_rad.begin());
    for (const auto& filter : chain) filter->Step(filtered_rad, filtered_rad);
  }
  std::copy(filtered_rad.begin(), filtered_rad.end(), predicted_rad.begin());
  if (inactive_count > 0) HoldInactiveChannels();  // also for predictions of other channels
  if (predictor) predictor->Step(predicted_rad, predicted_rad);
  path.Step(filtered_rad, predicted_rad);
  if (inactive_count > 0) HoldInactiveChannels();
}

void Controller::State::HoldInactiveChannels() noexcept {
  for (std::size_t i = 0; i < active.size(); ++i) {
    if (active[i] == 1) continue;
    predicted_rad[i] = held_rad[i];
    path.Hold(static_cast<int>(i), held_rad[i]);
  }
}

void Controller::State::SetChannelActive(int channel, bool on) noexcept {
  const auto index = static_cast<std::size_t>(channel);
  if (on == (active[index] == 1)) return;
  active[index] = on ? 1 : 0;
  inactive_count += on ? -1 : 1;
  held_rad[index] = predicted_rad[index];
  if (on) StartChannel(channel);
}

void Controller::State::Reset(std::span<const std::int32_t> at_counts) noexcept {
  std::copy(at_counts.begin(), at_counts.end(), motor_counts.begin());
  rounding.Reset(motor_counts);
  tendon_map.ToJointAngles(motor_counts, target_rad);
  const std::span<const double> reference_rad = tendon_map.reference_angle_rad();
  for (std::size_t i = 0; i < target_rad.size(); ++i) {
    if (std::isnan(target_rad[i])) target_rad[i] = reference_rad[i];  // springs decide it
  }
  std::copy(middle_rad.begin(), middle_rad.end(), predicted_rad.begin());
  joint_map.ToChannels(target_rad, predicted_rad);
  std::copy(predicted_rad.begin(), predicted_rad.end(), held_rad.begin());
  Reset();
}

void Controller::State::Reset() noexcept {
  linearisation->ToCounts(predicted_rad, filtered_counts);
  guard.Reset(filtered_counts);
  for (const auto& filter : chain) filter->Reset();
  if (predictor) predictor->Reset();
  path.Reset();
  rounding.Reset();
  event_clock.Reset();
  linearisation->ToAngles(guard.trusted_counts(), linearised_rad);
  std::copy(linearised_rad.begin(), linearised_rad.end(), filtered_rad.begin());
  std::copy(linearised_rad.begin(), linearised_rad.end(), predicted_rad.begin());
  HoldInactiveChannels();
  joint_map.ToJoints(predicted_rad, target_rad);
  for (std::size_t i = 0; i < active.size(); ++i) path.Hold(static_cast<int>(i), predicted_rad[i]);
  model_predictive.Reset(target_rad);
  joint_loop.Reset(target_rad);
}

void Controller::State::TakeOver(State& before) noexcept {
  const bool same_step = step_rate_hz == before.step_rate_hz;
  const bool same_unit = filter_on == before.filter_on;
  linearisation->ToCounts(before.filtered_rad, filtered_counts);
  const std::span<const double> here =
      filter_on == FilterOn::kCounts ? filtered_counts : before.filtered_rad;
  for (std::size_t i = 0; i < chain.size(); ++i) {
    const bool goes_on =
        same_step && same_unit && i < before.chain.size() && chain[i]->TakeMemory(*before.chain[i]);
    if (!goes_on) chain[i]->StartAt(here);
  }
  if (predictor) {
    const bool goes_on = same_step && before.predictor && predictor->TakeMemory(*before.predictor);
    if (!goes_on) predictor->StartAt(before.filtered_rad);
  }
  path.TakeMemory(before.path, same_step, before.filtered_rad);
  for (std::size_t i = 0; i < active.size(); ++i) {
    path.Hold(static_cast<int>(i), before.predicted_rad[i]);
  }
  model_predictive.TakeMemory(before.model_predictive, before.target_rad);
  guard.TakeMemory(before.guard, filtered_counts);
  joint_loop.TakeMemory(before.joint_loop, before.target_rad);
  rounding.TakeMemory(before.rounding);
  std::swap(event_clock, before.event_clock);
  std::swap(active, before.active);
  std::swap(inactive_count, before.inactive_count);
  for (std::vector<double> State::*flow :
       {&State::linearised_rad, &State::filtered_rad, &State::predicted_rad, &State::held_rad,
        &State::target_rad}) {
    (this->*flow).swap(before.*flow);
  }
  motor_counts.swap(before.motor_counts);
}

}  // namespace gauntlet::controller
