#include "controller/prediction/fitted_prediction.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <string_view>
#include <utility>

#include "controller/angle.h"
#include "controller/filters/channel_arrays.h"
#include "controller/filters/check_filter.h"
#include "controller/filters/fresh_channels.h"
#include "controller/filters/subnormal.h"
#include "controller/filters/vectorise.h"
#include "controller/prediction/fallback.h"
#include "controller/prediction/history.h"
#include "controller/prediction/horizon.h"
#include "controller/prediction/predictor.h"

namespace gauntlet::controller {
namespace {

GAUNTLET_VECTORISED void AddTap(const double* weight, const double* then, const double* now,
                                double* sum, int channel_count) {
  GAUNTLET_CHANNEL_LOOP
  for (int i = 0; i < channel_count; ++i) sum[i] += weight[i] * (then[i] - now[i]);
}

/// sum += weights * values: one array of weights for each value.
GAUNTLET_VECTORISED void AddShared(const ChannelArrays& weights, const double* values,
                                   double* sum) {
  for (int j = 0; j < weights.array_count(); ++j) {
    const double* weight = weights[j];
    const double value = values[j];
    GAUNTLET_CHANNEL_LOOP
    for (int i = 0; i < weights.channel_count(); ++i) sum[i] += weight[i] * value;
  }
}

GAUNTLET_VECTORISED void AddMean(const double* sample, double share, double* mean,
                                 int channel_count) {
  GAUNTLET_CHANNEL_LOOP
  for (int i = 0; i < channel_count; ++i) mean[i] += share * sample[i];
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

/// Weights of every channel for each, as arrays of channels: none, or one of every channel for
/// each. If there is one per channel, it is of the channel itself.
ChannelArrays OfEveryChannel(const std::vector<double>& values, int channel_count) {
  const auto channels = static_cast<std::size_t>(channel_count);
  if (values.empty()) return {0, channel_count};
  if (values.size() == channels * channels) {
    return OfChannels(values, channel_count, channel_count);
  }
  ChannelArrays arrays(channel_count, channel_count);
  for (int i = 0; i < channel_count; ++i) arrays[i][i] = values[static_cast<std::size_t>(i)];
  return arrays;
}

class FittedPredictor final : public Filter {
 public:
  FittedPredictor(const FittedPredictionConfig& config, int tap_steps, int channel_count)
      : Filter(channel_count),
        order_(config.order),
        tap_steps_(tap_steps),
        mean_steps_(config.tap_means ? tap_steps : 1),
        slope_tap_(std::min(config.order, FittedPredictionConfig::kSlopeTaps)),
        weights_(OfChannels(config.weights, order_, channel_count)),
        position_weights_(OfEveryChannel(config.position_weights, channel_count)),
        slope_weights_(OfEveryChannel(config.slope_weights, channel_count)),
        offset_rad_(static_cast<std::size_t>(channel_count)),
        slope_(static_cast<std::size_t>(channel_count)),
        sum_(1, channel_count),
        samples_(mean_steps_, channel_count),
        means_(order_ * tap_steps + 2 - mean_steps_, channel_count),
        fresh_(channel_count) {
    for (std::size_t i = 0; i < config.offset_deg.size(); ++i) {
      offset_rad_[i] = kRadPerDeg * config.offset_deg[i];
    }
    FittedPredictor::Reset();
  }

  void Reset() noexcept override {
    for (int channel = 0; channel < channel_count(); ++channel) ResetChecked(channel);
  }

 private:
  /// A new channel has always been where its first sample is, so the others feel nothing of it.
  void StepChecked(std::span<const double> input, std::span<double> output) noexcept override {
    if (fresh_.any()) StartFresh(input);
    CopyWithoutSubnormals(input.data(), samples_.Push(), channel_count());
    const double* now = samples_.Row(0);
    PushMean();
    double* sum = sum_[0];
    for (int i = 0; i < channel_count(); ++i) sum[i] = now[i] + offset_rad_[i];
    for (int tap = 1; tap <= order_; ++tap) {
      AddTap(weights_[tap - 1], Tap(tap), now, sum, channel_count());
    }
    AddShared(position_weights_, Tap(1), sum);
    if (slope_weights_.array_count() > 0) AddSlopes(sum);
    std::copy_n(sum, channel_count(), output.begin());
  }
  void PushMean() noexcept {
    double* mean = means_.Push();
    std::fill_n(mean, channel_count(), 0.0);
    const double share = 1.0 / mean_steps_;
    for (int age = 0; age < mean_steps_; ++age) {
      AddMean(samples_.Row(age), share, mean, channel_count());
    }
  }
  /// The mean of the samples from `tap` taps ago on.
  const double* Tap(int tap) const noexcept {
    return means_.Row(tap * tap_steps_ + 1 - mean_steps_);
  }
  void AddSlopes(double* sum) noexcept {
    const double* new_mean = Tap(1);
    const double* old_mean = Tap(slope_tap_);
    for (std::size_t i = 0; i < slope_.size(); ++i) slope_[i] = new_mean[i] - old_mean[i];
    AddShared(slope_weights_, slope_.data(), sum);
  }
  void StartFresh(std::span<const double> values) noexcept {
    fresh_.StartAll(values, [this](int channel, double value) { Settle(channel, value); });
  }
  void Settle(int channel, double position) noexcept {
    samples_.Fill(channel, WithoutSubnormal(position));
    double mean = 0.0;  // as PushMean() rounds it
    for (int age = 0; age < mean_steps_; ++age) {
      mean += 1.0 / mean_steps_ * WithoutSubnormal(position);
    }
    means_.Fill(channel, mean);
  }
  void ResetChecked(int channel) noexcept override {
    Settle(channel, 0.0);
    fresh_.Add(channel);
  }
  void StartChecked(std::span<const double> values) noexcept override {
    fresh_.AddAll();
    StartFresh(values);
  }
  bool SwapChecked(Filter& from) noexcept override {
    auto* other = dynamic_cast<FittedPredictor*>(&from);
    if (other == nullptr || other->means_.length() != means_.length() ||
        other->mean_steps_ != mean_steps_) {
      return false;
    }
    std::swap(samples_, other->samples_);
    std::swap(means_, other->means_);
    std::swap(fresh_, other->fresh_);
    return true;
  }

  int order_;
  int tap_steps_;
  int mean_steps_;
  int slope_tap_;
  ChannelArrays weights_;
  ChannelArrays position_weights_;
  ChannelArrays slope_weights_;
  std::vector<double> offset_rad_;
  std::vector<double> slope_;
  ChannelArrays sum_;
  History samples_;
  History means_;  // of the samples that had come by then
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

/// Check of the number of weights of every channel for each. Errors: SettingError.
void CheckShared(std::string_view key, const std::vector<double>& values, std::size_t channels,
                 bool may_be_own) {
  if (values.empty() || values.size() == channels * channels) return;
  if (may_be_own && values.size() == channels) return;
  throw SettingError(
      std::string(key),
      "has " + std::to_string(values.size()) + " values, must have none" +
          (may_be_own ? ", " + std::to_string(channels) + ", one for each channel," : "") + " or " +
          std::to_string(channels * channels) + ", one of every channel for each");
}

}  // namespace

void FittedPredictionConfig::Visit(SettingsVisitor& visitor) {
  visitor.Numbers(
      {"horizon_ms",
       "how far ahead the weights were fitted for, one for all channels or one for each", 0,
       kMostHorizon_ms},
      horizon_ms);
  visitor.Integer({"order", "how many taps into the past", 1, 1000}, order);
  visitor.Number({"tap_ms", "how far they lie apart", 0.1, 1000}, tap_ms);
  visitor.Flag(
      {"tap_means", "a tap is the mean of the samples from it to the next, not one sample"},
      tap_means);
  visitor.Numbers({.key = "weights",
                   .help = "of the differences to the newest sample, from new to old; `order` for "
                           "all channels, or so many for each, channel by channel",
                   .min = -1e6,
                   .max = 1e6,
                   .required = true},
                  weights);
  visitor.Numbers({"position_weights",
                   "of where channels are: none, one for each channel of its own, or for each "
                   "channel one of every channel",
                   -1e6, 1e6},
                  position_weights);
  visitor.Numbers({"slope_weights",
                   "of how channels move, from the tap before the newest sample less the sixth: "
                   "none, or for each channel one of every channel",
                   -1e6, 1e6},
                  slope_weights);
  visitor.Numbers({"offset_deg", "what is added to each channel: none or one for each", -1e6, 1e6},
                  offset_deg);
  VisitFallback(visitor, fallback, r_deg2);
}

std::unique_ptr<Filter> MakePredictor(const FittedPredictionConfig& config, int channel_count,
                                      double rate_hz) {
  CheckFilter(config, channel_count, rate_hz);
  const std::size_t order = config.order;
  const std::size_t channels = channel_count;
  CheckCount("weights", config.weights, order, channels);
  CheckShared("position_weights", config.position_weights, channels, true);
  CheckShared("slope_weights", config.slope_weights, channels, false);
  if (!config.offset_deg.empty() && config.offset_deg.size() != channels) {
    throw SettingError("offset_deg", "has " + std::to_string(config.offset_deg.size()) +
                                         " values, must have none or " + std::to_string(channels));
  }
  HorizonSteps(config.horizon_ms, channel_count, rate_hz);  // as many as channels
  const double steps = config.tap_ms * 1e-3 * rate_hz;
  // Clocks are that far off, and rates are written with so few digits.
  constexpr double kTolerance = 1e-3;
  if (std::abs(steps - std::round(steps)) > kTolerance * steps || steps < 0.5) {
    throw SettingError("tap_ms", "is " + NumberText(config.tap_ms) +
                                     ", must be a multiple of the step of the filter, " +
                                     NumberText(1e3 / rate_hz) + " ms");
  }
  auto fitted = std::make_unique<FittedPredictor>(config, static_cast<int>(std::lround(steps)),
                                                  channel_count);
  if (!config.fallback || std::ranges::max(config.horizon_ms) == 0.0) return fitted;
  return WithFallback(std::move(fitted), {.horizon_ms = config.horizon_ms, .r_deg2 = config.r_deg2},
                      rate_hz);
}

}  // namespace gauntlet::controller
