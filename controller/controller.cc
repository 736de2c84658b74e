#include "controller/controller.h"

#include <algorithm>
#include <memory>
#include <utility>

#include "controller/controller_state.h"
#include "controller/number.h"

namespace gauntlet::controller {

Controller::Controller(const ControllerConfig& config, const GloveCalibration& glove,
                       const TendonTransmission& hand, const Timing& timing,
                       const JointMapConfig& joint_map)
    : Controller(RobotConfig{.controller = config,
                             .glove = glove,
                             .hand = hand,
                             .joint_map = joint_map,
                             .timing = timing}) {}
Controller::Controller(const RobotConfig& robot) : Controller(nullptr, nullptr) {
  const auto connections = std::make_shared<const Robot>(robot);
  state_ = new State(connections, robot.controller);
  robot_ = connections.get();
}
Controller::~Controller() { delete state_; }
Controller::Controller(Controller&& from) noexcept
    : robot_(std::exchange(from.robot_, nullptr)), state_(std::exchange(from.state_, nullptr)) {}
Controller& Controller::operator=(Controller&& from) noexcept {
  if (&from == this) return *this;
  robot_ = std::exchange(from.robot_, nullptr);
  delete std::exchange(state_, std::exchange(from.state_, nullptr));
  return *this;
}

Command Controller::Step(const GloveSample& sample) noexcept {
  return state_ ? state_->Step(&sample) : Command{};
}
Command Controller::Step() noexcept { return state_ ? state_->Step(nullptr) : Command{}; }

void Controller::TakeJointAngles(std::span<const double> measured_rad) noexcept {
  if (state_) state_->joint_loop.SetMeasuredAngles(measured_rad);
}

void Controller::TakeElapsedTime(double elapsed_ms) noexcept {
  if (state_) state_->loop.TakeElapsedTime(elapsed_ms);
}

void Controller::Reset() noexcept {
  if (state_) state_->Reset();
}

void Controller::Reset(std::span<const std::int32_t> motor_counts) noexcept {
  if (motor_counts.size() != static_cast<std::size_t>(motor_count())) return Reset();
  if (state_) state_->Reset(motor_counts);
}

Controller Controller::Prepare(const ControllerConfig& config) const {
  // Not by the state, which Swap() may be changing in another thread.
  if (!robot_) throw SettingError("controller", "was moved from, must be one that can step");
  return {robot_, new State(robot_->shared_from_this(), config)};
}

bool Controller::Swap(Controller& next) noexcept {
  const bool prepared = state_ && next.state_ && next.robot_ == robot_ && &next != this;
  if (!prepared) return false;
  next.state_->SwapMemory(*state_);
  std::swap(state_, next.state_);
  return true;
}

void Controller::Load(const ControllerConfig& config) {
  Controller next = Prepare(config);
  Swap(next);
}

void Controller::SetChannelActive(int channel, bool active) noexcept {
  if (channel >= 0 && channel < channel_count())
    state_->estimator.SetChannelActive(channel, active);
}

bool Controller::channel_active(int channel) const noexcept {
  const bool exists = channel >= 0 && channel < channel_count();
  return exists && state_->estimator.channel_active(channel);
}

int Controller::channel_count() const noexcept {
  return state_ ? state_->estimator.channel_count() : 0;
}
int Controller::joint_count() const noexcept {
  return state_ ? state_->joint_map.joint_count() : 0;
}
int Controller::motor_count() const noexcept {
  return state_ ? state_->tendon_map.motor_count() : 0;
}

std::span<const double> Controller::linearised_angle_rad() const noexcept {
  if (!state_) return {};
  return state_->linearised_rad;
}
std::span<const double> Controller::filtered_angle_rad() const noexcept {
  if (!state_) return {};
  return state_->estimator.filtered_rad();
}
std::span<const double> Controller::predicted_angle_rad() const noexcept {
  if (!state_) return {};
  return state_->estimator.predicted_rad();
}
std::span<const double> Controller::target_angle_rad() const noexcept {
  if (!state_) return {};
  return state_->target_rad;
}
std::optional<Untrusted> Controller::untrusted(int channel) const noexcept {
  const bool exists = channel >= 0 && channel < channel_count();
  if (!exists || !state_->judged) return {};
  return state_->guard.reason(static_cast<std::size_t>(channel));
}
double Controller::sample_age_ms(int channel) const noexcept {
  if (channel < 0 || channel >= channel_count()) return kNaN;
  const auto ticks = state_->watch.ticks_since_trusted(static_cast<std::size_t>(channel));
  return 1e3 * static_cast<double>(std::max<std::int64_t>(ticks, 0)) /
         robot_->config.timing.tick_rate_hz;
}
std::int64_t Controller::overruns() const noexcept { return state_ ? state_->loop.overruns() : 0; }
double Controller::measured_tick_rate_hz() const noexcept {
  return state_ ? state_->loop.measured_rate_hz() : kNaN;
}
std::span<const std::int64_t> Controller::failed_plans() const noexcept {
  if (!state_) return {};
  return state_->model_predictive.failed_plans();
}
std::span<const std::int64_t> Controller::untrusted_samples() const noexcept {
  if (!state_) return {};
  return state_->guard.untrusted_samples();
}
std::span<const std::int64_t> Controller::untrusted_samples(Untrusted kind) const noexcept {
  const auto index = static_cast<int>(kind);
  const bool exists = index >= 0 && index < kUntrustedKinds;
  if (!state_ || !exists) return {};
  return state_->guard.untrusted_samples(kind);
}

}  // namespace gauntlet::controller
