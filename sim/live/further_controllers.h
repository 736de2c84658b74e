#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "controller/controller.h"
#include "sim/live/duration_histogram.h"
#include "sim/live/live_session.h"
#include "sim/trial/loop/hand_loop.h"

namespace gauntlet::sim {

/// Further controllers that get the samples of the one that drives, and drive nothing. For a
/// watcher the one that began is among them: another one may drive in its place. Of the control
/// thread.
class Shadows {
 public:
  /// Errors: SettingError of a controller.
  explicit Shadows(const LiveSetup& setup);

  bool exist() const noexcept { return !controllers_.empty(); }
  /// As new, told where the motors are.
  void Reset(std::span<const std::int32_t> motor_counts);
  /// A tick with the counts of a sample, or without (empty).
  void Step(std::span<const double> sample_counts) noexcept;
  /// Angles that they ask for after the last step. Shape: shadows x joints. Units: rad.
  std::span<const double> targets_rad() const noexcept {
    return std::span(targets_rad_).last(targets_rad_.size() - (has_first_ ? joints_ : 0));
  }
  /// Angles as above, with those of the controller that began before the shadows; without a watcher
  /// or shadows, those alone.
  std::span<const double> asked_rad() const noexcept { return targets_rad_; }
  /// Times of the steps of a shadow.
  const DurationHistogram& step(std::size_t shadow) const {
    return steps_[shadow + (has_first_ ? 1 : 0)];
  }

 private:
  std::size_t joints_;
  bool has_first_;  // the controller that began is the first of these
  std::vector<controller::Controller> controllers_;
  std::vector<DurationHistogram> steps_;
  std::vector<double> targets_rad_;
};

/// The controllers among which a running loop may switch: the one that it began with, number 0, and
/// further ones. All are prepared before, so that a switch neither allocates nor waits.
class ControllerSwitch {
 public:
  /// Errors: SettingError of a controller.
  ControllerSwitch(const HandLoop& loop, std::span<const controller::ControllerConfig> further);

  /// Takes over the settings of a controller from the next sample on, as Controller::Swap() does:
  /// the command goes on from where it is. Of the thread of Step(). False, without a change, for
  /// the one that drives already, and for a number that there is not.
  bool To(int number, HandLoop& loop) noexcept;
  int driving() const noexcept { return driving_; }

 private:
  std::vector<controller::Controller> waiting_;
  std::vector<std::size_t> place_of_;  // of each controller in waiting_; of the driving one, none
  int driving_ = 0;
};

}  // namespace gauntlet::sim
