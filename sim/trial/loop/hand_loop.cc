#include "sim/trial/loop/hand_loop.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <variant>

#include "controller/assert.h"
#include "controller/number.h"

namespace gauntlet::sim {
namespace {

/// Whole counts of a motor, from counts that a receiver may have extrapolated.
std::int32_t WholeCounts(double counts) {
  constexpr double kBeyondAnyMotor = 1e9;
  return static_cast<std::int32_t>(
      std::lround(std::clamp(counts, -kBeyondAnyMotor, kBeyondAnyMotor)));
}

std::size_t WaitingFrames(const LinkConfig& config) {
  const auto* queue = std::get_if<QueueReceiver>(&config.receiver.settings);
  return queue == nullptr ? 1 : static_cast<std::size_t>(queue->longest_frames);
}

}  // namespace

HandLoop::Link::Link(const LinkConfig& config, const LinkEnds& ends, const HandModel& hand,
                     std::uint64_t seed)
    : way(config.transport, ends, hand.timing().controller, seed),
      receiver(config.receiver, ends.values, ends.period_ticks, hand.timing().controller),
      watchdog(config.watchdog, hand.transmission(), hand.timing().controller) {}

void HandLoop::Link::Receive(std::int64_t tick) noexcept {
  way.Deliver(tick, [&](const LinkFrame& frame) { receiver.Accept(tick, frame); });
}

HandLoop::HandLoop(const controller::ControllerConfig& config,
                   const controller::GloveCalibration& glove,
                   const controller::JointMapConfig& joint_map,
                   std::shared_ptr<const HandModel> hand, const LoopLinks& links)
    : controller_(config, glove, hand->transmission(), hand->timing().controller, joint_map),
      hand_link_(LinkToHand(links, *hand)),
      hand_(std::move(hand)),
      sensors_(hand_.hand_model().config().joint_sensors, hand_.hand_model().timing().controller,
               controller_.joint_count()),
      joint_angle_rad_(static_cast<std::size_t>(controller_.joint_count())),
      measured_angle_rad_(sensors_.exist() ? joint_angle_rad_.size() : 0, controller::kNaN),
      sample_counts_(static_cast<std::size_t>(controller_.channel_count())),
      sent_counts_(static_cast<std::size_t>(controller_.motor_count())),
      wanted_counts_(sent_counts_.size()),
      spool_counts_(sent_counts_.size()) {
  if (!links.config.glove) return;
  const LinkConfig& link = *links.config.glove;
  const int ticks_per_sample = hand_.hand_model().timing().controller.ticks_per_sample;
  glove_link_.emplace(link,
                      LinkEnds{.name = "glove",
                               .values = controller_.channel_count(),
                               .period_ticks = static_cast<double>(ticks_per_sample),
                               .fixed_delay_ticks = 0,
                               .waiting_frames = WaitingFrames(link)},
                      hand_.hand_model(), links.seed);
}

HandLoop::Link HandLoop::LinkToHand(const LoopLinks& links, const HandModel& hand) {
  links.config.Check();
  const LinkConfig link = links.config.hand.value_or(LinkConfig{});
  const controller::Timing& timing = hand.timing().controller;
  return {link,
          {.name = "hand",
           .values = static_cast<int>(hand.transmission().motor_names.size()),
           .period_ticks = timing.TicksOf(timing.event_period_ms),
           .fixed_delay_ticks = hand.timing().event_delay_ticks,
           .waiting_frames = WaitingFrames(link)},
          hand,
          links.seed};
}

void HandLoop::Reset(std::span<const double> joint_angle_rad) {
  hand_.Reset(joint_angle_rad);
  const auto reset = [&](Link& link) {
    link.way.Reset();
    link.receiver.Reset();
    link.watchdog.Reset(hand_.command());
  };
  if (glove_link_) reset(*glove_link_);
  reset(hand_link_);
  controller_.Reset(hand_.command());
  sensors_.Reset();
  std::ranges::fill(measured_angle_rad_, controller::kNaN);
  std::ranges::copy(hand_.command(), wanted_counts_.begin());
  taken_counts_ = {};
  tick_ = first_sample_tick_ = sample_tick_ = held_tick_ = 0;
  has_command_ = false;
  has_power_ = true;
}

std::span<const std::int32_t> HandLoop::StepController(
    const controller::GloveSample& sample) noexcept {
  if (glove_link_) {
    std::ranges::fill(sample_counts_, controller::kNaN);
    std::copy_n(sample.counts.begin(), std::min(sample.counts.size(), sample_counts_.size()),
                sample_counts_.begin());
    glove_link_->way.Send(tick_, tick_, sample_counts_);
    return StepBehindLink();
  }
  sample_tick_ = tick_;
  taken_counts_ = sample.counts;
  ReadSensors();
  return FrameToSend(controller_.Step(sample));
}

std::span<const std::int32_t> HandLoop::StepController() noexcept {
  if (glove_link_) return StepBehindLink();
  taken_counts_ = {};
  ReadSensors();
  return FrameToSend(controller_.Step());
}

std::span<const std::int32_t> HandLoop::StepBehindLink() noexcept {
  ReadSensors();
  glove_link_->Receive(tick_);
  auto found = Receiver::Found::kNothing;
  const int ticks_per_sample = hand_.hand_model().timing().controller.ticks_per_sample;
  if ((tick_ - first_sample_tick_) % ticks_per_sample == 0) {
    found = glove_link_->receiver.Step(tick_);
  }
  glove_link_->watchdog.Watch(found == Receiver::Found::kNew);
  taken_counts_ = {};
  if (found == Receiver::Found::kNothing) return FrameToSend(controller_.Step());
  taken_counts_ = glove_link_->receiver.values();
  sample_tick_ = glove_link_->receiver.origin_tick();
  return FrameToSend(controller_.Step({.counts = glove_link_->receiver.values()}));
}

void HandLoop::AcceptGloveFrame(const LinkFrame& frame) noexcept {
  GAUNTLET_ASSERT(glove_link_);
  glove_link_->receiver.Accept(tick_, frame);
}

void HandLoop::Skip(std::int64_t ticks) noexcept {
  for (std::int64_t tick = 0; tick < ticks; ++tick) {
    if (glove_link_) glove_link_->watchdog.Watch(false);
    hand_link_.watchdog.Watch(false);
  }
  tick_ += ticks;
}

void HandLoop::ReadSensors() noexcept {
  if (!sensors_.exist()) return;
  hand_.ReadJointAngles(joint_angle_rad_);
  const std::span<const double> reading_rad = sensors_.Step(joint_angle_rad_);
  if (reading_rad.empty()) return;
  std::ranges::copy(reading_rad, measured_angle_rad_.begin());
  controller_.TakeJointAngles(reading_rad);
}

/// Frame that the computer's watchdog has to send in place of one that is due, or nothing.
std::span<const std::int32_t> HandLoop::FrameToSend(const controller::Command& command) noexcept {
  if (!command.event) return {};
  if (!glove_link_ || !glove_link_->watchdog.exists()) return command.motor_counts;
  const auto frame = glove_link_->watchdog.Command(command.motor_counts);
  if (glove_link_->watchdog.tier() == Watchdog::Tier::kOff) return {};
  return frame;
}

void HandLoop::StepHand(std::span<const std::int32_t> sent_counts) noexcept {
  if (!sent_counts.empty()) {
    std::ranges::copy(sent_counts, sent_counts_.begin());
    hand_link_.way.Send(tick_, sample_tick_, sent_counts_);
  }
  ReceiveCommand();
  hand_.Step();
  ++tick_;
}

void HandLoop::ReceiveCommand() noexcept {
  hand_link_.Receive(tick_);
  const Receiver::Found found = hand_link_.receiver.Step(tick_);
  const bool is_new = found == Receiver::Found::kNew;
  if (is_new || found == Receiver::Found::kPredicted) {
    std::ranges::transform(hand_link_.receiver.values(), wanted_counts_.begin(), WholeCounts);
    if (!hand_link_.watchdog.exists()) hand_.SetCommand(wanted_counts_);
  }
  if (is_new) {
    held_tick_ = hand_link_.receiver.origin_tick();
    has_command_ = true;
  }
  if (hand_link_.watchdog.exists()) {
    hand_link_.watchdog.Watch(is_new);
    if (has_command_) ObeyWatchdog();
  }
}

void HandLoop::ObeyWatchdog() noexcept {
  const bool is_on = hand_link_.watchdog.tier() != Watchdog::Tier::kOff;
  if (is_on && !has_power_) {
    hand_.ReadSpoolAngles(spool_counts_);
    for (std::size_t motor = 0; motor < spool_counts_.size(); ++motor) {
      spool_counts_[motor] =
          hand_.hand_model().transmission().ToCounts(motor, spool_counts_[motor]);
    }
    hand_link_.watchdog.MoveTo(spool_counts_);
  }
  if (is_on != has_power_) hand_.SetPower(is_on);
  has_power_ = is_on;
  const std::span<const std::int32_t> command = hand_link_.watchdog.Command(wanted_counts_);
  if (is_on) hand_.SetCommand(command);
}

double HandLoop::sample_age_s() const noexcept {
  return static_cast<double>(tick_ - 1 - held_tick_) / hand_.hand_model().timing().tick_rate_hz();
}

Watchdog::Tier HandLoop::watchdog_tier() const noexcept {
  const Watchdog::Tier tier = hand_link_.watchdog.tier();
  return glove_link_ ? std::max(tier, glove_link_->watchdog.tier()) : tier;
}

}  // namespace gauntlet::sim
