#include "controller/filters/kalman_adaptive_filter.h"

#include <algorithm>
#include <vector>

#include "controller/filters/channel_arrays.h"
#include "controller/filters/fresh_channels.h"
#include "controller/filters/kalman_kernels.h"
#include "controller/filters/vectorise.h"

namespace gauntlet::controller {
namespace {

/// What is remembered per channel: the arrays of the filter itself, then the limits of learning.
enum Array { kRMin = kKalmanArrays2, kRMax, kQMin, kQMax, kInitialR, kInitialQ, kArrays };

/// A sample beyond five standard deviations teaches as much as one there: an outlier must not
/// become the new normal.
constexpr double kMostTimes = 25.0;

struct Learning {
  double r_rate, q_rate;  // 1 / memory, or 0 where nothing is learned
  double q22_factor;
};

/// After a step that gave `posterior` from `measured` and moved the velocity from `w_before` to
/// `w`.
GAUNTLET_VECTORISED void Learn(double* r, double* q, const double* r_min, const double* r_max,
                               const double* q_min, const double* q_max, const double* p11,
                               const double* w, const double* w_before, const double* measured,
                               const double* posterior, Learning learning, int channel_count) {
  GAUNTLET_CHANNEL_LOOP
  for (int i = 0; i < channel_count; ++i) {
    const double residual = measured[i] - posterior[i];
    const double correction = w[i] - w_before[i];  // K_2 e
    const double r_raw = residual * residual + p11[i];
    const double q_raw = correction * correction / learning.q22_factor;
    const double r_seen = r_raw < kMostTimes * r[i] ? r_raw : kMostTimes * r[i];
    const double q_seen = q_raw < kMostTimes * q[i] ? q_raw : kMostTimes * q[i];
    const double r_new = r[i] + learning.r_rate * (r_seen - r[i]);
    const double q_new = q[i] + learning.q_rate * (q_seen - q[i]);
    r[i] = r_new < r_min[i] ? r_min[i] : r_new > r_max[i] ? r_max[i] : r_new;
    q[i] = q_new < q_min[i] ? q_min[i] : q_new > q_max[i] ? q_max[i] : q_new;
  }
}

class LearningKalmanFilter final : public KalmanAdaptiveFilter {
 public:
  LearningKalmanFilter(const KalmanAdaptiveConfig& config, int channel_count, double rate_hz)
      : start_(config.start),
        factors_(FactorsOf(config.noise.process_noise, 2, 1.0 / rate_hz)),
        learning_{config.adapt_r ? 1.0 / config.memory : 0.0,
                  config.adapt_q ? 1.0 / config.memory : 0.0, factors_.q22},
        arrays_(kArrays, channel_count),
        measured_(static_cast<std::size_t>(channel_count)),
        velocity_before_(static_cast<std::size_t>(channel_count)),
        fresh_(channel_count) {
    const Eigen::ArrayXd r = MeasurementVariance(config.noise, channel_count);
    const Eigen::ArrayXd q = ProcessVariance(config.noise, channel_count);
    if (!(q.minCoeff() > 0.0)) throw SettingError("q", "is 0, must be above 0 to start learning");
    for (int i = 0; i < channel_count; ++i) {
      arrays_[kInitialR][i] = r[i];
      arrays_[kInitialQ][i] = q[i];
      arrays_[kRMin][i] = r[i] / config.range;
      arrays_[kRMax][i] = r[i] * config.range;
      arrays_[kQMin][i] = q[i] / config.range;
      arrays_[kQMax][i] = q[i] * config.range;
    }
    Reset();
  }

  int channel_count() const noexcept override { return arrays_.channel_count(); }
  double r(int channel) const noexcept override { return arrays_[kR][channel]; }
  double q(int channel) const noexcept override { return arrays_[kQ][channel]; }

  void Step(std::span<const double> input, std::span<double> output) noexcept override {
    std::copy(input.begin(), input.end(), measured_.begin());
    std::copy_n(arrays_[kW], channel_count(), velocity_before_.begin());
    StepKalman2(arrays_, factors_, measured_.data(), output.data());
    Learn(arrays_[kR], arrays_[kQ], arrays_[kRMin], arrays_[kRMax], arrays_[kQMin], arrays_[kQMax],
          arrays_[kP11], arrays_[kW], velocity_before_.data(), measured_.data(), output.data(),
          learning_, channel_count());
    if (!fresh_.any()) return;
    fresh_.StartAll(measured_, [&](int channel, double value) {
      SetState(channel, value);
      output[static_cast<std::size_t>(channel)] = value;
    });
  }

  void Reset() noexcept override {
    for (int i = 0; i < channel_count(); ++i) ResetChannel(i);
  }
  void ResetChannel(int channel) noexcept override {
    SetState(channel, 0.0);
    if (start_ == Start::kFirst) fresh_.Add(channel);
  }
  bool CopyChannel(const Filter& from, int channel) noexcept override {
    const auto* other = dynamic_cast<const LearningKalmanFilter*>(&from);
    if (other == nullptr) return false;
    for (int array = 0; array < kKalmanArrays2; ++array) {
      arrays_[array][channel] = other->arrays_[array][channel];
    }
    arrays_[kR][channel] =
        std::clamp(arrays_[kR][channel], arrays_[kRMin][channel], arrays_[kRMax][channel]);
    arrays_[kQ][channel] =
        std::clamp(arrays_[kQ][channel], arrays_[kQMin][channel], arrays_[kQMax][channel]);
    fresh_.CopyFrom(other->fresh_, channel);
    return true;
  }

 private:
  void SetState(int channel, double position) noexcept {
    for (int array = 0; array < kR; ++array) arrays_[array][channel] = 0.0;
    arrays_[kX][channel] = position;
    arrays_[kP11][channel] = 1.0;
    arrays_[kP22][channel] = 1.0;
    arrays_[kR][channel] = arrays_[kInitialR][channel];
    arrays_[kQ][channel] = arrays_[kInitialQ][channel];
  }

  Start start_;
  ProcessNoiseFactors factors_;
  Learning learning_;
  ChannelArrays arrays_;
  std::vector<double> measured_;
  std::vector<double> velocity_before_;
  FreshChannels fresh_;
};

}  // namespace

void KalmanAdaptiveConfig::Visit(SettingsVisitor& visitor) {
  VisitStart(visitor, start);
  noise.Visit(visitor);
  visitor.Number(
      {.key = "memory", .help = "samples that R and q are averaged over", .min = 2, .max = 1e9},
      memory);
  visitor.Number({.key = "range",
                  .help = "how many times larger or smaller than at the start R and q may become",
                  .min = 1,
                  .max = 1e12},
                 range);
  visitor.Flag({.key = "adapt_r", .help = "learn the measurement variance"}, adapt_r);
  visitor.Flag({.key = "adapt_q", .help = "learn how much the motion changes"}, adapt_q);
}

std::unique_ptr<KalmanAdaptiveFilter> MakeKalmanAdaptiveFilter(const KalmanAdaptiveConfig& config,
                                                               int channel_count, double rate_hz) {
  return std::make_unique<LearningKalmanFilter>(config, channel_count, rate_hz);
}

std::unique_ptr<Filter> MakeFilter(const KalmanAdaptiveConfig& config, int channel_count,
                                   double rate_hz) {
  return MakeKalmanAdaptiveFilter(config, channel_count, rate_hz);
}

}  // namespace gauntlet::controller
