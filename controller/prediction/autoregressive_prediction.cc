#include "controller/prediction/autoregressive_prediction.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "controller/angle.h"
#include "controller/filters/channel_arrays.h"
#include "controller/filters/check_filter.h"
#include "controller/filters/state_filter.h"
#include "controller/filters/subnormal.h"
#include "controller/prediction/history.h"
#include "controller/prediction/horizon.h"

namespace gauntlet::controller {
namespace {

/// As if one sample had already moved by so much: what is learned has to be larger.
constexpr double kFirstMotionDeg = 5.0;
/// No joint moves further: nothing is learned from a glove that says so.
constexpr double kMostMotionRad = std::numbers::pi;

class AutoregressivePredictor final : public StateFilter<Filter> {
 public:
  AutoregressivePredictor(const AutoregressivePredictionConfig& config,
                          const Eigen::ArrayXd& horizon_steps, int tap_steps, double rate_hz)
      : StateFilter(Start::kFirst, horizon_steps.size()),
        order_(config.order),
        tap_steps_(tap_steps),
        smooth_(-std::expm1(-1e3 / (config.smoothing_ms * rate_hz))),
        forget_(std::exp(-1e3 / (config.memory_ms * rate_hz))),
        leash_rad_(config.leash_deg * kRadPerDeg),
        first_p_(1.0 / std::pow(kFirstMotionDeg * kRadPerDeg, 2)),
        delay_(horizon_steps.size()),
        smoothed_(1, channel_count()),
        learned_(order_ * (order_ + 1), channel_count()),
        history_(MostSteps(horizon_steps) + order_ * tap_steps + 1, channel_count()),
        past_(order_),
        gain_(order_) {
    for (int i = 0; i < channel_count(); ++i) delay_[i] = Steps(horizon_steps[i]);
    Reset();
  }

 private:
  static int Steps(double steps) { return std::max(1, static_cast<int>(std::lround(steps))); }
  static int MostSteps(const Eigen::ArrayXd& steps) { return Steps(steps.maxCoeff()); }

  double& Weight(int i, int channel) noexcept { return learned_[i][channel]; }
  double& P(int row, int column, int channel) noexcept {
    return learned_[order_ + row * order_ + column][channel];
  }
  double Smoothed(int age, int channel) const noexcept { return history_.Row(age)[channel]; }
  void TakePast(int age, int channel) noexcept {
    const double then = Smoothed(age, channel);
    for (int i = 0; i < order_; ++i) {
      const double motion = then - Smoothed(age + (i + 1) * tap_steps_, channel);
      past_[i] = WithoutSubnormal(std::clamp(motion, -kMostMotionRad, kMostMotionRad));
    }
  }
  double Expected(int age, int channel) noexcept {
    double ahead = 0.0;
    for (int i = 0; i < order_; ++i) ahead += Weight(i, channel) * past_[i];
    return Smoothed(age, channel) + ahead;
  }

  void ForgetCovariance(int channel) noexcept {
    for (int i = 0; i < order_; ++i) {
      for (int j = 0; j < order_; ++j) P(i, j, channel) = i == j ? first_p_ : 0.0;
    }
  }
  void Learn(double measured, int channel) noexcept {
    const int then = delay_[channel];
    TakePast(then, channel);
    // A sample further off than the leash teaches no more than one at its end.
    const double off = std::clamp(measured - Expected(then, channel), -leash_rad_, leash_rad_);
    if (std::ranges::any_of(past_,
                            [](double motion) { return std::abs(motion) >= kMostMotionRad; }))
      return;
    double size = 0.0;  // p' P p
    double trace = 0.0;
    for (int i = 0; i < order_; ++i) {
      double row = 0.0;
      for (int j = 0; j < order_; ++j) row += P(i, j, channel) * past_[j];
      gain_[i] = row;  // P p
      size += past_[i] * row;
      trace += P(i, i, channel);
    }
    if (!(size >= 0.0)) return ForgetCovariance(channel);  // what rounding has made of P
    const double f = trace < order_ * first_p_ * forget_ ? forget_ : 1.0;
    const double scale = 1.0 / (f + size);
    for (int i = 0; i < order_; ++i) {
      double& weight = Weight(i, channel);
      weight = WithoutSubnormal(weight + scale * gain_[i] * off);
      for (int j = 0; j <= i; ++j) {
        const double p = (P(i, j, channel) - scale * gain_[i] * gain_[j]) / f;
        P(i, j, channel) = P(j, i, channel) = WithoutSubnormal(p);
      }
    }
  }

