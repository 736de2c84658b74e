#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "controller/controller.h"
#include "sim/trial/loop/hand_loop.h"

namespace gauntlet::sim {

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
