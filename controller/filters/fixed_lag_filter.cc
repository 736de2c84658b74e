#include "controller/filters/fixed_lag_filter.h"

#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

#include "controller/filters/channel_arrays.h"
#include "controller/filters/check_filter.h"
#include "controller/filters/filter_registry.h"
#include "controller/filters/kalman_kernels.h"
#include "controller/filters/kalman_variances.h"
#include "controller/filters/state_filter.h"
#include "controller/filters/subnormal.h"
#include "controller/filters/vectorise.h"

namespace gauntlet::controller {
namespace {

/// Start of the sample of this moment: the prediction [x^-] and its covariance.
GAUNTLET_VECTORISED void OpenSlot(const double* x, const double* w, const double* p11,
                                  const double* p12, const double* p22, const double* q,
                                  ProcessNoiseFactors f, double* estimate, double* c1, double* c2,
                                  int channel_count) {
  const double f11 = f.q11;
  const double f12 = f.q12;
  GAUNTLET_CHANNEL_LOOP
  for (int i = 0; i < channel_count; ++i) {
    const double sum = p12[i] + p22[i];
    estimate[i] = x[i] + w[i];
    c1[i] = (p11[i] + p12[i]) + sum + f11 * q[i];
    c2[i] = sum + f12 * q[i];
  }
}

/// The innovation of this moment in units of S = P⁻₁₁ + R, from the slot just opened.
GAUNTLET_VECTORISED void ScaleInnovation(const double* prediction, const double* p11_prior,
                                         const double* r, const double* z,
                                         double* scaled_innovation, int channel_count) {
  GAUNTLET_CHANNEL_LOOP
  for (int i = 0; i < channel_count; ++i) {
    const double s = p11_prior[i] + r[i];
    scaled_innovation[i] = (WithoutSubnormal(z[i]) - prediction[i]) / s;
  }
}

/// All slots: estimate, c_1 and c_2 of one after those of another, `stride` values apart.
GAUNTLET_VECTORISED void UpdateSlots(double* history, std::ptrdiff_t stride, int slots,
                                     const double* scaled_innovation, const double* k1,
                                     const double* k2, int channel_count) {
  for (int slot = 0; slot < slots; ++slot, history += 3 * stride) {
    double* estimate = history;
    double* c1 = history + stride;
    double* c2 = history + 2 * stride;
    GAUNTLET_CHANNEL_LOOP
    for (int i = 0; i < channel_count; ++i) {
      const double updated = estimate[i] + c1[i] * scaled_innovation[i];
      const double c2_posterior = c2[i] - k2[i] * c1[i];
      const double c1_posterior = c1[i] - k1[i] * c1[i];
      estimate[i] = updated;
      c1[i] = WithoutSubnormal(c1_posterior + c2_posterior);
      c2[i] = c2_posterior;  // stays as it is once c1 is 0
    }
  }
}

class FixedLagFilter final : public StateFilter<Filter> {
 public:
  FixedLagFilter(const FixedLagConfig& config, int channel_count, double rate_hz)
      : StateFilter(config.start, channel_count),
        slots_(config.lag + 1),
        factors_(FactorsOf(config.noise.process_noise, 2, 1.0 / rate_hz)),
        filter_(kKalmanArrays2, channel_count),
        history_(3 * slots_, channel_count),
        innovation_(1, channel_count),
        counts_(channel_count, 0) {
    const Eigen::ArrayXd r = MeasurementVariance(config.noise, channel_count);
    const Eigen::ArrayXd q = ProcessVariance(config.noise, channel_count);
    std::copy(r.begin(), r.end(), filter_[kR]);
    std::copy(q.begin(), q.end(), filter_[kQ]);
    Reset();
  }

  void Reset() noexcept override {
    newest_ = 0;
    StateFilter::Reset();
  }

