#include "sim/live/further_controllers.h"

#include <algorithm>
#include <iterator>

#include "sim/live/device/device_clock.h"

namespace gauntlet::sim {

Shadows::Shadows(const LiveSetup& setup)
    : joints_(setup.trial.hand->joint_names().size()),
      has_first_(setup.view != nullptr && !setup.shadows.empty()) {
  const auto add = [&](const controller::ControllerConfig& config) {
    controllers_.emplace_back(config, setup.trial.calibration, setup.trial.hand->transmission(),
                              setup.trial.hand->timing().controller, setup.trial.joint_map);
  };
  if (has_first_) add(setup.trial.controller);
  for (const ShadowSetup& shadow : setup.shadows) add(shadow.controller);
  steps_.resize(controllers_.size());
  targets_rad_.resize(controllers_.size() * joints_);
}

void Shadows::Reset(std::span<const std::int32_t> motor_counts) {
  auto target = targets_rad_.begin();  // what a tick has that is skipped before the first one
  for (controller::Controller& controller : controllers_) {
    controller.Reset(motor_counts);
    target = std::ranges::copy(controller.target_angle_rad(), target).out;
  }
}

void Shadows::Step(std::span<const double> sample_counts) noexcept {
  auto target = targets_rad_.begin();
  for (std::size_t i = 0; i < controllers_.size(); ++i) {
    const std::int64_t begin_ns = MonotonicNow_ns();
    if (sample_counts.empty()) {
      controllers_[i].Step();
    } else {
      controllers_[i].Step({.counts = sample_counts});
    }
    steps_[i].Add(MonotonicNow_ns() - begin_ns);
    target = std::ranges::copy(controllers_[i].target_angle_rad(), target).out;
  }
}

ControllerSwitch::ControllerSwitch(const HandLoop& loop,
                                   std::span<const controller::ControllerConfig> further)
    : place_of_(1) {
  for (const controller::ControllerConfig& config : further) {
    place_of_.push_back(waiting_.size());
    waiting_.push_back(loop.controller().Prepare(config));
  }
}

bool ControllerSwitch::To(int number, HandLoop& loop) noexcept {
  if (number < 0 || number >= std::ssize(place_of_) || number == driving_) return false;
  const std::size_t place = place_of_[static_cast<std::size_t>(number)];
  if (!loop.Swap(waiting_[place])) return false;
  place_of_[static_cast<std::size_t>(driving_)] = place;
  driving_ = number;
  return true;
}

}  // namespace gauntlet::sim
