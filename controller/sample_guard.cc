#include "controller/sample_guard.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string_view>
#include <utility>

#include "controller/assert.h"
#include "controller/filters/vectorise.h"
#include "controller/number.h"

namespace gauntlet::controller {
namespace {

constexpr double kNever = std::numeric_limits<double>::infinity();
/// Consecutive stale frames with rising numbers that prove the number before them wrong.
constexpr int kRisingFrames = 5;

double SamplesOf(double duration_ms, double rate_hz) {
  // Rounded up: a glove slower than the duration must repeat the value once.
  return std::ceil(duration_ms * 1e-3 * rate_hz - 1e-6);
}

/// Per-channel state arrays, and the limits for the fast path.
struct Channels {
  double *trusted, *raw, *same, *confirmed;
  const double* seen;
  double* good;
};
struct Limits {
  const double *least, *most, *jump;
  double stuck;
};

/// Fast path: `good` is 1 for channels whose value is inside the converter's range, near the last
/// good value and not stuck, else 0. Takes the values if all are good; else only `good` changes.
GAUNTLET_VECTORISED bool AcceptIfAllGood(const double* counts, const Channels& channels,
                                         const Limits& limits, int channel_count) {
  const auto [trusted, raw, same, confirmed, seen, good] = channels;
  const auto [least, most, jump, stuck] = limits;
  GAUNTLET_CHANNEL_LOOP
  for (int i = 0; i < channel_count; ++i) {
    const double z = counts[i];
    const double last = trusted[i];
    const double known = seen[i];
    // One conditional per line on values that were read: the compiler vectorises no other form.
    const double again = z == raw[i] ? 1.0 : 0.0;
    const double samples = again * (same[i] + 1.0);
    const double low = least[i];
    const double high = most[i];
    const double step = jump[i];
    const double above = z > low ? known : 0.0;
    const double inside = z < high ? above : 0.0;
    const double near = std::abs(z - last) <= step ? inside : 0.0;
    good[i] = samples < stuck ? near : 0.0;
  }
  constexpr auto kYes = std::bit_cast<std::uint64_t>(1.0);
  std::uint64_t all = kYes;
  for (int i = 0; i < channel_count; ++i) all &= std::bit_cast<std::uint64_t>(good[i]);
  if (all != kYes) return false;
  GAUNTLET_CHANNEL_LOOP
  for (int i = 0; i < channel_count; ++i) {
    const double z = counts[i];
    const double again = z == raw[i] ? 1.0 : 0.0;
    same[i] = again * (same[i] + 1.0);
    trusted[i] = z;
    raw[i] = z;
    confirmed[i] = 0.0;
  }
  return true;
}

}  // namespace

void SampleGuardConfig::Visit(SettingsVisitor& visitor) {
  visitor.Flag({"full_scale",
                "do not trust values at either end of the converter (broken wire, short circuit)"},
               full_scale);
  visitor.Number(
      {"stuck_after_ms", "a value unchanged for so long counts as stuck; 0 is never", 0, 1e6},
      stuck_after_ms);
  visitor.Number(
      {"jump_share",
       "a change between two samples by more than this share of the converter's range is a jump; 0 "
       "is never",
       0, 1},
      jump_share);
  visitor.Number(
      {"jump_confirm_ms",
       "a jump is trusted after the value has stayed at its new place for so long", 0, 1e6},
      jump_confirm_ms);
  visitor.Number({"lost_after_ms",
                  "a channel without a trusted value for so long is lost; 0 is never", 0, 1e6},
                 lost_after_ms);
  static constexpr std::array<std::string_view, 2> kNames = {"hold", "rest"};
  VisitEnum(visitor,
            {"when_lost",
             "hold: a lost channel goes to its last trusted value; rest: to the reference posture"},
            kNames, when_lost);
  visitor.Number({"lost_speed_deg_s", "a lost channel moves no faster", 0.1, 1e4},
                 lost_speed_deg_s);
}

SampleGuard::SampleGuard(const SampleGuardConfig& config, std::span<const double> start_counts,
                         std::span<const ConverterRange> converters, double rate_hz,
                         int frame_number_bits)
    : refuse_full_scale_(config.full_scale),
      stuck_samples_(config.stuck_after_ms > 0.0 ? SamplesOf(config.stuck_after_ms, rate_hz)
                                                 : kNever),
      confirm_samples_(SamplesOf(config.jump_confirm_ms, rate_hz)),
      frame_number_bits_(frame_number_bits),
      limits_(kLimits, static_cast<int>(start_counts.size())),
      values_(kValues, static_cast<int>(start_counts.size())),
      held_(start_counts.size()),
      untrusted_samples_(start_counts.size()) {
  GAUNTLET_ASSERT(converters.size() == start_counts.size() && rate_hz > 0.0);
  GAUNTLET_ASSERT(1 <= frame_number_bits && frame_number_bits <= 64);
  for (std::size_t i = 0; i < converters.size(); ++i) {
    const double span_counts = converters[i].span_counts();
    GAUNTLET_ASSERT(span_counts > 0.0);
    limits_[kLeast][i] = converters[i].min_counts;
    limits_[kMost][i] = converters[i].full_scale_counts;
    limits_[kJump][i] = config.jump_share > 0.0 ? config.jump_share * span_counts : kNever;
  }
  for (auto& counts : untrusted_by_kind_) counts.resize(start_counts.size());
  Reset(start_counts);
}

bool SampleGuard::IsAhead(std::int64_t number, std::int64_t of) const noexcept {
  const std::uint64_t difference =
      static_cast<std::uint64_t>(number) - static_cast<std::uint64_t>(of);
  return static_cast<std::int64_t>(difference << (64 - frame_number_bits_)) > 0;
}

bool SampleGuard::IsStale(const GloveSample& sample) noexcept {
  if (!sample.number) return false;
  if (last_number_ && !IsAhead(*sample.number, *last_number_)) {
    if (stale_frames_ == 0 || IsAhead(*sample.number, stale_number_)) {
      ++stale_frames_;
    } else if (*sample.number != stale_number_) {  // a repeated number is no evidence
      stale_frames_ = 1;
    }
    stale_number_ = *sample.number;
    if (stale_frames_ < kRisingFrames) return true;
  }
  last_number_ = sample.number;
  stale_frames_ = 0;
  return false;
}

bool SampleGuard::AcceptTrusted(const GloveSample& sample, bool stale) noexcept {
  if (stale || sample.counts.size() < untrusted_samples_.size()) {
    std::fill_n(values_[kGood], values_.channel_count(), 0.0);
    return false;
  }
  const Channels channels = {.trusted = values_[kTrusted],
                             .raw = values_[kRaw],
                             .same = values_[kSame],
                             .confirmed = values_[kConfirmed],
                             .seen = values_[kSeen],
                             .good = values_[kGood]};
  const Limits limits = {.least = limits_[kLeast],
                         .most = limits_[kMost],
                         .jump = limits_[kJump],
                         .stuck = stuck_samples_};
  return AcceptIfAllGood(sample.counts.data(), channels, limits, values_.channel_count());
}

void SampleGuard::Refuse(int channel, Untrusted kind) noexcept {
  const auto index = static_cast<std::size_t>(channel);
  held_[index] = static_cast<std::uint8_t>(1 + static_cast<int>(kind));
  ++untrusted_samples_[index];
  ++untrusted_by_kind_[static_cast<std::size_t>(kind)][index];
}

bool SampleGuard::IsJump(int channel, double counts) noexcept {
  double& confirmed = values_[kConfirmed][channel];
  double& candidate = values_[kCandidate][channel];
  const double jump_counts = limits_[kJump][channel];
  if (std::abs(counts - values_[kTrusted][channel]) <= jump_counts) {
    confirmed = 0.0;
    return false;
  }
  const bool stays = confirmed > 0.0 && std::abs(counts - candidate) <= jump_counts;
  candidate = counts;
  confirmed = stays ? confirmed + 1.0 : 1.0;
  return confirmed <= confirm_samples_;
}

void SampleGuard::Miss() noexcept {
  all_trusted_ = false;
  for (int channel = 0; channel < values_.channel_count(); ++channel) {
    Refuse(channel, Untrusted::kMissing);
  }
}

void SampleGuard::CheckDoubtful(int channel, const GloveSample& sample, bool stale) noexcept {
  const auto index = static_cast<std::size_t>(channel);
  held_[index] = 0;
  const double counts = index < sample.counts.size() ? sample.counts[index] : kNaN;
  if (values_[kGood][channel] == 1.0) {
    const bool again = counts == values_[kRaw][channel];
    values_[kSame][channel] = again ? values_[kSame][channel] + 1.0 : 0.0;
    values_[kTrusted][channel] = values_[kRaw][channel] = counts;
    values_[kConfirmed][channel] = 0.0;
    return;
  }
  if (std::isnan(counts)) return Refuse(channel, Untrusted::kMissing);
  if (stale) return Refuse(channel, Untrusted::kStale);
  if (std::isinf(counts)) return Refuse(channel, Untrusted::kInfinite);
  const ConverterRange range = converter(index);
  if (!range.Contains(counts)) return Refuse(channel, Untrusted::kOutOfRange);
  if (refuse_full_scale_ && range.IsEnd(counts)) return Refuse(channel, Untrusted::kFullScale);
  if (IsJump(channel, counts)) return Refuse(channel, Untrusted::kJumped);
  double& same = values_[kSame][channel];
  same = counts == values_[kRaw][channel] ? std::min(same + 1.0, stuck_samples_) : 0.0;
  values_[kRaw][channel] = counts;
  if (same >= stuck_samples_) return Refuse(channel, Untrusted::kStuck);
  values_[kSeen][channel] = 1.0;
  values_[kTrusted][channel] = counts;
}

double SampleGuard::StartAt(std::size_t channel, double counts) const noexcept {
  const ConverterRange range = converter(channel);
  return std::clamp(counts, range.min_counts, range.full_scale_counts);
}

void SampleGuard::Reset(std::span<const double> start_counts) noexcept {
  GAUNTLET_ASSERT(start_counts.size() == untrusted_samples_.size());
  values_.SetZero();
  for (std::size_t i = 0; i < untrusted_samples_.size(); ++i) {
    values_[kTrusted][i] = StartAt(i, start_counts[i]);
    values_[kRaw][i] = kNaN;  // like a missing value
  }
  last_number_.reset();
  stale_frames_ = 0;
  all_trusted_ = true;
  std::fill(untrusted_samples_.begin(), untrusted_samples_.end(), 0);
  for (auto& counts : untrusted_by_kind_) std::fill(counts.begin(), counts.end(), 0);
}

void SampleGuard::SwapMemory(SampleGuard& from, std::span<const double> start_counts) noexcept {
  GAUNTLET_ASSERT(from.untrusted_samples_.size() == untrusted_samples_.size());
  GAUNTLET_ASSERT(start_counts.size() == untrusted_samples_.size());
  std::swap(values_, from.values_);
  std::swap(last_number_, from.last_number_);
  std::swap(stale_number_, from.stale_number_);
  std::swap(stale_frames_, from.stale_frames_);
  std::swap(all_trusted_, from.all_trusted_);
  std::swap(held_, from.held_);
  std::swap(untrusted_samples_, from.untrusted_samples_);
  std::swap(untrusted_by_kind_, from.untrusted_by_kind_);
  for (std::size_t i = 0; i < untrusted_samples_.size(); ++i) {
    if (values_[kSeen][i] == 0.0) values_[kTrusted][i] = StartAt(i, start_counts[i]);
  }
}

}  // namespace gauntlet::controller
