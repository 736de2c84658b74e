#include "controller/prediction/kalman_prediction.h"

#include "controller/filters/check_filter.h"
#include "controller/filters/kalman_steady_filter.h"
#include "controller/filters/recursive_filter.h"
#include "controller/filters/subnormal.h"
#include "controller/filters/vectorise.h"
#include "controller/prediction/horizon.h"

namespace gauntlet::controller {
namespace {

struct Parameters {
  double k1, k2;  // gains on position and velocity per step
  double horizon_steps;
};

GAUNTLET_VECTORISED void LookAhead(double* x, double* v, Parameters p, const double* z,
                                   double* output, int channel_count) {
  GAUNTLET_CHANNEL_LOOP
  for (int i = 0; i < channel_count; ++i) {
    const double prior = x[i] + v[i];
    const double innovation = WithoutSubnormal(z[i]) - prior;
    const double position = WithoutSubnormal(prior + p.k1 * innovation);
    const double velocity = WithoutSubnormal(v[i] + p.k2 * innovation);
    x[i] = position;
    v[i] = velocity;
    output[i] = position + p.horizon_steps * velocity;
  }
}

class KalmanPredictor final : public RecursiveFilter {
 public:
  KalmanPredictor(Parameters parameters, int channel_count)
      : RecursiveFilter(2, channel_count), parameters_(parameters) {}

 private:
  void StepAll(const double* input, double* output) noexcept override {
    LookAhead(state(0), state(1), parameters_, input, output, channel_count());
  }
  void SettleAt(int channel, double value) noexcept override { state(0)[channel] = value; }

  Parameters parameters_;
};

}  // namespace

void KalmanPredictionConfig::Visit(SettingsVisitor& visitor) {
  VisitHorizon(visitor, horizon_ms);
  visitor.Number({.key = "q_deg2_per_s3",
                  .help = "density of the white acceleration",
                  .min = 0,
                  .max = 1e12,
                  .open_range = true},
                 q_deg2_per_s3);
  visitor.Number({.key = "r_deg2",
                  .help = "variance of the noise that is still in the angle",
                  .min = 0,
                  .max = 1e6,
                  .open_range = true},
                 r_deg2);
}

std::unique_ptr<Filter> MakePredictor(const KalmanPredictionConfig& config, int channel_count,
                                      double rate_hz) {
  CheckFilter(config, channel_count, rate_hz);
  // Only the ratio of q to r matters, so degrees may stay.
  const KalmanSteadyConfig model = {.noise = {.r = {config.r_deg2},
                                              .q = {config.q_deg2_per_s3},
                                              .process_noise = ProcessNoise::kWhite}};
  const Eigen::ArrayXXd gains = SteadyGains(model, 1, rate_hz);
  return std::make_unique<KalmanPredictor>(
      Parameters{gains(0, 0), gains(0, 1), config.horizon_ms * 1e-3 * rate_hz}, channel_count);
}

}  // namespace gauntlet::controller
