#pragma once

#include "controller/controller_config.h"

namespace gauntlet::test {

/// Two motors of 1000 counts per radian; the safe posture is 500.
inline controller::TendonTransmission TwoMotors() {
  controller::TendonTransmission hand;
  hand.motor_names = {"a", "b"};
  hand.counts_per_rad = {1000.0, -1000.0};
  hand.center_counts = {500, 500};
  return hand;
}

}  // namespace gauntlet::test
