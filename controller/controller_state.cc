#include "controller/controller_state.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "controller/prediction/predictor.h"

namespace gauntlet::controller {
namespace {

/// Throws for what does not fit together, before anything is built from it.
const ControllerConfig& Checked(const ControllerConfig& config, const GloveCalibration& glove,
                                const TendonTransmission& hand) {
  CheckSettings(config);
  if (!(config.rate_hz > 0.0) || !std::isfinite(config.rate_hz)) {
    throw SettingError("rate_hz", "must be finite and above 0");
  }
  if (config.samples_per_event < 1) {
    throw SettingError("samples_per_event",
                       "is " + std::to_string(config.samples_per_event) + ", must be at least 1");
  }
  if (!(glove.full_scale_counts > 0.0) || !std::isfinite(glove.full_scale_counts)) {
    throw SettingError("calibration.full_scale_counts", "must be finite and above 0");
  }
  if (glove.low_counts.size() != hand.reference_angle_rad.size()) {
    throw SettingError("calibration", "the glove has " + std::to_string(glove.low_counts.size()) +
                                          " channels, the hand " +
                                          std::to_string(hand.reference_angle_rad.size()));
  }
  return config;
}

std::vector<double> CountsOf(const Linearisation& linearisation,
                             const std::vector<double>& angle_rad, double full_scale_counts) {
  std::vector<double> counts(angle_rad.size());
  linearisation.ToCounts(angle_rad, counts);
  for (double& value : counts) value = std::clamp(value, 0.0, full_scale_counts);
  return counts;
}

/// Calls make() and puts `place` before the key of its errors.
template <class Make>
auto AtPlace(const std::string& place, Make make) {
  try {
    return make();
  } catch (const SettingError& error) {
    throw SettingError(place + "." + error.key(), error.problem());
  }
}

}  // namespace

Controller::State::State(const ControllerConfig& config_in, const GloveCalibration& glove_in,
                         const TendonTransmission& hand_in)
    : config(Checked(config_in, glove_in, hand_in)),
      glove(glove_in),
      hand(hand_in),
      linearisation(MakeLinearisation(config.linearisation, glove, hand.channel_names)),
      guard(config.untrusted,
            CountsOf(*linearisation, hand.reference_angle_rad, glove.full_scale_counts),
            glove.full_scale_counts, config.rate_hz),
      tendon_map(hand, config.coupling_compensation),
      rounding(config.motor, hand, config.rate_hz / config.samples_per_event),
      active(hand.reference_angle_rad.size(), 1),
      linearised_rad(hand.reference_angle_rad),
      filtered_counts(hand.reference_angle_rad.size()),
      filtered_rad(hand.reference_angle_rad),
      target_rad(hand.reference_angle_rad),
      held_rad(hand.reference_angle_rad),
      exact_motor_counts(hand.counts_per_rad.size()),
      motor_counts(hand.center_counts.begin(), hand.center_counts.end()) {
  const int channels = linearisation->channel_count();
  const double step_rate_hz = config.filter_at == FilterAt::kSample
                                  ? config.rate_hz
                                  : config.rate_hz / config.samples_per_event;
  for (std::size_t i = 0; i < config.filters.size(); ++i) {
    chain.push_back(AtPlace("filter[" + std::to_string(i) + "]",
                            [&] { return MakeFilter(config.filters[i], channels, step_rate_hz); }));
  }
  predictor = AtPlace("prediction",
                      [&] { return MakePredictor(config.prediction, channels, step_rate_hz); });
  Reset();
}

void Controller::State::StartChannel(int channel) noexcept {
  for (const auto& filter : chain) filter->ResetChannel(channel);
  if (predictor) predictor->ResetChannel(channel);
}

void Controller::State::StepFilters() noexcept {
  if (config.filter_on == FilterOn::kCounts) {
    const auto counts = guard.trusted_counts();
    std::copy(counts.begin(), counts.end(), filtered_counts.begin());
    for (const auto& filter : chain) filter->Step(filtered_counts, filtered_counts);
    linearisation->ToAngles(filtered_counts, filtered_rad);
  } else {
    std::copy(linearised_rad.begin(), linearised_rad.end(), filtered_rad.begin());
    for (const auto& filter : chain) filter->Step(filtered_rad, filtered_rad);
  }
  if (predictor) {
    predictor->Step(filtered_rad, target_rad);
  } else {
    std::copy(filtered_rad.begin(), filtered_rad.end(), target_rad.begin());
  }
  if (inactive_count > 0) HoldInactiveChannels();
}

void Controller::State::HoldInactiveChannels() noexcept {
  for (std::size_t i = 0; i < active.size(); ++i) {
    if (active[i] == 0) target_rad[i] = held_rad[i];
  }
}

void Controller::State::StepMotors() noexcept {
  tendon_map.ToExactMotorCounts(target_rad, exact_motor_counts);
  rounding.Step(exact_motor_counts, motor_counts);
}

void Controller::State::Reset() noexcept {
  guard.Reset();
  for (const auto& filter : chain) filter->Reset();
  if (predictor) predictor->Reset();
  samples_to_event = 0;
  linearisation->ToAngles(guard.trusted_counts(), linearised_rad);
  std::copy(linearised_rad.begin(), linearised_rad.end(), filtered_rad.begin());
  std::copy(linearised_rad.begin(), linearised_rad.end(), target_rad.begin());
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
  samples_to_event = std::min(before.samples_to_event, config.samples_per_event - 1);
  active = before.active;
  inactive_count = before.inactive_count;
  linearised_rad = before.linearised_rad;
  filtered_rad = before.filtered_rad;
  target_rad = before.target_rad;
  held_rad = before.held_rad;
  motor_counts = before.motor_counts;
}

}  // namespace gauntlet::controller
