#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "controller/filters/channel_arrays.h"
#include "controller/settings.h"

namespace gauntlet::controller {

/// One sample of the data glove, as the analog-digital converter gives it.
///
/// Shapes: one value per channel. Units: counts. NaN stands for a missing value; a shorter or empty
/// `counts` lacks its last or all channels; what is beyond the last channel is not read.
struct GloveSample {
  std::span<const double> counts;
  /// The frame's number, if the glove counts its frames: each is one more than the one before, and
  /// begins anew at the width that GloveCalibration tells. A frame that is not ahead of the last
  /// one (by less than half of all numbers) is late or repeated.
  std::optional<std::int64_t> number = {};
};

/// Why a value is not trusted.
enum class Untrusted {
  kMissing,     // NaN, or not there at all
  kInfinite,    // plus or minus infinity
  kOutOfRange,  // below 0 or above full scale: no converter gives that
  kFullScale,   // at an end of the converter: a broken wire or a short circuit
  kStuck,       // unchanged for too long
  kJumped,      // farther from the last good value than a joint can move, and not confirmed
  kStale,       // of a late or repeated frame
};
inline constexpr int kUntrustedKinds = 7;

/// What makes a value untrusted besides not being a number within the converter's range.
struct SampleGuardConfig {
  bool full_scale = true;
  double stuck_after_ms = 1000.0;
  double jump_share = 0.25;
  double jump_confirm_ms = 10.0;

  bool operator==(const SampleGuardConfig&) const = default;
  void Visit(SettingsVisitor& visitor);
};

/// Lets only values through that can be trusted; a channel without one holds its last good value,
/// and recovers by itself with the next good one.
///
/// A jump is confirmed, and then trusted, when the value stays near its new place for
/// `jump_confirm_ms`: what looked like a fault was a motion or a change of the sensor. The first
/// value of all is held against where the hand is, in the same way.
/// A stuck value cannot be told from a hand at rest without noise; it is held either way, so the
/// count is all that changes.
/// Stale frames whose numbers rise from one to the next are a glove that has begun to count anew,
/// or a number before them that was wrong: the fifth of them is trusted, and others after it.
/// Units: counts. Shapes: one value per channel.
class SampleGuard {
 public:
  /// `start_counts`: what a channel holds before its first good value. Frames are counted modulo
  /// 2^frame_number_bits.
  SampleGuard(const SampleGuardConfig& config, std::span<const double> start_counts,
              double full_scale_counts, double rate_hz, int frame_number_bits = 64);

  /// Takes a sample in; trusted_counts() is up to date afterwards.
  /// Calls first_good(channel) for a channel whose first good value this is.
  template <class FirstGood>
  void Take(const GloveSample& sample, FirstGood first_good) noexcept {
    const bool stale = IsStale(sample);
    if (TakeTrusted(sample, stale)) return;
    for (int channel = 0; channel < values_.channel_count(); ++channel) {
      const bool first = values_[kSeen][channel] == 0.0;
      TakeDoubtful(channel, sample, stale);
      if (first && values_[kSeen][channel] == 1.0) first_good(channel);
    }
  }
  /// As new; a channel holds `start_counts` before its first good value.
  void Reset(std::span<const double> start_counts) noexcept;
  /// Takes values and counts of another guard with as many channels, which goes on with those of
  /// this one; the settings stay. Channels that still wait for their first good value hold
  /// `start_counts`.
  void TakeMemory(SampleGuard& from, std::span<const double> start_counts) noexcept;

  std::span<const double> trusted_counts() const noexcept {
    return {values_[kTrusted], untrusted_samples_.size()};
  }
  std::span<const std::int64_t> untrusted_samples() const noexcept { return untrusted_samples_; }
  std::span<const std::int64_t> untrusted_samples(Untrusted kind) const noexcept {
    return untrusted_by_kind_[static_cast<std::size_t>(kind)];
  }

 private:
  /// What is kept per channel: the value that is trusted; the last one in range, and for how many
  /// samples it has been the same; where it jumped to, and for how many samples it has been there;
  /// whether there has been a good value, 1 or 0; scratch of TakeTrusted().
  enum Value { kTrusted, kRaw, kSame, kCandidate, kConfirmed, kSeen, kGood, kValues };

  /// Frames are numbered on a circle; whether one number is ahead of another.
  bool IsAhead(std::int64_t number, std::int64_t of) const noexcept;
  bool IsStale(const GloveSample& sample) noexcept;
  /// Takes all values in if nothing speaks against any of them. False: nothing has changed.
  bool TakeTrusted(const GloveSample& sample, bool stale) noexcept;
  void TakeDoubtful(int channel, const GloveSample& sample, bool stale) noexcept;
  bool IsJump(int channel, double counts) noexcept;
  void Refuse(int channel, Untrusted kind) noexcept;
  double StartAt(double counts) const noexcept;

  bool refuse_full_scale_;
  double stuck_samples_;  // infinite: never
  double jump_counts_;    // infinite: never
  double confirm_samples_;
  double full_scale_counts_;
  int frame_number_bits_;
  ChannelArrays values_;
  std::optional<std::int64_t> last_number_;
  std::int64_t stale_number_ = 0;  // of the last stale frame, and how many have risen up to it
  int stale_frames_ = 0;
  std::vector<std::int64_t> untrusted_samples_;
  std::array<std::vector<std::int64_t>, kUntrustedKinds> untrusted_by_kind_;
};

}  // namespace gauntlet::controller
