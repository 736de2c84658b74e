#pragma once

#include <string_view>
#include <variant>

#include "controller/kinds.h"
#include "controller/settings.h"
#include "sim/base/random.h"

namespace gauntlet::sim {

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

/// Draws whether frames are lost, one after the other.
class LossDraw {
 public:
  LossDraw(const LossConfig& config, RandomStream random)
      : settings_(config.settings), random_(random) {}

  /// True if the next frame is lost.
  bool Next() noexcept;

 private:
  LossSettings settings_;
  RandomStream random_;
  bool in_burst_ = false;
};

}  // namespace gauntlet::sim
