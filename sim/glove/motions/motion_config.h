#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "controller/settings.h"

namespace gauntlet::sim {

/// Nothing moves.
struct HoldConfig {
  double duration_s = 2.0;
  std::size_t posture = 0;  // index of Postures()

  void Visit(controller::SettingsVisitor& visitor);
};

/// Joint angles from a file of comma-separated values, brought to the sampling rate.
struct RecordedMotionConfig {
  std::string file;
  double start_s = 0.0;
  double duration_s = 0.0;  // 0: to the end

  void Visit(controller::SettingsVisitor& visitor);
};

/// Band-limited random motion of every channel by itself.
struct RandomMotionConfig {
  double duration_s = 10.0;
  double bandwidth_hz = 0.7;
  double range_percent = 80.0;

  void Visit(controller::SettingsVisitor& visitor);
};

enum class MotionKind { kHold, kRecording, kRandom };

/// What the wearer does.
struct MotionConfig {
  MotionKind kind = MotionKind::kRandom;
  HoldConfig hold;
  RecordedMotionConfig recording;
  RandomMotionConfig random;

  /// Shows the kind and the settings of that kind.
  void Visit(controller::SettingsVisitor& visitor);
};

}  // namespace gauntlet::sim
