#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "controller/settings.h"

namespace gauntlet::controller {

/// One sample of the data glove, as the analog-digital converter gives it.
///
/// Shapes: one value per channel. Units: counts. NaN stands for a missing value; a shorter or empty
/// `counts` lacks its last or all channels.
struct GloveSample {
  std::span<const double> counts;
  /// The frame's number as the glove counts them, growing; 0 if it does not. A frame whose number
  /// is not above the last one's is late or repeated.
  std::int64_t number = 0;
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

  void Visit(SettingsVisitor& visitor);
};

/// Lets only values through that can be trusted; a channel without one holds its last good value,
/// and recovers by itself with the next good one.
///
/// A jump is confirmed, and then trusted, when the value stays near its new place for
/// `jump_confirm_ms`: what looked like a fault was a motion or a change of the sensor.
/// A stuck value cannot be told from a hand at rest without noise; it is held either way, so the
/// count is all that changes.
/// Units: counts. Shapes: one value per channel.
class SampleGuard {
 public:
  /// `start_counts`: what a channel holds before its first good value.
  SampleGuard(const SampleGuardConfig& config, std::vector<double> start_counts,
              double full_scale_counts, double rate_hz);

  /// Takes a sample in; trusted_counts() is up to date afterwards.
  /// Calls first_good(channel) for a channel whose first good value this is.
  template <class FirstGood>
  void Take(const GloveSample& sample, FirstGood first_good) noexcept {
    const bool stale = IsStale(sample);
    for (std::size_t i = 0; i < channels_.size(); ++i) {
      const bool first = !channels_[i].seen;
      TakeChannel(i, sample, stale);
      if (first && channels_[i].seen) first_good(i);
    }
  }
  void Reset() noexcept;
  /// Takes over values and counts of another guard with as many channels; the settings stay.
  void CopyState(const SampleGuard& from) noexcept;

  std::span<const double> trusted_counts() const noexcept { return trusted_counts_; }
  std::span<const std::int64_t> untrusted_samples() const noexcept { return untrusted_samples_; }
  std::span<const std::int64_t> untrusted_samples(Untrusted kind) const noexcept {
    return untrusted_by_kind_[static_cast<std::size_t>(kind)];
  }

 private:
  struct Channel {
    bool seen = false;  // a good value
    double raw = 0.0;   // the last value in range, and for how many samples it has been the same
    int same = 0;
    double candidate = 0.0;  // where it jumped to, and for how many samples it has been there
    int confirmed = 0;
  };

  bool IsStale(const GloveSample& sample) noexcept;
  void TakeChannel(std::size_t channel, const GloveSample& sample, bool stale) noexcept;
  bool IsJump(Channel& channel, double counts, double trusted) noexcept;
  void Refuse(std::size_t channel, Untrusted kind) noexcept;

  bool refuse_full_scale_;
  int stuck_samples_;   // 0: never
  double jump_counts_;  // infinite: never
  int confirm_samples_;
  double full_scale_counts_;
  std::vector<double> start_counts_;
  std::vector<double> trusted_counts_;
  std::vector<Channel> channels_;
  std::int64_t last_number_ = 0;
  std::vector<std::int64_t> untrusted_samples_;
  std::array<std::vector<std::int64_t>, kUntrustedKinds> untrusted_by_kind_;
};

}  // namespace gauntlet::controller
