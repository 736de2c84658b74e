#include "sim/trial/link/watchdog_config.h"

namespace gauntlet::sim {

void TieredWatchdog::Visit(controller::SettingsVisitor& visitor) {
  visitor.Number({"hold_after_ms", "time without a frame until the command is held", 1, 100000},
                 hold_after_ms);
  visitor.Number(
      {"relax_after_ms", "until the motors turn to the hand's reference posture", 1, 100000},
      relax_after_ms);
  visitor.Number({"off_after_ms",
                  "until motors lose their torque, or a computer stops sending frames", 1, 100000},
                 off_after_ms);
  visitor.Number({"relax_deg_s", "speed of the spools when they relax", 0.1, 10000}, relax_deg_s);
  visitor.Number(
      {"return_deg_s", "largest speed of the spools until they follow again", 0.1, 100000},
      return_deg_s);
  visitor.Integer({"good_frames", "new frames until the hand follows again", 1, 10000},
                  good_frames);
}

void WatchdogConfig::Check() const {
  const auto* tiers = std::get_if<TieredWatchdog>(&settings);
  if (tiers == nullptr) return;
  const auto check = [](const char* key, double value, const char* before, double least) {
    if (value >= least) return;
    throw controller::SettingError(key, "is " + controller::NumberText(value) +
                                            ", must be at least " + before + ", " +
                                            controller::NumberText(least));
  };
  check("relax_after_ms", tiers->relax_after_ms, "hold_after_ms", tiers->hold_after_ms);
  check("off_after_ms", tiers->off_after_ms, "relax_after_ms", tiers->relax_after_ms);
}

}  // namespace gauntlet::sim
