#include "controller/filters/median_filter.h"

#include <cmath>
#include <limits>
#include <memory>
#include <utility>
#include <vector>

#include "controller/filters/channel_arrays.h"
#include "controller/filters/check_filter.h"
#include "controller/filters/filter_registry.h"
#include "controller/filters/sorted_window.h"
#include "controller/filters/vectorise.h"

namespace gauntlet::controller {
namespace {

/// Window that both filters share.
class SortedWindowFilter : public Filter {
 public:
  void Reset() noexcept override { window_->Reset(); }

 protected:
  SortedWindowFilter(int length, int channel_count)
      : Filter(channel_count), window_(SortedWindow::Make(length, channel_count)) {}

  void ResetChecked(int channel) noexcept override { window_->ResetChannel(channel); }
  void StartChecked(std::span<const double> values) noexcept override { window_->StartAt(values); }
  bool SwapChecked(Filter& from) noexcept override {
    // A median and an outlier filter remember the same, so either may follow the other.
    auto* other = dynamic_cast<SortedWindowFilter*>(&from);
    if (other == nullptr || other->window_->length() != window_->length()) return false;
    std::swap(window_, other->window_);
    return true;
  }

  std::unique_ptr<SortedWindow> window_;
};

class MedianFilter final : public SortedWindowFilter {
 public:
  MedianFilter(const MedianConfig& config, int channel_count)
      : SortedWindowFilter(config.window, channel_count) {}

 private:
  void StepChecked(std::span<const double> input, std::span<double> output) noexcept override {
    window_->Push(input);
    window_->Medians(output.data());
  }
};

/// The sensor's resolution of each channel, as far as its samples have shown it.
class Resolution {
 public:
  explicit Resolution(int channel_count) : arrays_(kCount, channel_count) { Reset(); }

  void Reset() noexcept {
    for (int channel = 0; channel < arrays_.channel_count(); ++channel) ResetChannel(channel);
  }
  void ResetChannel(int channel) noexcept {
    arrays_[kWhole][channel] = 1.0;
    arrays_[kLeastStep][channel] = kUnknown;
    arrays_[kMiddle][channel] = kUnknown;
  }
  /// Learns from a sample of all channels and from the sample in the middle of their windows.
  void Add(const double* sample, const double* middle) noexcept {
    Learn(sample, middle, arrays_[kWhole], arrays_[kLeastStep], arrays_[kMiddle], arrays_[kStep],
          arrays_.channel_count());
  }
  /// 0 where nothing is known.
  const double* steps() const noexcept { return arrays_[kStep]; }

 private:
  enum Array { kWhole, kLeastStep, kMiddle, kStep, kCount };
  static constexpr double kUnknown = std::numeric_limits<double>::infinity();

  GAUNTLET_VECTORISED static void Learn(const double* sample, const double* middle, double* whole,
                                        double* least_step, double* last_middle, double* step,
                                        int channel_count) {
    constexpr double kRound = 6755399441055744.0;  // 1.5 2^52: adding it leaves no fraction
    GAUNTLET_CHANNEL_LOOP
    for (int i = 0; i < channel_count; ++i) {
      const double change = std::abs(middle[i] - last_middle[i]);
      const double least = change > 0.0 && change < least_step[i] ? change : least_step[i];
      const double is_whole = (sample[i] + kRound) - kRound == sample[i] ? whole[i] : 0.0;
      const double known = least == kUnknown ? 0.0 : least;
      whole[i] = is_whole;
      least_step[i] = least;
      last_middle[i] = middle[i];
      step[i] = is_whole == 1.0 ? 1.0 : known;
    }
  }

  ChannelArrays arrays_;
};

GAUNTLET_VECTORISED void ReplaceOutliers(const double* sample, const double* median,
                                         const double* deviation, double threshold,
                                         const double* least, double* output, int channel_count) {
  GAUNTLET_CHANNEL_LOOP
  for (int i = 0; i < channel_count; ++i) {
    const double distance = std::abs(sample[i] - median[i]);
    const double limit = deviation[i] > 0.0 ? threshold * deviation[i] : least[i];
    output[i] = distance > limit ? median[i] : sample[i];
  }
}

class HampelFilter final : public SortedWindowFilter {
 public:
  HampelFilter(const HampelConfig& config, int channel_count)
      : SortedWindowFilter(config.window, channel_count),
        threshold_(config.threshold_sigma * kSigmaPerDeviation),
        resolution_(channel_count),
        middle_(channel_count),
        median_(channel_count),
        deviation_(channel_count) {}

  void Reset() noexcept override {
    SortedWindowFilter::Reset();
    resolution_.Reset();
  }

 private:
  void StepChecked(std::span<const double> input, std::span<double> output) noexcept override {
    window_->Push(input);
    Learn();
    window_->Medians(median_.data());
    window_->MedianDeviations(median_.data(), deviation_.data());
    ReplaceOutliers(window_->newest(), median_.data(), deviation_.data(), threshold_,
                    resolution_.steps(), output.data(), channel_count());
  }
  void ResetChecked(int channel) noexcept override {
    SortedWindowFilter::ResetChecked(channel);
    resolution_.ResetChannel(channel);
  }
  void StartChecked(std::span<const double> values) noexcept override {
    SortedWindowFilter::StartChecked(values);
    resolution_.Reset();
    Learn();
  }
  bool SwapChecked(Filter& from) noexcept override {
    if (!SortedWindowFilter::SwapChecked(from)) return false;
    if (auto* other = dynamic_cast<HampelFilter*>(&from)) {
      std::swap(resolution_, other->resolution_);
    }
    return true;
  }
  void Learn() noexcept {
    for (int i = 0; i < channel_count(); ++i) {
      middle_[i] = window_->Value((window_->count(i) - 1) / 2, i);
    }
    resolution_.Add(window_->newest(), middle_.data());
  }

  static constexpr double kSigmaPerDeviation = 1.4826;  // 1 / (normal quantile at 3/4)

  double threshold_;
  Resolution resolution_;
  std::vector<double> middle_;
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
