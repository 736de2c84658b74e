#include "controller/filters/kalman_filter.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "controller/filters/channel_arrays.h"
#include "controller/filters/check_filter.h"
#include "controller/filters/end_point_fit.h"
#include "controller/filters/filter_registry.h"
#include "controller/filters/kalman_kernels.h"
#include "controller/filters/kalman_variances.h"
#include "controller/filters/sample_window.h"
#include "controller/filters/state_filter.h"
#include "controller/filters/vectorise.h"

namespace gauntlet::controller {
namespace {

/// Which arrays hold what, for two and for three states. P begins at `p`, the gains at `k`.
struct Layout {
  int states;
  int array_count;
  int p, k, r, q;
  int variances[3];  // the diagonal of P
  void (*step_covariance)(ChannelArrays&, const ProcessNoiseFactors&);
};
constexpr Layout kLayout2 = {2,  kKalmanArrays2,     kP11,           kK1, kR,
                             kQ, {kP11, kP22, kP22}, StepCovariance2};
constexpr Layout kLayout3 = {
    3, kKalmanArrays3, kP11Of3, kK1Of3, kROf3, kQOf3, {kP11Of3, kP22Of3, kP33Of3}, StepCovariance3};

/// A covariance that a step changes by no more than this share has settled: what moves is rounding.
/// With q from 1e-12 to 1e8 and r from 0.01 to 3000 all come down to 2 epsilon with two states and
/// to 4 with three; fewer leave some that go round for ever.
constexpr double kRounding = 8.0 * std::numeric_limits<double>::epsilon();

GAUNTLET_VECTORISED void MarkMoving(const double* before, const double* now, double* moving,
                                    int channel_count) {
  GAUNTLET_CHANNEL_LOOP
  for (int i = 0; i < channel_count; ++i) {
    moving[i] = std::abs(now[i] - before[i]) > kRounding * std::abs(now[i]) ? 1.0 : moving[i];
  }
}

GAUNTLET_VECTORISED void KeepSettled(const double* before, const double* settled, double* now,
                                     int channel_count) {
  GAUNTLET_CHANNEL_LOOP
  for (int i = 0; i < channel_count; ++i) now[i] = settled[i] == 1.0 ? before[i] : now[i];
}

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
        arrays_(layout_.array_count, channel_count),
        before_(layout_.r, channel_count),
        progress_(kProgressArrays, channel_count) {
    const Eigen::ArrayXd r = MeasurementVariance(config.noise, channel_count);
    const Eigen::ArrayXd q = ProcessVariance(config.noise, channel_count);
    std::copy(r.begin(), r.end(), arrays_[layout_.r]);
    std::copy(q.begin(), q.end(), arrays_[layout_.q]);
    if (config.acceleration_window > 0) {
      acceleration_.emplace(config.acceleration_window, channel_count);
    }
    Reset();
  }

  double velocity(int channel) const noexcept override { return arrays_[kW][channel]; }

 private:
  enum Progress { kSettled, kMoving, kProgressArrays };  // 1 for yes, per channel

