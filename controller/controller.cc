#include "controller/controller.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "controller/linearisation/linearisation.h"
#include "controller/sample_guard.h"
#include "controller/tendon_map.h"

namespace gauntlet::controller {
namespace {

std::vector<double> CountsOf(const Linearisation& linearisation,
                             const std::vector<double>& angle_rad, double full_scale_counts) {
  std::vector<double> counts(angle_rad.size());
  linearisation.ToCounts(angle_rad, counts);
  for (double& value : counts) value = std::clamp(value, 0.0, full_scale_counts);
  return counts;
}

/// Throws for what does not fit together, before anything is built from it.
void CheckConnection(const ControllerConfig& config, const GloveCalibration& glove,
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
}

}  // namespace

struct Controller::State {
  State(const ControllerConfig& config_in, const GloveCalibration& glove,
        const TendonTransmission& hand)
      : config(config_in),
        linearisation(MakeLinearisation(glove)),
        guard(CountsOf(*linearisation, hand.reference_angle_rad, glove.full_scale_counts),
              glove.full_scale_counts),
        tendon_map(hand, config.coupling_compensation),
        linearised_rad(hand.reference_angle_rad),
        filtered_counts(hand.reference_angle_rad.size()),
        filtered_rad(hand.reference_angle_rad),
        motor_counts(hand.center_counts.begin(), hand.center_counts.end()) {
    const int channels = linearisation->channel_count();
    const bool every_sample = config.filter_at == FilterAt::kSample;
    const double filter_rate_hz =
        every_sample ? config.rate_hz : config.rate_hz / config.samples_per_event;
    for (std::size_t i = 0; i < config.filters.size(); ++i) {
      try {
        chain.push_back(MakeFilter(config.filters[i], channels, filter_rate_hz));
      } catch (const SettingError& error) {
        throw SettingError("filter[" + std::to_string(i) + "]." + error.key(), error.problem());
      }
    }
  }

  void FilterInPlace(std::span<double> values) noexcept {
    for (const auto& filter : chain) filter->Step(values, values);
  }

  void StepFilters() noexcept {
    if (config.filter_on == FilterOn::kCounts) {
      const auto counts = guard.trusted_counts();
      std::copy(counts.begin(), counts.end(), filtered_counts.begin());
      FilterInPlace(filtered_counts);
      linearisation->ToAngles(filtered_counts, filtered_rad);
    } else {
      std::copy(linearised_rad.begin(), linearised_rad.end(), filtered_rad.begin());
      FilterInPlace(filtered_rad);
    }
  }

  ControllerConfig config;
  std::unique_ptr<Linearisation> linearisation;
  SampleGuard guard;
  std::vector<std::unique_ptr<Filter>> chain;
  TendonMap tendon_map;
  std::vector<double> linearised_rad;
  std::vector<double> filtered_counts;
  std::vector<double> filtered_rad;
  std::vector<std::int32_t> motor_counts;
  int samples_to_event = 0;
};

Controller::Controller(const ControllerConfig& config, const GloveCalibration& glove,
                       const TendonTransmission& hand) {
  CheckConnection(config, glove, hand);
  state_ = std::make_unique<State>(config, glove, hand);
  Reset();
}
Controller::~Controller() = default;
Controller::Controller(Controller&&) noexcept = default;
Controller& Controller::operator=(Controller&&) noexcept = default;

Command Controller::Step(const GloveSample& sample) noexcept {
  State& state = *state_;
  const bool event = state.samples_to_event == 0;
  state.samples_to_event = (event ? state.config.samples_per_event : state.samples_to_event) - 1;
  state.guard.Take(sample.counts, [&state](int channel) {
    for (const auto& filter : state.chain) filter->ResetChannel(channel);
  });
  state.linearisation->ToAngles(state.guard.trusted_counts(), state.linearised_rad);
  if (event || state.config.filter_at == FilterAt::kSample) state.StepFilters();
  if (event) state.tendon_map.ToMotorCounts(state.filtered_rad, state.motor_counts);
  return {.motor_counts = state.motor_counts};
}

void Controller::Reset() noexcept {
  State& state = *state_;
  state.guard.Reset();
  for (const auto& filter : state.chain) filter->Reset();
  state.samples_to_event = 0;
  state.linearisation->ToAngles(state.guard.trusted_counts(), state.linearised_rad);
  std::copy(state.linearised_rad.begin(), state.linearised_rad.end(), state.filtered_rad.begin());
  state.tendon_map.ToMotorCounts(state.filtered_rad, state.motor_counts);
}

int Controller::channel_count() const noexcept { return state_->linearisation->channel_count(); }
int Controller::motor_count() const noexcept { return state_->tendon_map.motor_count(); }

std::span<const double> Controller::linearised_angle_rad() const noexcept {
  return state_->linearised_rad;
}
std::span<const double> Controller::filtered_angle_rad() const noexcept {
  return state_->filtered_rad;
}
std::span<const std::int64_t> Controller::untrusted_samples() const noexcept {
  return state_->guard.untrusted_samples();
}

}  // namespace gauntlet::controller
