#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "controller/export.h"
#include "controller/settings.h"

namespace gauntlet::controller {

/// One sample of the data glove, as the analog-digital converter returns it.
///
/// Shapes: one value per channel. Units: counts. NaN is a missing value. If `counts` is too short,
/// the last channels are missing; values beyond the last channel are ignored.
struct GAUNTLET_API GloveSample {
  std::span<const double> counts;
  /// Number of the frame, if the glove counts its frames. It increases by one per frame and wraps
  /// at the width in GloveCalibration. A frame is late or repeated if its number is not ahead of
  /// the last one by less than half of all numbers.
  std::optional<std::int64_t> number = {};
};

/// The smallest and the largest value of a channel's converter [counts]. `min_counts` is negative
/// for a signed one.
struct GAUNTLET_API ConverterRange {
  double min_counts = 0.0;
  double full_scale_counts = 1023.0;

  double span_counts() const { return full_scale_counts - min_counts; }
  bool Contains(double counts) const { return min_counts <= counts && counts <= full_scale_counts; }
  bool IsEnd(double counts) const { return counts == min_counts || counts == full_scale_counts; }

  bool operator==(const ConverterRange&) const = default;
};

/// Reason why a value is not trusted.
enum class Untrusted {
  kMissing,     // NaN, no value, or a sample that was due and did not come
  kInfinite,    // plus or minus infinity
  kOutOfRange,  // below or above what the converter can give
  kFullScale,   // at an end of the converter: a broken wire or a short circuit
  kStuck,       // unchanged for too long
  kJumped,      // further from the last good value than a joint can move, not confirmed
  kStale,       // from a late or repeated frame
};
inline constexpr int kUntrustedKinds = 7;

/// Status of a glove: the worst that holds of an active channel.
enum class GloveStatus {
  kGood,      // every value of the last sample is trusted, and none is overdue
  kHeld,      // a channel holds its last trusted value
  kTooOften,  // samples come much more often than Timing says: filters are too fast by as much
  kLost,      // a channel is lost, see SampleGuardConfig
};

/// Target of the joint of a lost channel: the last trusted value, without what a prediction was
/// ahead of it; or the reference posture.
enum class WhenLost { kHold, kRest };

/// Conditions for an untrusted value, in addition to missing values and values outside the range.
///
/// A channel without a trusted value for `lost_after_ms` is lost: its angle moves by at most
/// `lost_speed_deg_s` to where `when_lost` says. The next trusted value ends that.
struct GAUNTLET_API SampleGuardConfig {
  bool full_scale = true;
  double stuck_after_ms = 1000.0;
  double jump_share = 0.25;
  double jump_confirm_ms = 10.0;
  double lost_after_ms = 0.0;
  WhenLost when_lost = WhenLost::kHold;
  double lost_speed_deg_s = 30.0;

  bool operator==(const SampleGuardConfig&) const = default;
  void Visit(SettingsVisitor& visitor);
};

}  // namespace gauntlet::controller
