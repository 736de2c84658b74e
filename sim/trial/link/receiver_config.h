#pragma once

#include <string_view>
#include <variant>

#include "controller/kinds.h"
#include "controller/settings.h"

namespace gauntlet::sim {

/// The newest frame counts; older ones are dropped.
struct NewestReceiver {
  static constexpr std::string_view kKind = "newest";
  static constexpr std::string_view kSummary = "uses the newest frame, drops older ones";

  void Visit(controller::SettingsVisitor&) {}
};

/// Every frame in its order, one in each period of the sender. What has piled up stays.
struct QueueReceiver {
  static constexpr std::string_view kKind = "queue";
  static constexpr std::string_view kSummary =
      "uses every frame in order, one per period: delay piles up";

  int longest_frames = 1000;  // the high-water mark of ZeroMQ, which then drops new frames, too

  void Visit(controller::SettingsVisitor& visitor);
};

/// A frame is used `delay_ms` after the earliest time at which it could have arrived.
struct BufferReceiver {
  static constexpr std::string_view kKind = "buffer";
  static constexpr std::string_view kSummary = "uses each frame at a fixed time after its capture";

  double delay_ms = 20.0;
  double window_ms = 10'000.0;

  void Visit(controller::SettingsVisitor& visitor);
};

/// As BufferReceiver, with a quantile of the measured delays.
struct AdaptiveBufferReceiver {
  static constexpr std::string_view kKind = "adaptive_buffer";
  static constexpr std::string_view kSummary =
      "a buffer as long as a quantile of the measured relative delays";

  double quantile_percent = 95.0;
  double longest_ms = 150.0;
  double window_ms = 10'000.0;

  void Visit(controller::SettingsVisitor& visitor);
};

using ReceiverSettings =
    std::variant<NewestReceiver, QueueReceiver, BufferReceiver, AdaptiveBufferReceiver>;

struct HoldGap {
  static constexpr std::string_view kKind = "hold";
  static constexpr std::string_view kSummary = "repeats the last frame";

  void Visit(controller::SettingsVisitor&) {}
};

/// Last frame + slope of the line through the frames of the last `slope_ms` times the time by which
/// a newer frame is overdue.
struct PredictGap {
  static constexpr std::string_view kKind = "predict";
  static constexpr std::string_view kSummary = "extrapolates the slope of the last frames";

  double slope_ms = 40.0;
  double longest_ms = 60.0;

  void Visit(controller::SettingsVisitor& visitor);
};

using GapSettings = std::variant<HoldGap, PredictGap>;

struct GapConfig {
  GapSettings settings;

  void Visit(controller::SettingsVisitor& visitor) {
    controller::VisitKind(visitor, {"kind", "what is used while a frame is overdue"}, settings);
  }
};

/// Handling of the frames that arrive at a receiver.
struct ReceiverConfig {
  ReceiverSettings settings;
  GapConfig gap = {};

  void Visit(controller::SettingsVisitor& visitor) {
    controller::VisitKind(visitor, {"kind", "which frame is used, and when"}, settings);
    controller::VisitGroup(visitor, {"gap", "what is used while a frame is overdue"}, gap);
  }
};

}  // namespace gauntlet::sim
