#include "controller/prediction/fitted_prediction.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <string_view>
#include <utility>

#include "controller/filters/channel_arrays.h"
#include "controller/filters/check_filter.h"
#include "controller/filters/fresh_channels.h"
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

/// sum += weights * differences: one array of weights for each difference.
GAUNTLET_VECTORISED void AddShared(const ChannelArrays& weights, const double* differences,
                                   double* sum) {
  for (int j = 0; j < weights.array_count(); ++j) {
    const double* weight = weights[j];
    const double difference = differences[j];
    GAUNTLET_CHANNEL_LOOP
    for (int i = 0; i < weights.channel_count(); ++i) sum[i] += weight[i] * difference;
  }
}

/// `each` values for all channels, or for one channel after the other, as arrays of channels.
ChannelArrays OfChannels(const std::vector<double>& values, int each, int channel_count) {
  ChannelArrays arrays(each, channel_count);
  const std::size_t stride = values.size() == static_cast<std::size_t>(each) ? 0 : each;
  for (int j = 0; j < each; ++j) {
    for (int i = 0; i < channel_count; ++i) {
      arrays[j][i] = values[stride * static_cast<std::size_t>(i) + static_cast<std::size_t>(j)];
    }
  }
  return arrays;
}

class FittedPredictor final : public Filter {
 public:
  FittedPredictor(const FittedPredictionConfig& config, int tap_steps, int channel_count)
      : Filter(channel_count),
        order_(config.order),
        tap_steps_(tap_steps),
        components_(config.components),
        weights_(OfChannels(config.weights, order_, channel_count)),
        component_weights_(
            OfChannels(config.component_weights, components_ * order_, channel_count)),
        loadings_(config.loadings),
        differences_(static_cast<std::size_t>(component_weights_.array_count())),
        sum_(1, channel_count),
        history_(order_ * tap_steps + 1, channel_count),
        component_history_(history_.length(), components_),
        fresh_(channel_count) {
    FittedPredictor::Reset();
  }

  void Reset() noexcept override {
    for (int channel = 0; channel < channel_count(); ++channel) ResetChecked(channel);
  }

 private:
  /// A new channel has always been where its first sample is, so the others feel nothing of it.
  void StepChecked(std::span<const double> input, std::span<double> output) noexcept override {
    if (fresh_.any()) StartFresh(input);
    double* now = history_.Push();
    CopyWithoutSubnormals(input.data(), now, channel_count());
    double* sum = sum_[0];
    std::copy_n(now, channel_count(), sum);
    for (int tap = 0; tap < order_; ++tap) {
      AddTap(weights_[tap], history_.Row((tap + 1) * tap_steps_), now, sum, channel_count());
    }
    if (components_ > 0) AddComponents(sum);
    std::copy_n(sum, channel_count(), output.begin());
  }
  void AddComponents(double* sum) noexcept {
    for (int age = components_are_known_ ? 0 : history_.length() - 1; age >= 0; --age) {
      Project(history_.Row(age), component_history_.Push());
    }
    components_are_known_ = true;
    const double* now = component_history_.Row(0);
    for (int tap = 0; tap < order_; ++tap) {
      const double* then = component_history_.Row((tap + 1) * tap_steps_);
      for (int m = 0; m < components_; ++m) {
        differences_.data()[std::ptrdiff_t{m} * order_ + tap] = then[m] - now[m];
      }
    }
    AddShared(component_weights_, differences_.data(), sum);
  }
  void Project(const double* channels, double* components) const noexcept {
    const double* loading = loadings_.data();
    for (int m = 0; m < components_; ++m) {
      components[m] = 0.0;
      for (int i = 0; i < channel_count(); ++i) components[m] += *loading++ * channels[i];
    }
  }
  void StartFresh(std::span<const double> values) noexcept {
    fresh_.StartAll(values, [this](int channel, double value) { Settle(channel, value); });
  }
  void Settle(int channel, double position) noexcept {
    history_.Fill(channel, WithoutSubnormal(position));
    components_are_known_ = false;
  }
  void ResetChecked(int channel) noexcept override {
    Settle(channel, 0.0);
    fresh_.Add(channel);
  }
  void StartChecked(std::span<const double> values) noexcept override {
    fresh_.AddAll();
    StartFresh(values);
  }
  bool TakeChecked(Filter& from) noexcept override {
    auto* other = dynamic_cast<FittedPredictor*>(&from);
    if (other == nullptr || other->history_.length() != history_.length()) return false;
    std::swap(history_, other->history_);
    std::swap(fresh_, other->fresh_);
    components_are_known_ = other->components_are_known_ = false;
    return true;
  }

