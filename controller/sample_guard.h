#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "controller/filters/channel_arrays.h"
#include "controller/sample_guard_config.h"

namespace gauntlet::controller {

/// Passes trusted values only. A channel without one holds its last good value, and recovers with
/// the next good one.
///
/// A jump is confirmed, and then trusted, if the value stays near its new level for
/// `jump_confirm_ms`: it was a motion or a change of the sensor, not a fault. The first value is
/// compared with the position of the hand in the same way.
/// A stuck value looks like a resting hand without noise. The channel holds the value in both
/// cases; only the count differs.
/// Stale frames with rising numbers mean that the glove restarted its count, or that a number
/// before them was wrong. The fifth of them and those after it are trusted.
/// Units: counts. Shapes: one value per channel.
class SampleGuard {
 public:
  /// `start_counts`: value of a channel before its first good value. `converters`: of each channel.
  /// Frames are counted modulo 2^frame_number_bits.
  SampleGuard(const SampleGuardConfig& config, std::span<const double> start_counts,
              std::span<const ConverterRange> converters, double rate_hz,
              int frame_number_bits = 64);

  /// Takes a sample; trusted_counts() is up to date afterwards.
  /// Calls first_good(channel) for a channel whose first good value this is.
  template <class FirstGood>
  void Step(const GloveSample& sample, FirstGood first_good) noexcept {
    const bool stale = IsStale(sample);
    all_trusted_ = AcceptTrusted(sample, stale);
    if (all_trusted_) return;
    for (int channel = 0; channel < values_.channel_count(); ++channel) {
      const bool first = values_[kSeen][channel] == 0.0;
      CheckDoubtful(channel, sample, stale);
      if (first && values_[kSeen][channel] == 1.0) first_good(channel);
    }
  }
  /// A sample that was due did not come.
  void Miss() noexcept;
  /// True if the last sample, or absence of one, has a value of this channel that is trusted.
  bool trusted(std::size_t channel) const noexcept { return all_trusted_ || held_[channel] == 0; }
  bool all_trusted() const noexcept { return all_trusted_; }
  /// Reason why it is not trusted; none if it is.
  std::optional<Untrusted> reason(std::size_t channel) const noexcept {
    if (trusted(channel)) return {};
    return static_cast<Untrusted>(held_[channel] - 1);
  }
  /// Resets to the initial state; a channel holds `start_counts` before its first good value.
  void Reset(std::span<const double> start_counts) noexcept;
  /// Swaps values and counts with another guard of the same number of channels. The settings stay.
  /// Channels without a good value yet hold `start_counts`.
  void SwapMemory(SampleGuard& from, std::span<const double> start_counts) noexcept;

  std::span<const double> trusted_counts() const noexcept {
    return {values_[kTrusted], untrusted_samples_.size()};
  }
  std::span<const std::int64_t> untrusted_samples() const noexcept { return untrusted_samples_; }
  std::span<const std::int64_t> untrusted_samples(Untrusted kind) const noexcept {
    return untrusted_by_kind_[static_cast<std::size_t>(kind)];
  }

 private:
  /// State per channel: the trusted value; the last value in range, and the number of its
  /// repetitions; the level of a jump, and the number of its samples; 1 after the first good value;
  /// scratch of AcceptTrusted().
  enum Value { kTrusted, kRaw, kSame, kCandidate, kConfirmed, kSeen, kGood, kValues };

  /// Settings per channel: ends of the converter's range; the largest change between two samples,
  /// infinite if that is not checked.
  enum Limit { kLeast, kMost, kJump, kLimits };

  /// True if frame number `number` is ahead of `of` on the circle of numbers.
  bool IsAhead(std::int64_t number, std::int64_t of) const noexcept;
  bool IsStale(const GloveSample& sample) noexcept;
  /// Takes all values if all pass the fast path. False: nothing has changed.
  bool AcceptTrusted(const GloveSample& sample, bool stale) noexcept;
  void CheckDoubtful(int channel, const GloveSample& sample, bool stale) noexcept;
  bool IsJump(int channel, double counts) noexcept;
  void Refuse(int channel, Untrusted kind) noexcept;
  double StartAt(std::size_t channel, double counts) const noexcept;
  ConverterRange converter(std::size_t channel) const noexcept {
    return {limits_[kLeast][channel], limits_[kMost][channel]};
  }

  bool refuse_full_scale_;
  double stuck_samples_;  // infinite: disabled
  double confirm_samples_;
  int frame_number_bits_;
  ChannelArrays limits_;
  ChannelArrays values_;
  std::optional<std::int64_t> last_number_;
  std::int64_t stale_number_ = 0;  // of the last stale frame, and number of rising ones
  int stale_frames_ = 0;
  bool all_trusted_ = true;         // if so, `held_` says nothing
  std::vector<std::uint8_t> held_;  // per channel: 0, or 1 + the kind of its untrusted last value
  std::vector<std::int64_t> untrusted_samples_;
  std::array<std::vector<std::int64_t>, kUntrustedKinds> untrusted_by_kind_;
};

}  // namespace gauntlet::controller
