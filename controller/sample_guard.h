#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace gauntlet::controller {

/// Lets only values through that can be trusted; a channel without one holds its last good value.
///
/// Units: counts. Shapes: one value per channel; a sample that is too short lacks its last
/// channels.
class SampleGuard {
 public:
  /// `start_counts`: what a channel holds before its first good value.
  SampleGuard(std::vector<double> start_counts, double full_scale_counts);

  /// Takes a sample in; trusted_counts() is up to date afterwards.
  /// Calls first_good(channel) for a channel whose first good value this is.
  template <class FirstGood>
  void Take(std::span<const double> counts, FirstGood first_good) noexcept {
    for (std::size_t i = 0; i < trusted_counts_.size(); ++i) {
      if (i < counts.size() && IsTrusted(counts[i])) {
        trusted_counts_[i] = counts[i];
        if (seen_[i] == 0) {
          seen_[i] = 1;
          first_good(static_cast<int>(i));
        }
      } else {
        ++untrusted_samples_[i];
      }
    }
  }
  void Reset() noexcept;

  std::span<const double> trusted_counts() const noexcept { return trusted_counts_; }
  std::span<const std::int64_t> untrusted_samples() const noexcept { return untrusted_samples_; }

 private:
  /// False for NaN, too: no comparison with it is true.
  bool IsTrusted(double counts) const noexcept {
    return counts >= 0.0 && counts <= full_scale_counts_;
  }

  std::vector<double> start_counts_;
  std::vector<double> trusted_counts_;
  std::vector<std::int64_t> untrusted_samples_;
  std::vector<std::uint8_t> seen_;
  double full_scale_counts_;
};

}  // namespace gauntlet::controller
