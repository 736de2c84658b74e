#include "controller/controller_state.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "controller/prediction/predictor.h"

namespace gauntlet::controller {
namespace {

/// Throws for what does not fit together, before anything is built from it.
const RobotConfig& Checked(const RobotConfig& robot) {
  CheckSettings(robot.controller);
  WithinSetting("timing", [&] { CheckSettings(robot.timing); });
  const GloveCalibration& glove = robot.glove;
  if (!(glove.full_scale_counts > 0.0) || !std::isfinite(glove.full_scale_counts)) {
    throw SettingError("calibration.full_scale_counts", "must be finite and above 0");
  }
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

/// What each channel holds before its first good value: the hand's reference posture.
std::vector<double> StartCounts(const Linearisation& linearisation, const JointMap& joint_map,
                                const RobotConfig& robot) {
  const std::vector<double> angle_rad =
      joint_map.ChannelsAt(robot.hand.reference_angle_rad, MiddleOf(robot.glove));
  std::vector<double> counts(angle_rad.size());
  linearisation.ToCounts(angle_rad, counts);
  for (double& value : counts) value = std::clamp(value, 0.0, robot.glove.full_scale_counts);
  return counts;
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

}  // namespace

Controller::State::State(const RobotConfig& robot_in)
    : robot(Checked(robot_in)),
      linearisation(MakeLinearisation(robot.controller.linearisation, robot.glove,
                                      robot.glove.channel_names)),
      joint_map(WithinSetting(
          "joint_map",
          [&] { return JointMap(robot.joint_map, robot.glove.channel_names, robot.hand); })),
      guard(robot.controller.untrusted, StartCounts(*linearisation, joint_map, robot),
            robot.glove.full_scale_counts, robot.timing.sample_rate_hz()),
      tendon_map(robot.hand, robot.controller.coupling_compensation),
      rounding(robot.controller.motor, robot.hand, robot.timing.event_rate_hz()),
      event_clock(robot.timing.TicksOf(robot.timing.event_period_ms)),
      active(robot.glove.channel_names.size(), 1),
      linearised_rad(active.size()),
      filtered_counts(active.size()),
      filtered_rad(active.size()),
      predicted_rad(active.size()),
      held_rad(active.size()),
      target_rad(robot.hand.reference_angle_rad),
      exact_motor_counts(robot.hand.counts_per_rad.size()),
      motor_counts(robot.hand.center_counts.begin(), robot.hand.center_counts.end()) {
  const ControllerConfig& config = robot.controller;
  const int channels = linearisation->channel_count();
  const double step_rate_hz = config.filter_at == FilterAt::kSample ? robot.timing.sample_rate_hz()
                                                                    : robot.timing.event_rate_hz();
  for (std::size_t i = 0; i < config.filters.size(); ++i) {
    chain.push_back(WithinSetting("filter[" + std::to_string(i) + "]", [&] {
      CheckUnitOfR(config.filters[i], config.filter_on);
      return MakeFilter(config.filters[i], channels, step_rate_hz);
    }));
  }
  predictor = WithinSetting(
      "prediction", [&] { return MakePredictor(config.prediction, channels, step_rate_hz); });
  Reset();
}

void Controller::State::TakeSample(const GloveSample& sample) noexcept {
  guard.Take(sample, [this](int channel) { StartChannel(channel); });
  linearisation->ToAngles(guard.trusted_counts(), linearised_rad);
  if (robot.controller.filter_at == FilterAt::kSample) StepFilters();
}

Command Controller::State::StepEvent() noexcept {
  const bool event = event_clock.Tick();
  if (event) {
    if (robot.controller.filter_at == FilterAt::kEvent) StepFilters();
    StepMotors();
  }
  return {.motor_counts = motor_counts, .event = event};
}

void Controller::State::StartChannel(int channel) noexcept {
  for (const auto& filter : chain) filter->ResetChannel(channel);
  if (predictor) predictor->ResetChannel(channel);
}

void Controller::State::StepFilters() noexcept {
  if (robot.controller.filter_on == FilterOn::kCounts) {
    const auto counts = guard.trusted_counts();
    std::copy(counts.begin(), counts.end(), filtered_counts.begin());
    for (const auto& filter : chain) filter->Step(filtered_counts, filtered_counts);
    linearisation->ToAngles(filtered_counts, filtered_rad);
  } else {
    std::copy(linearised_rad.begin(), linearised_rad.end(), filtered_rad.begin());
    for (const auto& filter : chain) filter->Step(filtered_rad, filtered_rad);
  }
  if (predictor) {
    predictor->Step(filtered_rad, predicted_rad);
  } else {
    std::copy(filtered_rad.begin(), filtered_rad.end(), predicted_rad.begin());
  }
  if (inactive_count > 0) HoldInactiveChannels();
}

void Controller::State::HoldInactiveChannels() noexcept {
  for (std::size_t i = 0; i < active.size(); ++i) {
    if (active[i] == 0) predicted_rad[i] = held_rad[i];
  }
}

void Controller::State::StepMotors() noexcept {
  joint_map.ToJoints(predicted_rad, target_rad);
  tendon_map.ToExactMotorCounts(target_rad, exact_motor_counts);
  rounding.Step(exact_motor_counts, motor_counts);
}

void Controller::State::Reset() noexcept {
  guard.Reset();
  for (const auto& filter : chain) filter->Reset();
  if (predictor) predictor->Reset();
  event_clock.Reset();
  linearisation->ToAngles(guard.trusted_counts(), linearised_rad);
  std::copy(linearised_rad.begin(), linearised_rad.end(), filtered_rad.begin());
  std::copy(linearised_rad.begin(), linearised_rad.end(), predicted_rad.begin());
  std::fill(active.begin(), active.end(), 1);
  inactive_count = 0;
  StepMotors();
  rounding.Reset();
}

void Controller::State::TakeOver(const State& before) noexcept {
  for (int channel = 0; channel < linearisation->channel_count(); ++channel) {
    for (std::size_t i = 0; i < std::min(chain.size(), before.chain.size()); ++i) {
      chain[i]->CopyChannel(*before.chain[i], channel);
    }
    if (predictor && before.predictor) predictor->CopyChannel(*before.predictor, channel);
  }
  guard.CopyState(before.guard);
  rounding.CopyState(before.rounding);
  event_clock = before.event_clock;
  active = before.active;
  inactive_count = before.inactive_count;
  linearised_rad = before.linearised_rad;
  filtered_rad = before.filtered_rad;
  predicted_rad = before.predicted_rad;
  target_rad = before.target_rad;
  held_rad = before.held_rad;
  motor_counts = before.motor_counts;
}

}  // namespace gauntlet::controller
