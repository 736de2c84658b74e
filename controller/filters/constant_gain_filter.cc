#include "controller/filters/constant_gain_filter.h"

#include <algorithm>

#include "controller/filters/kalman_kernels.h"
#include "controller/filters/recursive_filter.h"

namespace gauntlet::controller {
namespace {

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
      StepStates2({.x = state(0), .w = state(1), .k1 = gains_[0], .k2 = gains_[1]}, input, output,
                  channel_count());
    } else {
      StepStates3({.x = state(0),
                   .w = state(1),
                   .a = state(2),
                   .k1 = gains_[0],
                   .k2 = gains_[1],
                   .k3 = gains_[2]},
                  input, output, channel_count());
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
