#include "sim/loop/hand_loop.h"

#include <algorithm>
#include <utility>

#include "controller/number.h"

namespace gauntlet::sim {
namespace {}  // namespace

HandLoop::HandLoop(const controller::ControllerConfig& config,
                   const controller::GloveCalibration& glove,
                   const controller::JointMapConfig& joint_map,
                   std::shared_ptr<const HandModel> hand)
    : controller_(config, glove, hand->transmission(), hand->timing().controller, joint_map),
      link_(hand->timing().event_delay_ticks,
            hand->timing().controller.TicksOf(hand->timing().controller.event_period_ms),
            controller_.motor_count()),
      hand_(std::move(hand)),
      sensors_(hand_.hand_model().config().joint_sensors, hand_.hand_model().timing().controller,
               controller_.joint_count()),
      joint_angle_rad_(static_cast<std::size_t>(controller_.joint_count())),
      measured_angle_rad_(sensors_.exist() ? joint_angle_rad_.size() : 0, controller::kNaN) {}

void HandLoop::Reset(std::span<const double> joint_angle_rad) {
  link_.Reset();
  hand_.Reset(joint_angle_rad);
  controller_.Reset(hand_.command());
  sensors_.Reset();
  std::ranges::fill(measured_angle_rad_, controller::kNaN);
  tick_ = 0;
}

void HandLoop::Step(const controller::GloveSample& sample) noexcept {
  ReadSensors();
  Advance(controller_.Step(sample));
}

void HandLoop::Step() noexcept {
  ReadSensors();
  Advance(controller_.Step());
}

void HandLoop::ReadSensors() noexcept {
  if (!sensors_.exist()) return;
  hand_.ReadJointAngles(joint_angle_rad_);
  const std::span<const double> reading_rad = sensors_.Step(joint_angle_rad_);
  if (reading_rad.empty()) return;
  std::ranges::copy(reading_rad, measured_angle_rad_.begin());
  controller_.TakeJointAngles(reading_rad);
}

void HandLoop::Advance(const controller::Command& command) noexcept {
  if (command.event) link_.Send(tick_, command.motor_counts);
  if (const auto frame = link_.Arriving(tick_); !frame.empty()) hand_.SetCommand(frame);
  hand_.Step();
  ++tick_;
}

}  // namespace gauntlet::sim
