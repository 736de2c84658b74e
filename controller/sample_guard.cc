#include "controller/sample_guard.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace gauntlet::controller {
namespace {

int SamplesOf(double duration_ms, double rate_hz) {
  // A glove slower than the duration still has to say it once more.
  const double samples = std::ceil(duration_ms * 1e-3 * rate_hz - 1e-6);
  return static_cast<int>(std::min(samples, 1e9));
}

}  // namespace

void SampleGuardConfig::Visit(SettingsVisitor& visitor) {
  visitor.Flag({.key = "full_scale",
                .help = "do not trust values at 0 or at full scale (broken wire, short circuit)"},
               full_scale);
  visitor.Number({.key = "stuck_after_ms",
                  .help = "a value unchanged for so long counts as stuck; 0 is never",
                  .min = 0,
                  .max = 1e6},
                 stuck_after_ms);
  visitor.Number({.key = "jump_share",
                  .help = "a change between two samples by more than this share of full scale is a "
                          "jump; 0 is never",
                  .min = 0,
                  .max = 1},
                 jump_share);
  visitor.Number({.key = "jump_confirm_ms",
                  .help = "a jump is trusted after the value has stayed at its new place for so "
                          "long",
                  .min = 0,
                  .max = 1e6},
                 jump_confirm_ms);
}

SampleGuard::SampleGuard(const SampleGuardConfig& config, std::vector<double> start_counts,
                         double full_scale_counts, double rate_hz)
    : refuse_full_scale_(config.full_scale),
      stuck_samples_(SamplesOf(config.stuck_after_ms, rate_hz)),
      jump_counts_(config.jump_share > 0.0 ? config.jump_share * full_scale_counts
                                           : std::numeric_limits<double>::infinity()),
      confirm_samples_(SamplesOf(config.jump_confirm_ms, rate_hz)),
      full_scale_counts_(full_scale_counts),
      start_counts_(std::move(start_counts)),
      trusted_counts_(start_counts_),
      channels_(start_counts_.size()),
      untrusted_samples_(start_counts_.size(), 0) {
  for (auto& counts : untrusted_by_kind_) counts.assign(start_counts_.size(), 0);
}

bool SampleGuard::IsStale(const GloveSample& sample) noexcept {
  if (sample.number == 0) return false;
  if (sample.number <= last_number_) return true;
  last_number_ = sample.number;
  return false;
}

void SampleGuard::Refuse(std::size_t channel, Untrusted kind) noexcept {
  ++untrusted_samples_[channel];
  ++untrusted_by_kind_[static_cast<std::size_t>(kind)][channel];
}

bool SampleGuard::IsJump(Channel& channel, double counts, double trusted) noexcept {
  if (!channel.seen || !(std::abs(counts - trusted) > jump_counts_)) {
    channel.confirmed = 0;
    return false;
  }
  const bool stays = channel.confirmed > 0 && std::abs(counts - channel.candidate) <= jump_counts_;
  channel.candidate = counts;
  channel.confirmed = stays ? channel.confirmed + 1 : 1;
  return channel.confirmed <= confirm_samples_;
}

void SampleGuard::TakeChannel(std::size_t index, const GloveSample& sample, bool stale) noexcept {
  Channel& channel = channels_[index];
  const double counts = index < sample.counts.size() ? sample.counts[index]
                                                     : std::numeric_limits<double>::quiet_NaN();
  if (std::isnan(counts)) return Refuse(index, Untrusted::kMissing);
  if (stale) return Refuse(index, Untrusted::kStale);
  if (std::isinf(counts)) return Refuse(index, Untrusted::kInfinite);
  if (counts < 0.0 || counts > full_scale_counts_) return Refuse(index, Untrusted::kOutOfRange);
  if (refuse_full_scale_ && (counts == 0.0 || counts == full_scale_counts_)) {
    return Refuse(index, Untrusted::kFullScale);
  }
  if (IsJump(channel, counts, trusted_counts_[index])) return Refuse(index, Untrusted::kJumped);
  channel.same = counts == channel.raw && channel.seen ? channel.same + 1 : 0;
  channel.raw = counts;
  if (stuck_samples_ > 0 && channel.same >= stuck_samples_) {
    channel.same = stuck_samples_;  // so that it cannot overflow
    return Refuse(index, Untrusted::kStuck);
  }
  channel.seen = true;
  trusted_counts_[index] = counts;
}

void SampleGuard::Reset() noexcept {
  std::copy(start_counts_.begin(), start_counts_.end(), trusted_counts_.begin());
  std::fill(channels_.begin(), channels_.end(), Channel{});
  last_number_ = 0;
  std::fill(untrusted_samples_.begin(), untrusted_samples_.end(), 0);
  for (auto& counts : untrusted_by_kind_) std::fill(counts.begin(), counts.end(), 0);
}

void SampleGuard::CopyState(const SampleGuard& from) noexcept {
  trusted_counts_ = from.trusted_counts_;
  channels_ = from.channels_;
  last_number_ = from.last_number_;
  untrusted_samples_ = from.untrusted_samples_;
  untrusted_by_kind_ = from.untrusted_by_kind_;
}

}  // namespace gauntlet::controller
