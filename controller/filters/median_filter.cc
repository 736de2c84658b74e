#include "controller/filters/median_filter.h"

#include <cmath>
#include <utility>
#include <vector>

#include "controller/filters/check_filter.h"
#include "controller/filters/filter_registry.h"
#include "controller/filters/sorted_window.h"
#include "controller/filters/vectorise.h"

namespace gauntlet::controller {
namespace {

/// Window that both filters share.
class SortedWindowFilter : public Filter {
 public:
  void Reset() noexcept final { window_.Reset(); }

 protected:
  SortedWindowFilter(int length, int channel_count)
      : Filter(channel_count), window_(length, channel_count) {}
  SortedWindow window_;

 private:
  void ResetChecked(int channel) noexcept final { window_.ResetChannel(channel); }
  void StartChecked(std::span<const double> values) noexcept final { window_.StartAt(values); }
  bool SwapChecked(Filter& from) noexcept final {
    // A median and an outlier filter remember the same, so either may follow the other.
    auto* other = dynamic_cast<SortedWindowFilter*>(&from);
    if (other == nullptr || other->window_.length() != window_.length()) return false;
    std::swap(window_, other->window_);
    return true;
  }
};

class MedianFilter final : public SortedWindowFilter {
 public:
  MedianFilter(const MedianConfig& config, int channel_count)
      : SortedWindowFilter(config.window, channel_count) {}

 private:
  void StepChecked(std::span<const double> input, std::span<double> output) noexcept override {
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

 private:
  void StepChecked(std::span<const double> input, std::span<double> output) noexcept override {
    window_.Push(input);
    Medians(window_, median_.data());
    MedianDeviations(window_, median_.data(), deviation_.data());
    ReplaceOutliers(window_.newest(), median_.data(), deviation_.data(), threshold_, output.data(),
                    channel_count());
  }

  static constexpr double kSigmaPerDeviation = 1.4826;  // 1 / (normal quantile at 3/4)

  double threshold_;
  std::vector<double> median_;
  std::vector<double> deviation_;
};

}  // namespace

std::unique_ptr<Filter> MakeFilter(const MedianConfig& config, int channel_count, double rate_hz) {
  CheckFilter(config, channel_count, rate_hz);
  return std::make_unique<MedianFilter>(config, channel_count);
}

std::unique_ptr<Filter> MakeFilter(const HampelConfig& config, int channel_count, double rate_hz) {
  CheckFilter(config, channel_count, rate_hz);
  return std::make_unique<HampelFilter>(config, channel_count);
}

}  // namespace gauntlet::controller
