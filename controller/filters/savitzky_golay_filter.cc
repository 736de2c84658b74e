#include "controller/filters/savitzky_golay_filter.h"

#include <algorithm>
#include <string>
#include <vector>

#include "controller/filters/end_point_fit.h"
#include "controller/filters/sample_window.h"

namespace gauntlet::controller {
namespace {

class SavitzkyGolayFilter final : public Filter {
 public:
  SavitzkyGolayFilter(const SavitzkyGolayConfig& config, int channel_count)
      : weights_(EndPointWeights(config.window, config.order)),
        window_(config.window, channel_count),
        sum_(channel_count) {}

  int channel_count() const noexcept override { return window_.channel_count(); }

  void Step(std::span<const double> input, std::span<double> output) noexcept override {
    window_.Push(input);
    WeightedSum(window_, weights_, sum_.data());
    if (!window_.all_full()) PassUnfilledChannels();
    std::copy(sum_.begin(), sum_.end(), output.begin());
  }

  void Reset() noexcept override { window_.Reset(); }
  void ResetChannel(int channel) noexcept override { window_.ResetChannel(channel); }
  bool CopyChannel(const Filter& from, int channel) noexcept override {
    const auto* other = dynamic_cast<const SavitzkyGolayFilter*>(&from);
    if (other == nullptr || other->window_.length() != window_.length()) return false;
    window_.CopyChannel(other->window_, channel);
    return true;
  }

 private:
  void PassUnfilledChannels() noexcept {
    const double* newest = window_.Row(0);
    for (int i = 0; i < channel_count(); ++i) {
      if (window_.count(i) < window_.length()) sum_[i] = newest[i];
    }
  }

  Eigen::ArrayXd weights_;
  SampleWindow window_;
  std::vector<double> sum_;
};

}  // namespace

void SavitzkyGolayConfig::Visit(SettingsVisitor& visitor) {
  visitor.Integer({.key = "window", .help = "samples fitted", .min = 1, .max = 10000}, window);
  visitor.Integer(
      {.key = "order", .help = "degree of the polynomial, below window", .min = 0, .max = 6},
      order);
}

std::unique_ptr<Filter> MakeFilter(const SavitzkyGolayConfig& config, int channel_count, double) {
  CheckSettings(config);
  if (config.order >= config.window) {
    throw SettingError("order", "is " + std::to_string(config.order) +
                                    ", must be below window, which is " +
                                    std::to_string(config.window));
  }
  return std::make_unique<SavitzkyGolayFilter>(config, channel_count);
}

}  // namespace gauntlet::controller
