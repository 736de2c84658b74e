#include "controller/filters/one_euro_filter.h"

#include <cmath>
#include <numbers>

#include "controller/filters/check_filter.h"
#include "controller/filters/filter_registry.h"
#include "controller/filters/recursive_filter.h"
#include "controller/filters/subnormal.h"
#include "controller/filters/vectorise.h"

namespace gauntlet::controller {
namespace {

struct Parameters {
  double rate_hz;
  double min_cutoff_hz;
  double beta;
  double derivative_weight;  // a(derivative_cutoff_hz)
};

/// a(f) = 1 / (1 + rate / (2 pi f))
double Weight(double cutoff_hz, double rate_hz) {
  return 1.0 / (1.0 + rate_hz / (2.0 * std::numbers::pi * cutoff_hz));
}

GAUNTLET_VECTORISED void Smooth(double* y, double* d, Parameters p, const double* z, double* output,
                                int channel_count) {
  const double rate_per_turn = p.rate_hz / (2.0 * std::numbers::pi);
  GAUNTLET_CHANNEL_LOOP
  for (int i = 0; i < channel_count; ++i) {
    const double step = WithoutSubnormal(z[i] - y[i]);
    // What is added keeps a long rest from subnormal numbers: no bit of any speed that counts.
    const double derivative = d[i] + p.derivative_weight * (step * p.rate_hz - d[i]) + kLeastValue;
    const double cutoff_hz = p.min_cutoff_hz + p.beta * std::abs(derivative);
    const double smoothed = y[i] + step * (cutoff_hz / (cutoff_hz + rate_per_turn));
    d[i] = derivative;
    y[i] = smoothed;
    output[i] = smoothed;
  }
}

class OneEuroFilter final : public RecursiveFilter {
 public:
  OneEuroFilter(const OneEuroConfig& config, int channel_count, double rate_hz)
      : RecursiveFilter(2, channel_count),
        parameters_{rate_hz, config.min_cutoff_hz, config.beta,
                    Weight(config.derivative_cutoff_hz, rate_hz)} {}

 private:
  enum State { kY, kDerivative };

  void StepAll(const double* input, double* output) noexcept override {
    Smooth(state(kY), state(kDerivative), parameters_, input, output, channel_count());
  }
  void SettleAt(int channel, double value) noexcept override { state(kY)[channel] = value; }

  Parameters parameters_;
};

}  // namespace

void OneEuroConfig::Visit(SettingsVisitor& visitor) {
  visitor.Number({"min_cutoff_hz", "cutoff frequency at rest; lower means less jitter", 1e-6, 1e6},
                 min_cutoff_hz);
  visitor.Number(
      {"beta",
       "how fast the cutoff rises with the speed [Hz / (input unit / s)]; higher means less lag", 0,
       1e9},
      beta);
  visitor.Number(
      {"derivative_cutoff_hz", "cutoff frequency of the speed's own low pass", 1e-6, 1e6},
      derivative_cutoff_hz);
}

std::unique_ptr<Filter> MakeFilter(const OneEuroConfig& config, int channel_count, double rate_hz) {
  CheckFilter(config, channel_count, rate_hz);
  return std::make_unique<OneEuroFilter>(config, channel_count, rate_hz);
}

}  // namespace gauntlet::controller
