#include "controller/controller.h"

#include <utility>

#include "controller/controller_state.h"

namespace gauntlet::controller {

Controller::Controller(const ControllerConfig& config, const GloveCalibration& glove,
                       const TendonTransmission& hand)
    : state_(std::make_unique<State>(config, glove, hand)) {}
Controller::~Controller() = default;
Controller::Controller(Controller&&) noexcept = default;
Controller& Controller::operator=(Controller&&) noexcept = default;

Command Controller::Step(const GloveSample& sample) noexcept {
  State& state = *state_;
  const bool event = state.samples_to_event == 0;
  state.samples_to_event = (event ? state.config.samples_per_event : state.samples_to_event) - 1;
  state.guard.Take(sample, [&state](int channel) { state.StartChannel(channel); });
  state.linearisation->ToAngles(state.guard.trusted_counts(), state.linearised_rad);
  if (event || state.config.filter_at == FilterAt::kSample) state.StepFilters();
  if (event) state.StepMotors();
  return {.motor_counts = state.motor_counts};
}

void Controller::Reset() noexcept { state_->Reset(); }

void Controller::Load(const ControllerConfig& config) {
  auto next = std::make_unique<State>(config, state_->glove, state_->hand);
  next->TakeOver(*state_);
  state_ = std::move(next);
}

void Controller::SetChannelActive(int channel, bool active) noexcept {
  State& state = *state_;
  const auto index = static_cast<std::size_t>(channel);
  if (active == (state.active[index] == 1)) return;
  state.active[index] = active ? 1 : 0;
  state.inactive_count += active ? -1 : 1;
  state.held_rad[index] = state.target_rad[index];
  if (active) state.StartChannel(channel);
}

bool Controller::channel_active(int channel) const noexcept {
  return state_->active[static_cast<std::size_t>(channel)] == 1;
}

int Controller::channel_count() const noexcept { return state_->linearisation->channel_count(); }
int Controller::motor_count() const noexcept { return state_->tendon_map.motor_count(); }

std::span<const double> Controller::linearised_angle_rad() const noexcept {
  return state_->linearised_rad;
}
std::span<const double> Controller::filtered_angle_rad() const noexcept {
  return state_->filtered_rad;
}
std::span<const double> Controller::target_angle_rad() const noexcept { return state_->target_rad; }
std::span<const std::int64_t> Controller::untrusted_samples() const noexcept {
  return state_->guard.untrusted_samples();
}
std::span<const std::int64_t> Controller::untrusted_samples(Untrusted kind) const noexcept {
  return state_->guard.untrusted_samples(kind);
}

}  // namespace gauntlet::controller
