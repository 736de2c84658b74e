#pragma once

#include "controller/settings.h"

namespace gauntlet::sim {

enum class JointSensorsKind { kNone, kEncoder };

/// Sensors of the hand's joints. Source of resolution and noise: ams AS5600, a magnetic encoder
/// of 12 bits a turn, data sheet v1-06: 0.043 deg RMS with its fastest filter. Rate: that of the
/// joint loop of orcahand/orca_core PR #83; the delay on the bus is an assumption.
struct JointSensorsConfig {
  JointSensorsKind kind = JointSensorsKind::kNone;
  int resolution_bits = 12;
  double noise_deg = 0.043;  // standard deviation
  double rate_hz = 100.0;
  double delay_ms = 5.0;

  void Visit(controller::SettingsVisitor& visitor);
};

}  // namespace gauntlet::sim