  void StepChecked(std::span<const double> input, std::span<double> output) noexcept override {
    if (acceleration_) AddInput(acceleration_->Step(input));
    StateFilter::StepChecked(input, output);
  }
  void StepWithAccelerationChecked(std::span<const double> input,
                                   std::span<const double> acceleration,
                                   std::span<double> output) noexcept override {
    AddInput(acceleration);
    StateFilter::StepChecked(input, output);
  }
  /// The kernel adds x + w; with w + u and x - u/2 that is A x + B u.
  void AddInput(std::span<const double> acceleration) noexcept {
    double* x = arrays_[kX];
    double* w = arrays_[kW];
    for (int i = 0; i < channel_count(); ++i) {
      const double u = acceleration[i];
      x[i] -= 0.5 * u;
      w[i] += u;
    }
  }
  void StepAll(std::span<const double> input, std::span<double> output) noexcept override {
    if (!all_settled_) StepCovariances();
    if (layout_.states == 2) {
      StepStates2({.x = arrays_[kX], .w = arrays_[kW], .k1 = arrays_[kK1], .k2 = arrays_[kK2]},
                  input.data(), output.data(), channel_count());
    } else {
      StepStates3({.x = arrays_[kX],
                   .w = arrays_[kW],
                   .a = arrays_[kAcceleration3],
                   .k1 = arrays_[kK1Of3],
                   .k2 = arrays_[kK2Of3],
                   .k3 = arrays_[kK3Of3]},
                  input.data(), output.data(), channel_count());
    }
  }
  /// A channel whose covariance has settled keeps it, and its gains, whatever the others do: so it
  /// gives the same bits alone and among others.
  void StepCovariances() noexcept {
    const int n = channel_count();
    before_.Copy(arrays_, layout_.p, layout_.r);
    layout_.step_covariance(arrays_, factors_);
    double* settled = progress_[kSettled];
    double* moving = progress_[kMoving];
    std::fill_n(moving, n, 0.0);
    for (int array = layout_.p; array < layout_.k; ++array) {
      MarkMoving(before_[array], arrays_[array], moving, n);
    }
    for (int array = layout_.p; array < layout_.r; ++array) {
      KeepSettled(before_[array], settled, arrays_[array], n);
    }
    int settled_count = 0;
    for (int i = 0; i < n; ++i) {
      if (moving[i] == 0.0) settled[i] = 1.0;
      settled_count += settled[i] == 1.0;
    }
    all_settled_ = settled_count == n;
  }

  void ResetChecked(int channel) noexcept override {
    StateFilter::ResetChecked(channel);
    if (acceleration_) acceleration_->window().ResetChannel(channel);
  }
  void StartChecked(std::span<const double> values) noexcept override {
    StateFilter::StartChecked(values);
    if (acceleration_) acceleration_->window().StartAt(values);
  }
  bool SwapChecked(Filter& from) noexcept override {
    auto* other = dynamic_cast<ChannelKalmanFilter*>(&from);
    if (other == nullptr || other->layout_.states != layout_.states) return false;
    if (other->acceleration_.has_value() != acceleration_.has_value()) return false;
    if (acceleration_) {
      if (other->acceleration_->window().length() != acceleration_->window().length()) return false;
      std::swap(acceleration_->window(), other->acceleration_->window());
    }
    arrays_.Copy(other->arrays_, 0, layout_.r);  // R and Q stay
    for (int i = 0; i < channel_count(); ++i) {
      const bool same = factors_ == other->factors_ &&
                        arrays_[layout_.r][i] == other->arrays_[layout_.r][i] &&
                        arrays_[layout_.q][i] == other->arrays_[layout_.q][i];
      progress_[kSettled][i] = same ? other->progress_[kSettled][i] : 0.0;
    }
    all_settled_ = false;
    SwapFresh(*other);
    return true;
  }
  void SetState(int channel, double position) noexcept override {
    for (int array = 0; array < layout_.r; ++array) arrays_[array][channel] = 0.0;
    arrays_[kX][channel] = position;
    for (const int variance : layout_.variances) arrays_[variance][channel] = 1.0;
    progress_[kSettled][channel] = 0.0;
    all_settled_ = false;
  }

  Layout layout_;
  ProcessNoiseFactors factors_;
  ChannelArrays arrays_;
  ChannelArrays before_;  // scratch of StepCovariances()
  ChannelArrays progress_;
  bool all_settled_ = false;
  std::optional<AccelerationEstimate> acceleration_;
};

}  // namespace

void KalmanConfig::Visit(SettingsVisitor& visitor) {
  VisitStart(visitor, start);
  noise.Visit(visitor);
  VisitStates(visitor, states);
  visitor.Integer({"acceleration_window",
                   "samples from which the acceleration input is estimated, at least 3; 0 is "
                   "without that input",
                   0, 10000},
                  acceleration_window);
}

std::unique_ptr<KalmanFilter> MakeKalmanFilter(const KalmanConfig& config, int channel_count,
                                               double rate_hz) {
  CheckFilter(config, channel_count, rate_hz);
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
