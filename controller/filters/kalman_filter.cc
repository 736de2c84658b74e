#include "controller/filters/kalman_filter.h"

#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include "controller/filters/channel_arrays.h"
#include "controller/filters/end_point_fit.h"
#include "controller/filters/kalman_kernels.h"
#include "controller/filters/sample_window.h"
#include "controller/filters/state_filter.h"

namespace gauntlet::controller {
namespace {

/// Which arrays hold what, for two and for three states.
struct Layout {
  int states;
  int array_count;
  int r, q;
  int variances[3];  // the diagonal of P
  void (*step)(ChannelArrays&, const ProcessNoiseFactors&, const double*, double*);
};
constexpr Layout kLayout2 = {2, kKalmanArrays2, kR, kQ, {kP11, kP22, kP22}, StepKalman2};
constexpr Layout kLayout3 = {3,          kKalmanArrays3, kROf3, kQOf3, {kP11Of3, kP22Of3, kP33Of3},
                             StepKalman3};

/// The acceleration of every channel, from the parabola through its last samples.
class AccelerationEstimate {
 public:
  AccelerationEstimate(int window, int channel_count)
      : weights_(EndPointWeights(window, 2, 2)),
        window_(window, channel_count),
        acceleration_(channel_count, 0.0) {}

  std::span<const double> Step(std::span<const double> input) noexcept {
    window_.Push(input);
    WeightedSum(window_, weights_, acceleration_.data());
    if (!window_.all_full()) {
      for (int i = 0; i < window_.channel_count(); ++i) {
        if (window_.count(i) < window_.length()) acceleration_[i] = 0.0;
      }
    }
    return acceleration_;
  }
  SampleWindow& window() noexcept { return window_; }
  const SampleWindow& window() const noexcept { return window_; }

 private:
  Eigen::ArrayXd weights_;
  SampleWindow window_;
  std::vector<double> acceleration_;
};

class ChannelKalmanFilter final : public StateFilter<KalmanFilter> {
 public:
  ChannelKalmanFilter(const KalmanConfig& config, int channel_count, double rate_hz)
      : StateFilter(config.start, channel_count),
        layout_(config.states == 2 ? kLayout2 : kLayout3),
        factors_(FactorsOf(config.noise.process_noise, config.states, 1.0 / rate_hz)),
        arrays_(layout_.array_count, channel_count) {
    const Eigen::ArrayXd r = MeasurementVariance(config.noise, channel_count);
    const Eigen::ArrayXd q = ProcessVariance(config.noise, channel_count);
    std::copy(r.begin(), r.end(), arrays_[layout_.r]);
    std::copy(q.begin(), q.end(), arrays_[layout_.q]);
    if (config.acceleration_window > 0) {
      acceleration_.emplace(config.acceleration_window, channel_count);
    }
    Reset();
  }

  void Step(std::span<const double> input, std::span<double> output) noexcept override {
    if (acceleration_) {
      StepWithAcceleration(input, acceleration_->Step(input), output);
    } else {
      StateFilter::Step(input, output);
    }
  }
  void StepWithAcceleration(std::span<const double> input, std::span<const double> acceleration,
                            std::span<double> output) noexcept override {
    // The kernel adds x + w; with w + u and x - u/2 that is A x + B u.
    double* x = arrays_[kX];
    double* w = arrays_[kW];
    for (int i = 0; i < channel_count(); ++i) {
      const double u = acceleration[i];
      x[i] -= 0.5 * u;
      w[i] += u;
    }
    StateFilter::Step(input, output);
  }

  double velocity(int channel) const noexcept override { return arrays_[kW][channel]; }

  void ResetChannel(int channel) noexcept override {
    StateFilter::ResetChannel(channel);
    if (acceleration_) acceleration_->window().ResetChannel(channel);
  }
  bool CopyChannel(const Filter& from, int channel) noexcept override {
    const auto* other = dynamic_cast<const ChannelKalmanFilter*>(&from);
    if (other == nullptr || other->layout_.states != layout_.states) return false;
    if (other->acceleration_.has_value() != acceleration_.has_value()) return false;
    if (acceleration_) {
      if (other->acceleration_->window().length() != acceleration_->window().length()) return false;
      acceleration_->window().CopyChannel(other->acceleration_->window(), channel);
    }
    for (int array = 0; array < layout_.r; ++array) {  // the state; R and Q stay
      arrays_[array][channel] = other->arrays_[array][channel];
    }
    CopyFresh(*other, channel);
    return true;
  }

 private:
  void StepAll(std::span<const double> input, std::span<double> output) noexcept override {
    layout_.step(arrays_, factors_, input.data(), output.data());
  }
  void SetState(int channel, double position) noexcept override {
    for (int array = 0; array < layout_.r; ++array) arrays_[array][channel] = 0.0;
    arrays_[kX][channel] = position;
    for (const int variance : layout_.variances) arrays_[variance][channel] = 1.0;
  }

  Layout layout_;
  ProcessNoiseFactors factors_;
  ChannelArrays arrays_;
  std::optional<AccelerationEstimate> acceleration_;
};

}  // namespace

void KalmanConfig::Visit(SettingsVisitor& visitor) {
  VisitStart(visitor, start);
  noise.Visit(visitor);
  VisitStates(visitor, states);
  visitor.Integer({.key = "acceleration_window",
                   .help = "samples from which the acceleration input is estimated, at least 3; 0 "
                           "is without that input",
                   .min = 0,
                   .max = 10000},
                  acceleration_window);
}

std::unique_ptr<KalmanFilter> MakeKalmanFilter(const KalmanConfig& config, int channel_count,
                                               double rate_hz) {
  CheckSettings(config);
  if (config.acceleration_window == 1 || config.acceleration_window == 2) {
    throw SettingError("acceleration_window",
                       "is " + std::to_string(config.acceleration_window) +
                           ", must be 0 or at least 3 (a parabola has three coefficients)");
  }
  return std::make_unique<ChannelKalmanFilter>(config, channel_count, rate_hz);
}

std::unique_ptr<Filter> MakeFilter(const KalmanConfig& config, int channel_count, double rate_hz) {
  return MakeKalmanFilter(config, channel_count, rate_hz);
}

}  // namespace gauntlet::controller
