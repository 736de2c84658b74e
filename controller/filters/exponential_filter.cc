#include "controller/filters/exponential_filter.h"

#include "controller/filters/check_filter.h"
#include "controller/filters/filter_registry.h"
#include "controller/filters/recursive_filter.h"
#include "controller/filters/subnormal.h"
#include "controller/filters/vectorise.h"

namespace gauntlet::controller {
namespace {

GAUNTLET_VECTORISED void Smooth(double* y, double alpha, const double* z, double* output,
                                int channel_count) {
  GAUNTLET_CHANNEL_LOOP
  for (int i = 0; i < channel_count; ++i) {
    const double smoothed = WithoutSubnormal(y[i] + alpha * (WithoutSubnormal(z[i]) - y[i]));
    y[i] = smoothed;
    output[i] = smoothed;
  }
}

class ExponentialFilter final : public RecursiveFilter {
 public:
  ExponentialFilter(const ExponentialConfig& config, int channel_count)
      : RecursiveFilter(1, channel_count), alpha_(config.alpha) {}

 private:
  void StepAll(const double* input, double* output) noexcept override {
    Smooth(state(0), alpha_, input, output, channel_count());
  }
  void SettleAt(int channel, double value) noexcept override { state(0)[channel] = value; }

  double alpha_;
};

}  // namespace

std::unique_ptr<Filter> MakeFilter(const ExponentialConfig& config, int channel_count,
                                   double rate_hz) {
  CheckFilter(config, channel_count, rate_hz);
  return std::make_unique<ExponentialFilter>(config, channel_count);
}

}  // namespace gauntlet::controller
