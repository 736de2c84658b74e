#include "controller/prediction/double_exponential_prediction.h"

#include <algorithm>
#include <cmath>

#include "controller/filters/channel_arrays.h"
#include "controller/filters/check_filter.h"
#include "controller/filters/recursive_filter.h"
#include "controller/filters/subnormal.h"
#include "controller/filters/vectorise.h"
#include "controller/prediction/horizon.h"
#include "controller/prediction/predictor.h"

namespace gauntlet::controller {
namespace {

GAUNTLET_VECTORISED void SmoothTwice(double* once, double* twice, const double* trend_steps,
                                     double a, const double* z, double* output, int channel_count) {
  GAUNTLET_CHANNEL_LOOP
  for (int i = 0; i < channel_count; ++i) {
    const double s = WithoutSubnormal(once[i] + a * (WithoutSubnormal(z[i]) - once[i]));
    const double d = WithoutSubnormal(twice[i] + a * (s - twice[i]));
    once[i] = s;
    twice[i] = d;
    output[i] = s + (1.0 + trend_steps[i]) * (s - d);
  }
}

class DoubleExponentialPredictor final : public RecursiveFilter {
 public:
  DoubleExponentialPredictor(double a, const Eigen::ArrayXd& trend_steps)
      : RecursiveFilter(2, trend_steps.size()), a_(a), trend_steps_(1, trend_steps.size()) {
    std::copy(trend_steps.begin(), trend_steps.end(), trend_steps_[0]);
  }

 private:
  void StepAll(const double* input, double* output) noexcept override {
    SmoothTwice(state(0), state(1), trend_steps_[0], a_, input, output, channel_count());
  }
  void SettleAt(int channel, double value) noexcept override {
    state(0)[channel] = WithoutSubnormal(value);
    state(1)[channel] = WithoutSubnormal(value);
  }

  double a_;
  ChannelArrays trend_steps_;
};

}  // namespace

void DoubleExponentialPredictionConfig::Visit(SettingsVisitor& visitor) {
  VisitHorizon(visitor, horizon_ms);
  visitor.Number({"smoothing_ms", "time constant of each of the two smoothings", 1, 1e4},
                 smoothing_ms);
}

std::unique_ptr<Filter> MakePredictor(const DoubleExponentialPredictionConfig& config,
                                      int channel_count, double rate_hz) {
  CheckFilter(config, channel_count, rate_hz);
  const double steps = config.smoothing_ms * 1e-3 * rate_hz;
  const double a = -std::expm1(-1.0 / steps);
  // a / (1 - a) = exp(1 / steps) - 1
  return std::make_unique<DoubleExponentialPredictor>(
      a, std::expm1(1.0 / steps) * HorizonSteps(config.horizon_ms, channel_count, rate_hz));
}

}  // namespace gauntlet::controller
