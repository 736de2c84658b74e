#include "controller/controller.h"

#include <utility>

#include "controller/controller_state.h"

namespace gauntlet::controller {

Controller::Controller(const ControllerConfig& config, const GloveCalibration& glove,
                       const TendonTransmission& hand, const Timing& timing,
                       const JointMapConfig& joint_map)
    : Controller(RobotConfig{.controller = config,
                             .glove = glove,
                             .hand = hand,
                             .joint_map = joint_map,
                             .timing = timing}) {}
Controller::Controller(const RobotConfig& robot) : state_(std::make_unique<State>(robot)) {}
Controller::~Controller() = default;
Controller::Controller(Controller&&) noexcept = default;
Controller& Controller::operator=(Controller&&) noexcept = default;

Command Controller::Step(const GloveSample& sample) noexcept {
  state_->TakeSample(sample);
  return state_->StepEvent();
}

Command Controller::Step() noexcept { return state_->StepEvent(); }

void Controller::Reset() noexcept { state_->Reset(); }

void Controller::Load(const ControllerConfig& config) {
  RobotConfig robot = state_->robot;
  robot.controller = config;
  auto next = std::make_unique<State>(robot);
  next->TakeOver(*state_);
  state_ = std::move(next);
}

void Controller::SetChannelActive(int channel, bool active) noexcept {
  State& state = *state_;
  const auto index = static_cast<std::size_t>(channel);
  if (active == (state.active[index] == 1)) return;
  state.active[index] = active ? 1 : 0;
  state.inactive_count += active ? -1 : 1;
  state.held_rad[index] = state.predicted_rad[index];
  if (active) state.StartChannel(channel);
}

bool Controller::channel_active(int channel) const noexcept {
  return state_->active[static_cast<std::size_t>(channel)] == 1;
}

int Controller::channel_count() const noexcept { return state_->linearisation->channel_count(); }
int Controller::joint_count() const noexcept { return state_->joint_map.joint_count(); }
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
