#pragma once

#include <optional>

#include "controller/settings.h"
#include "sim/trial/link/receiver_config.h"
#include "sim/trial/link/transport_config.h"
#include "sim/trial/link/watchdog_config.h"

namespace gauntlet::sim {

/// One way: what happens to its frames, how they are received, and what if none come.
struct LinkConfig {
  TransportConfig transport;
  ReceiverConfig receiver;
  WatchdogConfig watchdog;

  void Visit(controller::SettingsVisitor& visitor) {
    transport.Visit(visitor);
    controller::VisitGroup(visitor, {"receiver", "what the receiver does with frames"}, receiver);
    controller::VisitGroup(visitor, {"watchdog", "what happens when frames stay away"}, watchdog);
  }
  /// Errors: SettingError.
  void Check() const;
};

/// Both ways: from the glove to the computer, from the computer to the hand. One that is absent
/// passes every frame at once, or after the event delay.
struct LinksConfig {
  std::optional<LinkConfig> glove;
  std::optional<LinkConfig> hand;

  /// Errors: SettingError `link. ..`.
  void Check() const;
  bool exist() const { return glove || hand; }
  void Visit(controller::SettingsVisitor& visitor) {
    controller::VisitOptionalGroup(visitor, {"glove", "from the glove to the computer"}, glove);
    controller::VisitOptionalGroup(
        visitor, {"hand", "from the computer to the hand, in addition to the fixed delay"}, hand);
  }
};

}  // namespace gauntlet::sim