 private:
  void StepChecked(std::span<const double> input, std::span<double> output) noexcept override {
    StateFilter::StepChecked(input, output);
    Deliver(output);
  }
  void ResetChecked(int channel) noexcept override {
    StateFilter::ResetChecked(channel);
    counts_[channel] = 0;
    filling_ = slots_;
  }
  void StartChecked(std::span<const double> values) noexcept override {
    StateFilter::StartChecked(values);
    std::fill(counts_.begin(), counts_.end(), 1);
    filling_ = slots_;
  }
  bool SwapChecked(Filter& from) noexcept override {
    auto* other = dynamic_cast<FixedLagFilter*>(&from);
    if (other == nullptr || other->slots_ != slots_) return false;
    filter_.Copy(other->filter_, 0, kR);
    std::swap(history_, other->history_);
    std::swap(newest_, other->newest_);
    std::swap(counts_, other->counts_);
    std::swap(filling_, other->filling_);
    SwapFresh(*other);
    return true;
  }

  void StepAll(std::span<const double> input, std::span<double> output) noexcept override {
    const int n = channel_count();
    newest_ = newest_ + 1 == slots_ ? 0 : newest_ + 1;
    OpenSlot(filter_[kX], filter_[kW], filter_[kP11], filter_[kP12], filter_[kP22], filter_[kQ],
             factors_, Estimate(newest_), C1(newest_), C2(newest_), n);
    ScaleInnovation(Estimate(newest_), C1(newest_), filter_[kR], input.data(), innovation_[0], n);
    StepCovariance2(filter_, factors_);
    UpdateSlots(history_[0], history_[1] - history_[0], slots_, innovation_[0], filter_[kK1],
                filter_[kK2], n);
    StepStates2({.x = filter_[kX], .w = filter_[kW], .k1 = filter_[kK1], .k2 = filter_[kK2]},
                input.data(), output.data(), n);
  }

  double* Estimate(int slot) noexcept { return history_[3 * slot]; }
  double* C1(int slot) noexcept { return history_[3 * slot + 1]; }
  double* C2(int slot) noexcept { return history_[3 * slot + 2]; }
  int SlotOf(int age) const noexcept {
    const int slot = newest_ - age;
    return slot < 0 ? slot + slots_ : slot;
  }

  /// No history but this sample.
  void SetState(int channel, double position) noexcept override {
    for (int array = 0; array < kR; ++array) filter_[array][channel] = 0.0;
    filter_[kX][channel] = position;
    filter_[kP11][channel] = 1.0;
    filter_[kP22][channel] = 1.0;
    for (int part = 0; part < 3 * slots_; ++part) history_[part][channel] = 0.0;
    Estimate(newest_)[channel] = position;
    C1(newest_)[channel] = 1.0;  // [P_11 P_12] A' = [1 0]
  }

  void Deliver(std::span<double> output) noexcept {
    if (filling_ == 0) {
      std::copy_n(Estimate(SlotOf(slots_ - 1)), channel_count(), output.begin());
      return;
    }
    --filling_;
    for (int i = 0; i < channel_count(); ++i) {
      int& count = counts_[i];
      if (count < slots_) ++count;
      output[i] = Estimate(SlotOf(count - 1))[i];
    }
  }

  int slots_;
  ProcessNoiseFactors factors_;
  ChannelArrays filter_;
  ChannelArrays history_;  // per slot: estimate, c_1, c_2; the oldest slot is opened again
  ChannelArrays innovation_;
  std::vector<int> counts_;  // samples of each channel in the history
  int filling_ = 0;          // steps until all of them have a full one
  int newest_ = 0;
};

}  // namespace

void FixedLagConfig::Visit(SettingsVisitor& visitor) {
  VisitStart(visitor, start);
  noise.Visit(visitor);
  visitor.Integer({"lag", "delay of the estimate in samples", 0, 1000}, lag);
}

std::unique_ptr<Filter> MakeFilter(const FixedLagConfig& config, int channel_count,
                                   double rate_hz) {
  CheckFilter(config, channel_count, rate_hz);
  return std::make_unique<FixedLagFilter>(config, channel_count, rate_hz);
}

}  // namespace gauntlet::controller
