#include "controller/filters/butterworth_filter.h"

#include <cmath>
#include <numbers>
#include <vector>

#include "controller/filters/check_filter.h"
#include "controller/filters/filter_registry.h"
#include "controller/filters/recursive_filter.h"
#include "controller/filters/subnormal.h"
#include "controller/filters/vectorise.h"

namespace gauntlet::controller {
namespace {

/// s' = s + 2 v, y = s + v with v = gain (x - s): the trapezoidal integrator in a loop.
GAUNTLET_VECTORISED void StepFirstOrder(double* s, double gain, const double* input, double* output,
                                        int channel_count) {
  GAUNTLET_CHANNEL_LOOP
  for (int i = 0; i < channel_count; ++i) {
    const double v = gain * (WithoutSubnormal(input[i]) - s[i]);
    const double y = s[i] + v;
    s[i] = WithoutSubnormal(y + v);
    output[i] = y;
  }
}

using Section = ButterworthFactors::Section;

/// With prewarped frequency g and damping k = 1 / Q.
Section MakeSection(double g, double k) {
  const double a1 = 1.0 / (1.0 + g * (g + k));
  return {a1, g * a1, g * g * a1};
}

/// Two trapezoidal integrators: `band` and `low` are their states; at rest band = 0, low = input.
GAUNTLET_VECTORISED void StepSecondOrder(double* band, double* low, Section f, const double* input,
                                         double* output, int channel_count) {
  GAUNTLET_CHANNEL_LOOP
  for (int i = 0; i < channel_count; ++i) {
    const double difference = WithoutSubnormal(input[i]) - low[i];
    const double v1 = f.a1 * band[i] + f.a2 * difference;
    const double y = low[i] + f.a2 * band[i] + f.a3 * difference;
    band[i] = WithoutSubnormal(2.0 * v1 - band[i]);
    low[i] = WithoutSubnormal(2.0 * y - low[i]);
    output[i] = y;
  }
}

class ButterworthFilter final : public RecursiveFilter {
 public:
  ButterworthFilter(const ButterworthConfig& config, int channel_count, double rate_hz)
      : RecursiveFilter(config.order, channel_count, config.start),
        order_(config.order),
        factors_(FactorsOf(config, rate_hz)) {}

 private:
  void StepAll(const double* input, double* output) noexcept override {
    const double* from = input;
    int index = 0;
    if (order_ % 2 == 1) {
      StepFirstOrder(state(index++), factors_.first_order_gain, from, output, channel_count());
      from = output;
    }
    for (const Section& section : factors_.sections) {
      StepSecondOrder(state(index), state(index + 1), section, from, output, channel_count());
      index += 2;
      from = output;
    }
  }
  void SettleAt(int channel, double value) noexcept override {
    // States: the first-order one, then (band, low) per section.
    for (int index = order_ % 2 == 1 ? 0 : 1; index < order_;) {
      state(index)[channel] = value;
      index += 2;
    }
  }

  int order_;
  ButterworthFactors factors_;
};

}  // namespace

void ButterworthConfig::Visit(SettingsVisitor& visitor) {
  visitor.Integer({"order", "steepness: -6 dB per octave each", 1, 8}, order);
  visitor.Number({.key = "cutoff_hz",
                  .help = "frequency of -3 dB, below half the sampling rate",
                  .min = 0,
                  .max = 1e6,
                  .open_range = true},
                 cutoff_hz);
  VisitStart(visitor, start);
}

ButterworthFactors FactorsOf(const ButterworthConfig& config, double rate_hz) {
  CheckFilter(config, 1, rate_hz);
  if (!(config.cutoff_hz < 0.5 * rate_hz)) {
    throw SettingError("cutoff_hz", "is " + NumberText(config.cutoff_hz) +
                                        ", must be below half the rate, " +
                                        NumberText(0.5 * rate_hz));
  }
  const double g = std::tan(std::numbers::pi * config.cutoff_hz / rate_hz);
  ButterworthFactors factors;
  if (config.order % 2 == 1) factors.first_order_gain = g / (1.0 + g);
  for (int pair = 1; pair <= config.order / 2; ++pair) {
    const double angle = std::numbers::pi * (2 * pair - 1) / (2.0 * config.order);
    factors.sections.push_back(MakeSection(g, 2.0 * std::sin(angle)));
  }
  return factors;
}

std::unique_ptr<Filter> MakeFilter(const ButterworthConfig& config, int channel_count,
                                   double rate_hz) {
  CheckFilter(config, channel_count, rate_hz);
  return std::make_unique<ButterworthFilter>(config, channel_count, rate_hz);
}

}  // namespace gauntlet::controller
