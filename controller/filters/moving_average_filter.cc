#include "controller/filters/moving_average_filter.h"

#include <utility>

#include "controller/filters/channel_arrays.h"
#include "controller/filters/check_filter.h"
#include "controller/filters/filter_registry.h"
#include "controller/filters/sample_window.h"
#include "controller/filters/subnormal.h"
#include "controller/filters/vectorise.h"

namespace gauntlet::controller {
namespace {

/// The entering sample takes the place of the leaving one, and the mean is that of `count` samples.
/// sum + correction is the exact sum to about 106 bits, so that adding and taking away the same
/// samples for days leaves nothing behind (Knuth's two-sum; Ogita, Rump, Oishi 2005).
GAUNTLET_VECTORISED void Slide(double* sum, double* correction, double* place, const double* input,
                               double count, double* mean, int channel_count) {
  GAUNTLET_CHANNEL_LOOP
  for (int i = 0; i < channel_count; ++i) {
    const double entering = WithoutSubnormal(input[i]);
    const double leaving = place[i];
    const double with = sum[i] + entering;
    const double part = with - sum[i];
    const double lost = (sum[i] - (with - part)) + (entering - part);
    const double without = with - leaving;
    const double part_out = without - with;
    const double lost_out = (with - (without - part_out)) - (leaving + part_out);
    const double corrected = correction[i] + (lost + lost_out);
    place[i] = entering;
    sum[i] = without;
    correction[i] = corrected;
    mean[i] = (without + corrected) / count;
  }
}

class MovingAverageFilter final : public Filter {
 public:
  MovingAverageFilter(const MovingAverageConfig& config, int channel_count)
      : Filter(channel_count), window_(config.window, channel_count), sums_(2, channel_count) {}

  void Reset() noexcept override {
    window_.Reset();
    sums_.SetZero();
  }

 private:
  enum Array { kSum, kCorrection };

  void StepChecked(std::span<const double> input, std::span<double> output) noexcept override {
    Slide(sums_[kSum], sums_[kCorrection], window_.Advance(), input.data(), window_.length(),
          output.data(), channel_count());
    if (!window_.all_full()) DivideByCount(output);
  }
  void ResetChecked(int channel) noexcept override {
    window_.ResetChannel(channel);
    sums_[kSum][channel] = 0.0;
    sums_[kCorrection][channel] = 0.0;
  }
  void StartChecked(std::span<const double> values) noexcept override {
    window_.StartAt(values);
    sums_.SetZero();
    CopyWithoutSubnormals(values.data(), sums_[kSum], channel_count());
  }
  bool SwapChecked(Filter& from) noexcept override {
    auto* other = dynamic_cast<MovingAverageFilter*>(&from);
    if (other == nullptr || other->window_.length() != window_.length()) return false;
    std::swap(window_, other->window_);
    std::swap(sums_, other->sums_);
    return true;
  }

  void DivideByCount(std::span<double> output) noexcept {
    for (int i = 0; i < channel_count(); ++i) {
      output[i] = (sums_[kSum][i] + sums_[kCorrection][i]) / window_.count(i);
    }
  }

  SampleWindow window_;
  ChannelArrays sums_;
};

}  // namespace

std::unique_ptr<Filter> MakeFilter(const MovingAverageConfig& config, int channel_count,
                                   double rate_hz) {
  CheckFilter(config, channel_count, rate_hz);
  return std::make_unique<MovingAverageFilter>(config, channel_count);
}

}  // namespace gauntlet::controller