  int order_;
  int tap_steps_;
  int components_;
  ChannelArrays weights_;
  ChannelArrays component_weights_;
  std::vector<double> loadings_;  // component by component
  std::vector<double> differences_;
  ChannelArrays sum_;
  History history_;
  History component_history_;          // of as many samples
  bool components_are_known_ = false;  // whether it holds the components of `history_`
  FreshChannels fresh_;
};

/// Errors: SettingError.
void CheckCount(std::string_view key, const std::vector<double>& values, std::size_t each,
                std::size_t channels) {
  const std::size_t all = each * channels;
  if (values.size() == each || values.size() == all) return;
  throw SettingError(std::string(key), "has " + std::to_string(values.size()) +
                                           " values, must have " + std::to_string(each) +
                                           " for all channels or " + std::to_string(all) + ", " +
                                           std::to_string(each) + " for each");
}

}  // namespace

void FittedPredictionConfig::Visit(SettingsVisitor& visitor) {
  visitor.Integer({"order", "how many samples of the past", 1, 1000}, order);
  visitor.Number({"tap_ms", "how far they lie apart", 0.1, 1000}, tap_ms);
  visitor.Numbers({.key = "weights",
                   .help = "of the differences to the newest sample, from new to old; `order` for "
                           "all channels, or so many for each, channel by channel",
                   .min = -1e6,
                   .max = 1e6,
                   .required = true},
                  weights);
  visitor.Integer({"components", "how many sums over all channels it looks at besides", 0, 100},
                  components);
  visitor.Numbers(
      {"loadings",
       "of each component on each channel, component by component; none without components", -1e6,
       1e6},
      loadings);
  visitor.Numbers({"component_weights",
                   "as `weights`, of the samples of the components, component by component; none "
                   "without components",
                   -1e6, 1e6},
                  component_weights);
}

std::unique_ptr<Filter> MakePredictor(const FittedPredictionConfig& config, int channel_count,
                                      double rate_hz) {
  CheckFilter(config, channel_count, rate_hz);
  const std::size_t order = config.order;
  const std::size_t channels = channel_count;
  const std::size_t components = config.components;
  CheckCount("weights", config.weights, order, channels);
  if (components == 0 && !(config.loadings.empty() && config.component_weights.empty())) {
    throw SettingError("components",
                       "is 0, must be as many as loadings and component_weights are "
                       "for");
  }
  CheckCount("component_weights", config.component_weights, components * order, channels);
  if (config.loadings.size() != components * channels) {
    throw SettingError("loadings", "has " + std::to_string(config.loadings.size()) +
                                       " values, must have " +
                                       std::to_string(components * channels) +
                                       ", one per channel for each of the components");
  }
  const double steps = config.tap_ms * 1e-3 * rate_hz;
  // Clocks are that far off, and rates are written with so few digits.
  constexpr double kTolerance = 1e-3;
  if (std::abs(steps - std::round(steps)) > kTolerance * steps || steps < 0.5) {
    throw SettingError("tap_ms", "is " + NumberText(config.tap_ms) +
                                     ", must be a multiple of the step of the filter, " +
                                     NumberText(1e3 / rate_hz) + " ms");
  }
  return std::make_unique<FittedPredictor>(config, static_cast<int>(std::lround(steps)),
                                           channel_count);
}

}  // namespace gauntlet::controller
