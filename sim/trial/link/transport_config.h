#pragma once

#include "controller/settings.h"
#include "sim/trial/link/delay_config.h"
#include "sim/trial/link/loss_config.h"

namespace gauntlet::sim {

/// The way of frames from a sender to a receiver.
struct TransportConfig {
  std::size_t preset = 0;  // in LinkPresets(): what the settings below begin with
  DelayConfig delay = {};
  LossConfig loss = {};
  double frame_ms = 0.0;  // for which a frame occupies the link
  double batch_ms = 0.0;

  /// True if the delays of two frames can differ, apart from the time for which one is occupied.
  bool has_jitter() const;
  /// Every frame with the mean delay.
  TransportConfig WithoutJitter() const;
  void Visit(controller::SettingsVisitor& visitor);
};

}  // namespace gauntlet::sim
