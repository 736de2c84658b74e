#include "controller/filters/one_euro_filter.h"

#include <array>
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

/// One channel. `change`: since the value that the speed counts from.
inline double SmoothOne(double& y, double& d, const Parameters& p, double rate_per_turn,
                        double step, double change) {
  // What is added keeps a long rest from subnormal numbers: no bit of any speed that counts.
  d = d + p.derivative_weight * (change * p.rate_hz - d) + kLeastValue;
  const double cutoff_hz = p.min_cutoff_hz + p.beta * std::abs(d);
  y = y + step * (cutoff_hz / (cutoff_hz + rate_per_turn));
  return y;
}

GAUNTLET_VECTORISED void Smooth(double* y, double* d, Parameters p, const double* z, double* output,
                                int channel_count) {
  const double rate_per_turn = p.rate_hz / (2.0 * std::numbers::pi);
  GAUNTLET_CHANNEL_LOOP
  for (int i = 0; i < channel_count; ++i) {
    const double step = WithoutSubnormal(z[i] - y[i]);
    output[i] = SmoothOne(y[i], d[i], p, rate_per_turn, step, step);
  }
}

GAUNTLET_VECTORISED void SmoothFromRaw(double* y, double* d, double* last, Parameters p,
                                       const double* z, double* output, int channel_count) {
  const double rate_per_turn = p.rate_hz / (2.0 * std::numbers::pi);
  GAUNTLET_CHANNEL_LOOP
  for (int i = 0; i < channel_count; ++i) {
    const double step = WithoutSubnormal(z[i] - y[i]);
    const double change = WithoutSubnormal(z[i] - last[i]);
    last[i] = z[i];
    output[i] = SmoothOne(y[i], d[i], p, rate_per_turn, step, change);
  }
}

class OneEuroFilter final : public RecursiveFilter {
 public:
  OneEuroFilter(const OneEuroConfig& config, int channel_count, double rate_hz)
      : RecursiveFilter(IsRaw(config) ? 3 : 2, channel_count),
        is_raw_(IsRaw(config)),
        parameters_{rate_hz, config.min_cutoff_hz, config.beta,
                    Weight(config.derivative_cutoff_hz, rate_hz)} {}

 private:
  enum State { kY, kDerivative, kLastSample };

  static bool IsRaw(const OneEuroConfig& config) {
    return config.speed_from == OneEuroConfig::SpeedFrom::kRaw;
  }
  void StepAll(const double* input, double* output) noexcept override {
    const int n = channel_count();
    if (is_raw_) {
      SmoothFromRaw(state(kY), state(kDerivative), state(kLastSample), parameters_, input, output,
                    n);
    } else {
      Smooth(state(kY), state(kDerivative), parameters_, input, output, n);
    }
  }
  void SettleAt(int channel, double value) noexcept override {
    state(kY)[channel] = value;
    if (is_raw_) state(kLastSample)[channel] = value;
  }

  bool is_raw_;
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
  static constexpr std::array<std::string_view, 2> kNames = {"filtered", "raw"};
  VisitEnum(visitor,
            {"speed_from",
             "what the speed counts from; filtered: the last filtered value; raw: the last sample, "
             "as MediaPipe and older copies of the filter"},
            kNames, speed_from);
}

std::unique_ptr<Filter> MakeFilter(const OneEuroConfig& config, int channel_count, double rate_hz) {
  CheckFilter(config, channel_count, rate_hz);
  return std::make_unique<OneEuroFilter>(config, channel_count, rate_hz);
}

}  // namespace gauntlet::controller
