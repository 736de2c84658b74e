#include "controller/prediction/kalman_prediction.h"

#include <algorithm>

#include "controller/filters/channel_arrays.h"
#include "controller/filters/check_filter.h"
#include "controller/filters/kalman_kernels.h"
#include "controller/filters/recursive_filter.h"
#include "controller/filters/steady_gains.h"
#include "controller/filters/vectorise.h"
#include "controller/prediction/horizon.h"
#include "controller/prediction/measurement_noise.h"
#include "controller/prediction/predictor.h"

namespace gauntlet::controller {
namespace {

GAUNTLET_VECTORISED void AlongVelocity(const double* x, const double* v, const double* horizon,
                                       double* output, int channel_count) {
  GAUNTLET_CHANNEL_LOOP
  for (int i = 0; i < channel_count; ++i) output[i] = x[i] + horizon[i] * v[i];
}

GAUNTLET_VECTORISED void AlongParabola(const double* x, const double* v, const double* a,
                                       const double* horizon, double* output, int channel_count) {
  GAUNTLET_CHANNEL_LOOP
  for (int i = 0; i < channel_count; ++i) {
    output[i] = x[i] + horizon[i] * (v[i] + 0.5 * horizon[i] * a[i]);
  }
}

class KalmanPredictor final : public RecursiveFilter {
 public:
  KalmanPredictor(const Eigen::ArrayXXd& gains, const Eigen::ArrayXd& horizon_steps)
      : RecursiveFilter(gains.cols(), gains.rows()),
        states_(gains.cols()),
        constants_(states_ + 1, gains.rows()) {
    for (int state = 0; state < states_; ++state) {
      std::copy_n(gains.col(state).data(), gains.rows(), constants_[state]);
    }
    std::copy(horizon_steps.begin(), horizon_steps.end(), constants_[states_]);
  }

 private:
  void StepAll(const double* input, double* output) noexcept override {
    const int n = channel_count();
    const double* horizon = constants_[states_];
    if (states_ == 2) {
      StepStates2({.x = state(0), .w = state(1), .k1 = constants_[0], .k2 = constants_[1]}, input,
                  output, n);
      AlongVelocity(state(0), state(1), horizon, output, n);
    } else {
      StepStates3({.x = state(0),
                   .w = state(1),
                   .a = state(2),
                   .k1 = constants_[0],
                   .k2 = constants_[1],
                   .k3 = constants_[2]},
                  input, output, n);
      AlongParabola(state(0), state(1), state(2), horizon, output, n);
    }
  }
  void SettleAt(int channel, double value) noexcept override { state(0)[channel] = value; }

  int states_;
  ChannelArrays constants_;  // one gain per state, and the horizon in steps
};

}  // namespace

void KalmanPredictionConfig::Visit(SettingsVisitor& visitor) {
  VisitHorizon(visitor, horizon_ms);
  visitor.Integer({"states", "2: the velocity stays; 3: the acceleration does", 2, 3}, states);
  if (states == 2) {
    visitor.Number({.key = "q_deg2_per_s3",
                    .help = "density of the white acceleration; with 2 states",
                    .min = 0,
                    .max = 1e12,
                    .open_range = true},
                   q_deg2_per_s3);
  } else {
    visitor.Number({.key = "q_deg2_per_s5",
                    .help = "density of the white jerk; with 3 states",
                    .min = 0,
                    .max = 1e14,
                    .open_range = true},
                   q_deg2_per_s5);
  }
  VisitMeasurementNoise(visitor, r_deg2);
}

std::unique_ptr<Filter> MakePredictor(const KalmanPredictionConfig& config, int channel_count,
                                      double rate_hz) {
  CheckFilter(config, channel_count, rate_hz);
  const Eigen::ArrayXd r = PerChannel("r_deg2", config.r_deg2, channel_count);
  // Only the ratio of q to r matters, so degrees may stay.
  const KalmanSteadyConfig model = {
      .noise = {.r = {r.begin(), r.end()},
                .q = {config.states == 2 ? config.q_deg2_per_s3 : config.q_deg2_per_s5},
                .process_noise = ProcessNoise::kWhite},
      .states = config.states};
  return std::make_unique<KalmanPredictor>(SteadyGains(model, channel_count, rate_hz),
                                           HorizonSteps(config.horizon_ms, channel_count, rate_hz));
}

}  // namespace gauntlet::controller
