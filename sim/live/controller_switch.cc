#include "sim/live/controller_switch.h"

#include <iterator>

namespace gauntlet::sim {

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
