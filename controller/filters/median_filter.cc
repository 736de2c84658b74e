#include "controller/filters/median_filter.h"

#include <cmath>
#include <vector>

#include "controller/filters/sorted_window.h"
#include "controller/filters/vectorise.h"

namespace gauntlet::controller {
namespace {

/// What both filters share: the window.
class SortedWindowFilter : public Filter {
 public:
  int channel_count() const noexcept final { return window_.channel_count(); }
  void Reset() noexcept final { window_.Reset(); }
  void ResetChannel(int channel) noexcept final { window_.ResetChannel(channel); }
  bool CopyChannel(const Filter& from, int channel) noexcept final {
    // A median and an outlier filter remember the same, so either may follow the other.
    const auto* other = dynamic_cast<const SortedWindowFilter*>(&from);
    if (other == nullptr || other->window_.length() != window_.length()) return false;
    window_.CopyChannel(other->window_, channel);
    return true;
  }

 protected:
  SortedWindowFilter(int length, int channel_count) : window_(length, channel_count) {}
  SortedWindow window_;
};

class MedianFilter final : public SortedWindowFilter {
 public:
  MedianFilter(const MedianConfig& config, int channel_count)
      : SortedWindowFilter(config.window, channel_count) {}

  void Step(std::span<const double> input, std::span<double> output) noexcept override {
    window_.Push(input);
    Medians(window_, output.data());
  }
};

GAUNTLET_VECTORISED void ReplaceOutliers(const double* sample, const double* median,
                                         const double* deviation, double threshold, double* output,
                                         int channel_count) {
  GAUNTLET_CHANNEL_LOOP
  for (int i = 0; i < channel_count; ++i) {
    const double distance = std::abs(sample[i] - median[i]);
    output[i] = distance > threshold * deviation[i] ? median[i] : sample[i];
  }
}

class HampelFilter final : public SortedWindowFilter {
 public:
  HampelFilter(const HampelConfig& config, int channel_count)
      : SortedWindowFilter(config.window, channel_count),
        threshold_(config.threshold_sigma * kSigmaPerDeviation),
        median_(channel_count),
        deviation_(channel_count) {}

  void Step(std::span<const double> input, std::span<double> output) noexcept override {
    window_.Push(input);
    Medians(window_, median_.data());
    MedianDeviations(window_, median_.data(), deviation_.data());
    ReplaceOutliers(window_.newest(), median_.data(), deviation_.data(), threshold_, output.data(),
                    channel_count());
  }

 private:
  static constexpr double kSigmaPerDeviation = 1.4826;  // 1 / (normal quantile at 3/4)

  double threshold_;
  std::vector<double> median_;
  std::vector<double> deviation_;
};

}  // namespace

std::unique_ptr<Filter> MakeFilter(const MedianConfig& config, int channel_count, double) {
  CheckSettings(config);
  return std::make_unique<MedianFilter>(config, channel_count);
}

std::unique_ptr<Filter> MakeFilter(const HampelConfig& config, int channel_count, double) {
  CheckSettings(config);
  return std::make_unique<HampelFilter>(config, channel_count);
}

}  // namespace gauntlet::controller
