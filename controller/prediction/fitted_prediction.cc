#include "controller/prediction/fitted_prediction.h"

#include <cmath>
#include <string>
#include <utility>

#include "controller/filters/channel_arrays.h"
#include "controller/filters/check_filter.h"
#include "controller/filters/state_filter.h"
#include "controller/filters/subnormal.h"
#include "controller/filters/vectorise.h"
#include "controller/prediction/history.h"

namespace gauntlet::controller {
namespace {

GAUNTLET_VECTORISED void AddTap(const double* weight, const double* then, const double* now,
                                double* sum, int channel_count) {
  GAUNTLET_CHANNEL_LOOP
  for (int i = 0; i < channel_count; ++i) sum[i] += weight[i] * (then[i] - now[i]);
}

class FittedPredictor final : public StateFilter<Filter> {
 public:
  FittedPredictor(const FittedPredictionConfig& config, int tap_steps, int channel_count)
      : StateFilter(Start::kFirst, channel_count),
        order_(config.order),
        tap_steps_(tap_steps),
        weights_(config.order + 1, channel_count),  // and one array for the sum
        history_(config.order * tap_steps + 1, channel_count) {
    const std::size_t order = config.order;
    const bool one_for_all = config.weights.size() == order;
    for (int i = 0; i < channel_count; ++i) {
      const std::size_t begin = one_for_all ? 0 : order * static_cast<std::size_t>(i);
      for (std::size_t tap = 0; tap < order; ++tap) weights_[tap][i] = config.weights[begin + tap];
    }
    Reset();
  }

 private:
  void StepAll(std::span<const double> input, std::span<double> output) noexcept override {
    const int n = channel_count();
    double* now = history_.Push();
    CopyWithoutSubnormals(input.data(), now, n);
    double* sum = weights_[order_];
    std::copy_n(now, n, sum);
    for (int tap = 0; tap < order_; ++tap) {
      AddTap(weights_[tap], history_.Row((tap + 1) * tap_steps_), now, sum, n);
    }
    std::copy_n(sum, n, output.begin());
  }
  void SetState(int channel, double position) noexcept override {
    history_.Fill(channel, WithoutSubnormal(position));
  }
  bool TakeChecked(Filter& from) noexcept override {
    auto* other = dynamic_cast<FittedPredictor*>(&from);
    if (other == nullptr || other->history_.length() != history_.length()) return false;
    std::swap(history_, other->history_);
    TakeFresh(*other);
    return true;
  }

  int order_;
  int tap_steps_;
  ChannelArrays weights_;
  History history_;
};

}  // namespace

void FittedPredictionConfig::Visit(SettingsVisitor& visitor) {
  visitor.Integer({.key = "order", .help = "how many samples of the past", .min = 1, .max = 1000},
                  order);
  visitor.Number({.key = "tap_ms", .help = "how far they lie apart", .min = 0.1, .max = 1000},
                 tap_ms);
  visitor.Numbers({.key = "weights",
                   .help = "of the differences to the newest sample, from new to old; `order` for "
                           "all channels, or so many for each, channel by channel",
                   .min = -1e6,
                   .max = 1e6,
                   .required = true},
                  weights);
}

std::unique_ptr<Filter> MakePredictor(const FittedPredictionConfig& config, int channel_count,
                                      double rate_hz) {
  CheckFilter(config, channel_count, rate_hz);
  const std::size_t order = config.order;
  const std::size_t each = order * static_cast<std::size_t>(channel_count);
  if (config.weights.size() != order && config.weights.size() != each) {
    throw SettingError("weights", "has " + std::to_string(config.weights.size()) +
                                      " values, must have " + std::to_string(order) +
                                      " for all channels or " + std::to_string(each) + ", " +
                                      std::to_string(order) + " for each");
  }
  const double steps = config.tap_ms * 1e-3 * rate_hz;
  if (std::abs(steps - std::round(steps)) > 1e-6 * steps || steps < 0.5) {
    throw SettingError("tap_ms", "is " + NumberText(config.tap_ms) +
                                     ", must be a multiple of the step of the filter, " +
                                     NumberText(1e3 / rate_hz) + " ms");
  }
  return std::make_unique<FittedPredictor>(config, static_cast<int>(std::lround(steps)),
                                           channel_count);
}

}  // namespace gauntlet::controller
