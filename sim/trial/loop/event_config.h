#pragma once

#include "controller/settings.h"

namespace gauntlet::sim {

/// When commands leave and arrive: one frame per period, and it takes effect after the delay.
/// Source: Bai, Jiang, Yokoi, section 3: an event every 0.02 s, event time below 45 ms. The delay's
/// default lies in the middle of what that allows: an assumption.
struct EventConfig {
  double period_ms = 20.0;
  double delay_ms = 25.0;

  void Visit(controller::SettingsVisitor& visitor) {
    visitor.Number({"period_ms", "time between two command frames", 1, 1000}, period_ms);
    visitor.Number(
        {"delay_ms",
         "time until a command frame reaches the servos, in whole steps of 1 ms or less", 0, 1000},
        delay_ms);
  }
};

}  // namespace gauntlet::sim
