#pragma once

#include <cstddef>
#include <optional>
#include <string_view>
#include <variant>
#include <vector>

#include "controller/kinds.h"
#include "controller/settings.h"

namespace gauntlet::sim {

/// No frame takes longer: one that would is lost.
inline constexpr double kLongestDelayMs = 10'000.0;

/// Equal time for every frame.
struct ConstantDelay {
  static constexpr std::string_view kKind = "constant";
  static constexpr std::string_view kSummary = "every frame takes the same time";

  double delay_ms = 0.0;

  void Visit(controller::SettingsVisitor& visitor);
};

/// Gamma distribution by mean m and standard deviation s: shape (m / s)^2, scale s^2 / m.
struct GammaDelay {
  static constexpr std::string_view kKind = "gamma";
  static constexpr std::string_view kSummary = "gamma distribution, by mean and deviation";

  double mean_ms = 10.0;
  double deviation_ms = 5.0;

  void Visit(controller::SettingsVisitor& visitor);
};

/// Log-normal distribution by two quantiles: p50 exp(s z), s = ln(p99 / p50) / z_99, z normal.
struct LogNormalDelay {
  static constexpr std::string_view kKind = "log_normal";
  static constexpr std::string_view kSummary = "log-normal distribution, by median and p99";

  double p50_ms = 5.0;
  double p99_ms = 20.0;

  /// s, the standard deviation of the logarithm.
  double Deviation() const;
  void Visit(controller::SettingsVisitor& visitor);
};

/// A measured histogram from 0 on; uniform within a bucket.
struct HistogramDelay {
  static constexpr std::string_view kKind = "histogram";
  static constexpr std::string_view kSummary = "a measured histogram, uniform within each bucket";

  double bucket_ms = 1.0;
  std::vector<double> counts = {1.0};

  void Visit(controller::SettingsVisitor& visitor);
};

using DelaySettings = std::variant<ConstantDelay, GammaDelay, LogNormalDelay, HistogramDelay>;

/// How long a frame is on its way.
struct DelayConfig {
  DelaySettings settings;

  void Visit(controller::SettingsVisitor& visitor) {
    controller::VisitKind(visitor, {"kind", "distribution of the time on the way"}, settings);
  }
  /// Errors: SettingError for quantiles that do not rise and an empty histogram.
  void Check() const;
  /// Mean of the distribution [ms], of settings that Check() accepts.
  double MeanMs() const;
};

struct NoLoss {
  static constexpr std::string_view kKind = "none";
  static constexpr std::string_view kSummary = "every frame arrives";

  void Visit(controller::SettingsVisitor&) {}
};

/// Each frame by itself.
struct IndependentLoss {
  static constexpr std::string_view kKind = "independent";
  static constexpr std::string_view kSummary = "frames are lost one by one";

  double percent = 1.0;

  void Visit(controller::SettingsVisitor& visitor);
};

/// Two states. In the good one nothing is lost; a burst begins at a frame with probability p and
/// ends at one with probability r = 1 / mean_frames. With lost_percent 100:
///
///     share of lost frames = p / (p + r)        P(burst > k frames) = (1 - r)^k
///
/// Source: Gilbert 1960, Elliott 1963.
struct GilbertElliottLoss {
  static constexpr std::string_view kKind = "gilbert_elliott";
  static constexpr std::string_view kSummary = "frames are lost in bursts";

  double begin_percent = 0.4;
  double mean_frames = 5.0;
  double lost_percent = 100.0;

  void Visit(controller::SettingsVisitor& visitor);
};

using LossSettings = std::variant<NoLoss, IndependentLoss, GilbertElliottLoss>;

/// Which frames never arrive.
struct LossConfig {
  LossSettings settings;

  void Visit(controller::SettingsVisitor& visitor) {
    controller::VisitKind(visitor, {"kind", "which frames are lost"}, settings);
  }
};

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
