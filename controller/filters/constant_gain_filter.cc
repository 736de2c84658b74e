#include "controller/filters/constant_gain_filter.h"

#include <algorithm>

#include "controller/filters/recursive_filter.h"
#include "controller/filters/vectorise.h"

namespace gauntlet::controller {
namespace {

GAUNTLET_VECTORISED void Step2(double* x, double* v, const double* k1, const double* k2,
                               const double* z, double* output, int channel_count) {
  GAUNTLET_CHANNEL_LOOP
  for (int i = 0; i < channel_count; ++i) {
    const double prior = x[i] + v[i];
    const double innovation = z[i] - prior;
    const double posterior = prior + k1[i] * innovation;
    v[i] = v[i] + k2[i] * innovation;
    x[i] = posterior;
    output[i] = posterior;
  }
}

GAUNTLET_VECTORISED void Step3(double* x, double* v, double* a, const double* k1, const double* k2,
                               const double* k3, const double* z, double* output,
                               int channel_count) {
  GAUNTLET_CHANNEL_LOOP
  for (int i = 0; i < channel_count; ++i) {
    const double prior = x[i] + v[i] + 0.5 * a[i];
    const double innovation = z[i] - prior;
    const double posterior = prior + k1[i] * innovation;
    v[i] = v[i] + a[i] + k2[i] * innovation;
    a[i] = a[i] + k3[i] * innovation;
    x[i] = posterior;
    output[i] = posterior;
  }
}

class ConstantGainFilter final : public RecursiveFilter {
 public:
  ConstantGainFilter(const Eigen::ArrayXXd& gains, Start start)
      : RecursiveFilter(gains.cols(), gains.rows(), start), gains_(gains.cols(), gains.rows()) {
    for (int order = 0; order < gains.cols(); ++order) {
      std::copy_n(gains.col(order).data(), gains.rows(), gains_[order]);
    }
  }

 private:
  void StepAll(const double* input, double* output) noexcept override {
    if (gains_.array_count() == 2) {
      Step2(state(0), state(1), gains_[0], gains_[1], input, output, channel_count());
    } else {
      Step3(state(0), state(1), state(2), gains_[0], gains_[1], gains_[2], input, output,
            channel_count());
    }
  }
  void SettleAt(int channel, double value) noexcept override { state(0)[channel] = value; }

  ChannelArrays gains_;
};

}  // namespace

std::unique_ptr<Filter> MakeConstantGainFilter(const Eigen::ArrayXXd& gains, Start start) {
  return std::make_unique<ConstantGainFilter>(gains, start);
}

}  // namespace gauntlet::controller
