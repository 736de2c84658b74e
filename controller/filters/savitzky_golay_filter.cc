#include "controller/filters/savitzky_golay_filter.h"

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "controller/filters/check_filter.h"
#include "controller/filters/end_point_fit.h"
#include "controller/filters/filter_registry.h"
#include "controller/filters/sample_window.h"

namespace gauntlet::controller {
namespace {

class SavitzkyGolayFilter final : public Filter {
 public:
  SavitzkyGolayFilter(const SavitzkyGolayConfig& config, int channel_count)
      : Filter(channel_count),
        weights_(EndPointWeights(config.window, config.order)),
        window_(config.window, channel_count),
        sum_(channel_count) {}

  void Reset() noexcept override { window_.Reset(); }

 private:
  void StepChecked(std::span<const double> input, std::span<double> output) noexcept override {
    window_.Push(input);
    WeightedSum(window_, weights_, sum_.data());
    if (!window_.all_full()) PassUnfilledChannels();
    std::copy(sum_.begin(), sum_.end(), output.begin());
  }
  void ResetChecked(int channel) noexcept override { window_.ResetChannel(channel); }
  void StartChecked(std::span<const double> values) noexcept override { window_.StartAt(values); }
  bool SwapChecked(Filter& from) noexcept override {
    auto* other = dynamic_cast<SavitzkyGolayFilter*>(&from);
    if (other == nullptr || other->window_.length() != window_.length()) return false;
    std::swap(window_, other->window_);
    return true;
  }
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
  visitor.Integer({"window", "samples fitted", 1, 10000}, window);
  visitor.Integer({"order", "degree of the polynomial, below window", 0, 6}, order);
}

std::unique_ptr<Filter> MakeFilter(const SavitzkyGolayConfig& config, int channel_count,
                                   double rate_hz) {
  CheckFilter(config, channel_count, rate_hz);
  if (config.order >= config.window) {
    throw SettingError("order", "is " + std::to_string(config.order) +
                                    ", must be below window, which is " +
                                    std::to_string(config.window));
  }
  return std::make_unique<SavitzkyGolayFilter>(config, channel_count);
}

}  // namespace gauntlet::controller
