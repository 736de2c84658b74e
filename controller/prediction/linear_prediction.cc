#include "controller/prediction/linear_prediction.h"

#include <cmath>
#include <utility>
#include <vector>

#include "controller/filters/check_filter.h"
#include "controller/filters/end_point_fit.h"
#include "controller/filters/sample_window.h"
#include "controller/prediction/horizon.h"
#include "controller/prediction/predictor.h"

namespace gauntlet::controller {
namespace {

/// z(k) + steps slope: zero steps, or a window that is not full yet, pass samples through.
class LinearPredictor final : public Filter {
 public:
  LinearPredictor(int window, const Eigen::ArrayXd& horizon_steps)
      : Filter(horizon_steps.size()),
        horizon_steps_(horizon_steps),
        weights_(EndPointWeights(window, 1, 1)),
        window_(window, channel_count()),
        slope_(static_cast<std::size_t>(channel_count())) {}

  void Reset() noexcept override { window_.Reset(); }

 private:
  void StepChecked(std::span<const double> input, std::span<double> output) noexcept override {
    window_.Push(input);
    WeightedSum(window_, weights_, slope_.data());
    const double* newest = window_.Row(0);
    for (int i = 0; i < channel_count(); ++i) {
      const bool full = window_.count(i) == window_.length();
      output[i] = newest[i] + (full ? horizon_steps_[i] * slope_[i] : 0.0);
    }
  }
  void ResetChecked(int channel) noexcept override { window_.ResetChannel(channel); }
  void StartChecked(std::span<const double> values) noexcept override { window_.StartAt(values); }
  bool SwapChecked(Filter& from) noexcept override {
    auto* other = dynamic_cast<LinearPredictor*>(&from);
    if (other == nullptr || other->window_.length() != window_.length()) return false;
    std::swap(window_, other->window_);
    return true;
  }

  Eigen::ArrayXd horizon_steps_;
  Eigen::ArrayXd weights_;
  SampleWindow window_;
  std::vector<double> slope_;
};

}  // namespace

void LinearPredictionConfig::Visit(SettingsVisitor& visitor) {
  VisitHorizon(visitor, horizon_ms);
  visitor.Number({"window_ms", "samples from which the slope is taken", 1, 1e4}, window_ms);
}

std::unique_ptr<Filter> MakePredictor(const LinearPredictionConfig& config, int channel_count,
                                      double rate_hz) {
  CheckFilter(config, channel_count, rate_hz);
  const int window = static_cast<int>(std::lround(config.window_ms * 1e-3 * rate_hz));
  if (window < 2) {
    throw SettingError("window_ms", "must hold at least two steps of the filter, " +
                                        NumberText(2e3 / rate_hz) + " ms");
  }
  return std::make_unique<LinearPredictor>(window,
                                           HorizonSteps(config.horizon_ms, channel_count, rate_hz));
}

}  // namespace gauntlet::controller
