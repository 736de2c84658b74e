#include "controller/prediction/fallback.h"

#include <Eigen/Core>
#include <algorithm>
#include <utility>
#include <vector>

#include "controller/filters/channel_arrays.h"
#include "controller/filters/state_filter.h"
#include "controller/filters/subnormal.h"
#include "controller/filters/vectorise.h"
#include "controller/prediction/adaptive_bank.h"
#include "controller/prediction/history.h"
#include "controller/prediction/horizon.h"
#include "controller/prediction/predictor.h"

namespace gauntlet::controller {
namespace {

/// `miss` with the newest error of what was expected.
GAUNTLET_VECTORISED void AddMiss(const double* measured, const double* was_expected,
                                 const double* inverse_r, double forget, double* miss,
                                 int channel_count) {
  GAUNTLET_CHANNEL_LOOP
  for (int i = 0; i < channel_count; ++i) {
    const double off = WithoutSubnormal(measured[i]) - was_expected[i];
    const double square = off * off * inverse_r[i];
    const double large = square > AdaptiveBank::kLeastMiss ? square : AdaptiveBank::kLeastMiss;
    const double bounded = large < AdaptiveBank::kMostMiss ? large : AdaptiveBank::kMostMiss;
    miss[i] += forget * (bounded - miss[i]);
  }
}

GAUNTLET_VECTORISED void Mix(const double* fitted, const double* general, const double* fitted_miss,
                             const double* general_miss, const double* most, double* output,
                             int channel_count) {
  GAUNTLET_CHANNEL_LOOP
  for (int i = 0; i < channel_count; ++i) {
    const double ratio = fitted_miss[i] / general_miss[i];
    const double cube = ratio * ratio * ratio;  // s_g / s_f
    output[i] = fitted[i] + most[i] * (cube / (1.0 + cube)) * (general[i] - fitted[i]);
  }
}

class FallbackPredictor final : public StateFilter<Filter> {
 public:
  FallbackPredictor(std::unique_ptr<Filter> fitted, std::unique_ptr<Filter> general,
                    const AdaptiveBank& bank, const Eigen::ArrayXd& horizon_steps)
      : StateFilter(Start::kFirst, bank.channel_count()),
        delay_(bank.delay_steps),
        forget_(bank.forget),
        members_{std::move(fitted), std::move(general)},
        expected_(bank.kept_steps(), kMembers * channel_count()),
        arrays_(kArrays, channel_count()) {
    std::ranges::copy(bank.inverse_r, arrays_[kInverseR]);
    for (int i = 0; i < channel_count(); ++i) {
      arrays_[kMostGeneral][i] = horizon_steps[i] > 0.0 ? 1.0 : 0.0;
    }
    Reset();
  }

 private:
  static constexpr int kMembers = 2;
  enum {
    kMiss,
    kWasExpected = kMiss + kMembers,
    kInverseR = kWasExpected + kMembers,
    kMostGeneral,
    kArrays
  };

  void StepAll(std::span<const double> input, std::span<double> output) noexcept override {
    const int n = channel_count();
    for (int i = 0; i < n; ++i) {
      const double* then = expected_.Row(delay_[static_cast<std::size_t>(i)] - 1) + i;
      for (int m = 0; m < kMembers; ++m) arrays_[kWasExpected + m][i] = then[m * n];
    }
    double* expected = expected_.Push();
    for (int m = 0; m < kMembers; ++m) {
      AddMiss(input.data(), arrays_[kWasExpected + m], arrays_[kInverseR], forget_,
              arrays_[kMiss + m], n);
      members_[m]->Step(input, {expected + m * n, input.size()});
    }
    Mix(expected, expected + n, arrays_[kMiss], arrays_[kMiss + 1], arrays_[kMostGeneral],
        output.data(), n);
  }
  /// Before its start a channel was where it starts, and both expected it.
  void SetState(int channel, double position) noexcept override {
    for (int m = 0; m < kMembers; ++m) {
      expected_.Fill(m * channel_count() + channel, WithoutSubnormal(position));
      arrays_[kMiss + m][channel] = 1.0;
    }
  }
  void ResetChecked(int channel) noexcept override {
    StateFilter::ResetChecked(channel);
    for (const auto& member : members_) member->ResetChannel(channel);
  }
  void StartChecked(std::span<const double> values) noexcept override {
    StateFilter::StartChecked(values);
    for (const auto& member : members_) member->StartAt(values);
  }
  bool SwapChecked(Filter& from) noexcept override {
    auto* other = dynamic_cast<FallbackPredictor*>(&from);
    if (other == nullptr || other->delay_ != delay_ ||
        !members_[0]->SwapMemory(*other->members_[0])) {
      return false;
    }
    members_[1]->SwapMemory(*other->members_[1]);  // has the same delays, which is all it needs
    std::swap(expected_, other->expected_);
    arrays_.Copy(other->arrays_, kMiss, kMiss + kMembers);
    SwapFresh(*other);
    return true;
  }

  std::vector<int> delay_;  // per channel, in steps
  double forget_;
  std::unique_ptr<Filter> members_[kMembers];  // fitted, general
  History expected_;                           // what each expected of each channel
  ChannelArrays arrays_;
};

}  // namespace

std::unique_ptr<Filter> WithFallback(std::unique_ptr<Filter> fitted,
                                     const AdaptivePredictionConfig& general, double rate_hz) {
  const int channels = fitted->channel_count();
  return std::make_unique<FallbackPredictor>(
      std::move(fitted), MakePredictor(general, channels, rate_hz),
      BankOf(general, channels, rate_hz, 0), HorizonSteps(general.horizon_ms, channels, rate_hz));
}

}  // namespace gauntlet::controller