  void StepAll(std::span<const double> input, std::span<double> output) noexcept override {
    double* now = history_.Push();
    double* s = smoothed_[0];
    for (int i = 0; i < channel_count(); ++i) {
      const double measured = WithoutSubnormal(input[i]);
      s[i] = WithoutSubnormal(s[i] + smooth_ * (measured - s[i]));
      now[i] = s[i];
      Learn(measured, i);
      TakePast(0, i);
      output[i] = std::clamp(Expected(0, i), s[i] - leash_rad_, s[i] + leash_rad_);
    }
  }
  void SetState(int channel, double position) noexcept override {
    const double settled = WithoutSubnormal(position);
    smoothed_[0][channel] = settled;
    history_.Fill(channel, settled);
    for (int i = 0; i < order_; ++i) Weight(i, channel) = 0.0;
    ForgetCovariance(channel);
  }
  bool TakeChecked(Filter& from) noexcept override {
    auto* other = dynamic_cast<AutoregressivePredictor*>(&from);
    const bool fits = other != nullptr && other->delay_ == delay_ && other->order_ == order_ &&
                      other->tap_steps_ == tap_steps_;
    if (!fits) return false;
    std::swap(smoothed_, other->smoothed_);
    std::swap(learned_, other->learned_);
    std::swap(history_, other->history_);
    TakeFresh(*other);
    return true;
  }

  int order_;
  int tap_steps_;
  double smooth_;  // share of the newest sample
  double forget_;  // f
  double leash_rad_;
  double first_p_;  // P begins as so many times I [1/rad^2]
  std::vector<int> delay_;
  ChannelArrays smoothed_;  // s
  ChannelArrays learned_;   // w, then P row by row
  History history_;         // of s
  std::vector<double> past_;
  std::vector<double> gain_;
};

}  // namespace

void AutoregressivePredictionConfig::Visit(SettingsVisitor& visitor) {
  VisitHorizon(visitor, horizon_ms);
  visitor.Integer({.key = "order", .help = "how many samples of the past", .min = 1, .max = 20},
                  order);
  visitor.Number({.key = "tap_ms", .help = "how far they lie apart", .min = 0.1, .max = 1000},
                 tap_ms);
  visitor.Number({.key = "smoothing_ms",
                  .help = "time constant of the smoothing of what it learns from",
                  .min = 0.1,
                  .max = 1e4},
                 smoothing_ms);
  visitor.Number(
      {.key = "memory_ms", .help = "how long a sample is remembered", .min = 10, .max = 1e7},
      memory_ms);
  visitor.Number({.key = "leash_deg",
                  .help = "how far ahead of the smoothed angle it may look",
                  .min = 0,
                  .max = 360},
                 leash_deg);
}

std::unique_ptr<Filter> MakePredictor(const AutoregressivePredictionConfig& config,
                                      int channel_count, double rate_hz) {
  CheckFilter(config, channel_count, rate_hz);
  const int tap_steps = static_cast<int>(std::lround(config.tap_ms * 1e-3 * rate_hz));
  if (tap_steps < 1) {
    throw SettingError("tap_ms", "is " + NumberText(config.tap_ms) +
                                     ", must be at least a step of the filter, " +
                                     NumberText(1e3 / rate_hz) + " ms");
  }
  return std::make_unique<AutoregressivePredictor>(
      config, HorizonSteps(config.horizon_ms, channel_count, rate_hz), tap_steps, rate_hz);
}

}  // namespace gauntlet::controller
