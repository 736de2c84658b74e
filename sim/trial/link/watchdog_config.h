#pragma once

#include <string_view>
#include <variant>

#include "controller/kinds.h"
#include "controller/settings.h"

namespace gauntlet::sim {

struct NoWatchdog {
  static constexpr std::string_view kKind = "none";
  static constexpr std::string_view kSummary = "the last command stays";

  void Visit(controller::SettingsVisitor&) {}
};

/// Tiers by the time since the last frame. Defaults: an assumption near what others use; orca_hand
/// freezes its integrators after 50 ms, UR stops trajectories after 200 ms, Stretch's bus watchdog
/// trips after 1 s. A hand that returns slower than the wearer moves does not catch up.
struct TieredWatchdog {
  static constexpr std::string_view kKind = "tiers";
  static constexpr std::string_view kSummary = "hold, then relax to a safe posture, then off";

  double hold_after_ms = 50.0;
  double relax_after_ms = 200.0;
  double off_after_ms = 1000.0;
  double relax_deg_s = 60.0;
  double return_deg_s = 300.0;
  int good_frames = 5;

  void Visit(controller::SettingsVisitor& visitor);
};

using WatchdogSettings = std::variant<NoWatchdog, TieredWatchdog>;

/// Reaction to frames that stay away.
struct WatchdogConfig {
  WatchdogSettings settings;

  void Visit(controller::SettingsVisitor& visitor) {
    controller::VisitKind(visitor, {"kind", "what happens when frames stay away"}, settings);
  }
  /// Errors: SettingError for tiers that are not in order.
  void Check() const;
};

}  // namespace gauntlet::sim
