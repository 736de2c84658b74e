#include "controller/filters/kalman_adaptive_filter.h"

#include <algorithm>
#include <vector>

#include "controller/filters/channel_arrays.h"
#include "controller/filters/check_filter.h"
#include "controller/filters/filter_registry.h"
#include "controller/filters/kalman_kernels.h"
#include "controller/filters/kalman_variances.h"
#include "controller/filters/state_filter.h"
#include "controller/filters/subnormal.h"
#include "controller/filters/vectorise.h"

namespace gauntlet::controller {
namespace {

/// Arrays of one value per channel: those of the filter itself, then statistics of the innovations,
/// then the limits of learning.
enum Array {
  kBefore = kKalmanArrays2,  // the last innovation
  kC0,
  kC1,
  kRMin,
  kRMax,
  kQMin,
  kQMax,
  kInitialR,
  kInitialQ,
  kArrays
};

/// How fast things change per sample; 0 where nothing is to be learned.
struct Rates {
  double mean;   // of c_0 and c_1
  double scale;  // of both R and q, towards the innovations' size
  double r, q;   // of one of them, by the innovations' correlation
  // Limits of one sample. Not constants: with those the compiler computes on in branches, and gives
  // up vectors.
  double most_weight = 1.0;
  double most_size = 2.0;
};

/// A sample at m standard deviations, m > 5, counts as one at 25 / m.
constexpr double kMostTimes = 25.0;

/// After a step: `innovation` is the correction of the step, no subnormal number.
GAUNTLET_VECTORISED void Learn(ChannelArrays& arrays, Rates rates, const double* innovation) {
  double *r = arrays[kR], *q = arrays[kQ];
  double *before = arrays[kBefore], *c0 = arrays[kC0], *c1 = arrays[kC1];
  const double* p11 = arrays[kP11];
  const double *r_min = arrays[kRMin], *r_max = arrays[kRMax];
  const double *q_min = arrays[kQMin], *q_max = arrays[kQMax];
  const int channel_count = arrays.channel_count();
  GAUNTLET_CHANNEL_LOOP
  for (int i = 0; i < channel_count; ++i) {
    const double r_old = r[i];
    const double q_old = q[i];
    const double r_least = r_min[i];
    const double r_most = r_max[i];
    const double q_least = q_min[i];
    const double q_most = q_max[i];
    const double innovated = innovation[i];
    // P_11 = K_1 R and 1 - K_1 = R / S give S back.
    const double s = r_old * r_old / (r_old - p11[i]);
    const double ratio = kMostTimes * s / (innovated * innovated);
    const double weight = ratio < rates.most_weight ? ratio : rates.most_weight;
    const double e = weight * innovated;
    const double mean = c0[i] + rates.mean * (e * e - c0[i]);
    const double c0_new = mean > r_least ? mean : r_least;  // never 0 at absolute rest
    const double c1_new = c1[i] + rates.mean * (e * before[i] - c1[i]);
    const double correlation = c1_new / c0_new;
    const double size_seen = c0_new / s;
    const double size = size_seen < rates.most_size ? size_seen : rates.most_size;
    const double scale = 1.0 + rates.scale * (size - 1.0);
    const double r_new = r_old * scale * (1.0 - rates.r * correlation);
    const double q_new = q_old * scale * (1.0 + rates.q * correlation);
    // One choice per line, among what has been read: the compiler gives up vectors for others.
    const double r_low = r_new < r_least ? r_least : r_new;
    const double q_low = q_new < q_least ? q_least : q_new;
    before[i] = WithoutSubnormal(e);
    c0[i] = c0_new;
    c1[i] = WithoutSubnormal(c1_new);
    r[i] = r_low > r_most ? r_most : r_low;
    q[i] = q_low > q_most ? q_most : q_low;
  }
}

Rates RatesOf(const KalmanAdaptiveConfig& config) {
  constexpr double kCorrelationSpeed = 4.0;
  const double mean = 1.0 / config.memory;
  const double by_correlation = kCorrelationSpeed * mean;
  return {.mean = mean,
          .scale = config.adapt_r && config.adapt_q ? mean : 0.0,
          .r = config.adapt_r && !config.adapt_q ? by_correlation : 0.0,
          .q = config.adapt_q ? by_correlation : 0.0};
}

class LearningKalmanFilter final : public StateFilter<KalmanAdaptiveFilter> {
 public:
  LearningKalmanFilter(const KalmanAdaptiveConfig& config, int channel_count, double rate_hz)
      : StateFilter(config.start, channel_count),
        factors_(FactorsOf(config.noise.process_noise, 2, 1.0 / rate_hz)),
        rates_(RatesOf(config)),
        arrays_(kArrays, channel_count),
        innovation_(channel_count) {
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

  double r(int channel) const noexcept override { return arrays_[kR][channel]; }
  double q(int channel) const noexcept override { return arrays_[kQ][channel]; }

 private:
  bool SwapChecked(Filter& from) noexcept override {
    auto* other = dynamic_cast<LearningKalmanFilter*>(&from);
    if (other == nullptr) return false;
    arrays_.Copy(other->arrays_, 0, kRMin);
    for (int i = 0; i < channel_count(); ++i) {
      arrays_[kR][i] = std::clamp(arrays_[kR][i], arrays_[kRMin][i], arrays_[kRMax][i]);
      arrays_[kQ][i] = std::clamp(arrays_[kQ][i], arrays_[kQMin][i], arrays_[kQMax][i]);
    }
    SwapFresh(*other);
    return true;
  }
  void StepAll(std::span<const double> input, std::span<double> output) noexcept override {
    for (int i = 0; i < channel_count(); ++i) {
      innovation_[i] = WithoutSubnormal(input[i] - (arrays_[kX][i] + arrays_[kW][i]));
    }
    StepKalman2(arrays_, factors_, input.data(), output.data());
    Learn(arrays_, rates_, innovation_.data());
  }
  void SetState(int channel, double position) noexcept override {
    for (int array = 0; array < kR; ++array) arrays_[array][channel] = 0.0;
    arrays_[kX][channel] = position;
    arrays_[kP11][channel] = 1.0;
    arrays_[kP22][channel] = 1.0;
    arrays_[kR][channel] = arrays_[kInitialR][channel];
    arrays_[kQ][channel] = arrays_[kInitialQ][channel];
    arrays_[kBefore][channel] = 0.0;
    arrays_[kC0][channel] = arrays_[kInitialR][channel];
    arrays_[kC1][channel] = 0.0;
  }

  ProcessNoiseFactors factors_;
  Rates rates_;
  ChannelArrays arrays_;
  std::vector<double> innovation_;
};

}  // namespace

void KalmanAdaptiveConfig::Visit(SettingsVisitor& visitor) {
  VisitStart(visitor, start);
  noise.Visit(visitor);
  visitor.Number({"memory", "samples that R and q are averaged over", 2, 1e9}, memory);
  visitor.Number(
      {"range", "how many times larger or smaller than at the start R and q may become", 1, 1e12},
      range);
  visitor.Flag({"adapt_r", "learn the measurement variance"}, adapt_r);
  visitor.Flag({"adapt_q", "learn how much the motion changes"}, adapt_q);
}

std::unique_ptr<KalmanAdaptiveFilter> MakeKalmanAdaptiveFilter(const KalmanAdaptiveConfig& config,
                                                               int channel_count, double rate_hz) {
  CheckFilter(config, channel_count, rate_hz);
  return std::make_unique<LearningKalmanFilter>(config, channel_count, rate_hz);
}

std::unique_ptr<Filter> MakeFilter(const KalmanAdaptiveConfig& config, int channel_count,
                                   double rate_hz) {
  return MakeKalmanAdaptiveFilter(config, channel_count, rate_hz);
}

}  // namespace gauntlet::controller
