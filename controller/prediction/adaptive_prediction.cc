#include "controller/prediction/adaptive_prediction.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "controller/angle.h"
#include "controller/filters/channel_arrays.h"
#include "controller/filters/check_filter.h"
#include "controller/filters/state_filter.h"
#include "controller/filters/subnormal.h"
#include "controller/filters/vectorise.h"
#include "controller/prediction/adaptive_bank.h"
#include "controller/prediction/history.h"
#include "controller/prediction/horizon.h"
#include "controller/prediction/measurement_noise.h"
#include "controller/prediction/motion_model.h"
#include "controller/prediction/predictor.h"

namespace gauntlet::controller {
namespace {

constexpr double kDamping = 0.03;
constexpr double kLeastMiss = AdaptiveBank::kLeastMiss;
constexpr double kMostMiss = AdaptiveBank::kMostMiss;
constexpr int kExperts = std::size(kPredictionBank);

struct Expert {
  MotionModel model;
  bool looks_ahead = true;
};

std::array<Expert, kExperts> Experts() {
  return {{{WhiteAcceleration(1e3), false},
           {WhiteJerk(1e6)},
           {Swing(0.5, kDamping, 1e6, 10.0)},
           {Swing(1.0, kDamping, 1e6, 10.0)},
           {Swing(2.0, kDamping, 1e6, 100.0)},
           {Swing(3.0, kDamping, 1e5, 300.0)}}};
}

/// Values of one filter of the bank per channel of the first row: its state and its gain.
enum FilterValue { kX0, kX1, kX2, kGain0, kGain1, kGain2, kFilterValues };
struct FilterArrays {
  double *x0, *x1, *x2;
  const double *k0, *k1, *k2;
};

/// And per channel of every row: its mean square miss, and how it looks ahead.
enum RowValue { kMiss, kAhead0, kAhead1, kAhead2, kRowValues };
struct RowArrays {
  double* miss;
  const double *c0, *c1, *c2;
  const double* was_expected;
  const double* inverse_r;
  double *expected, *sum, *shares;
};

/// A is the same for all channels.
struct Transition {
  double a00, a01, a02, a10, a11, a12, a20, a21, a22;
  double h0, h1;  // no model has its third state in the angle
};

/// Expected value of a filter at this state, as far ahead as place `j` of the rows looks, and its
/// share of the mixture.
inline void Look(const RowArrays& row, int j, double forget, double measured, double x0, double x1,
                 double x2) {
  const double off = measured - row.was_expected[j];
  const double square = off * off * row.inverse_r[j];
  const double large = square > kLeastMiss ? square : kLeastMiss;
  const double bounded = large < kMostMiss ? large : kMostMiss;
  const double miss = row.miss[j] + forget * (bounded - row.miss[j]);
  const double share = 1.0 / (miss * miss * miss);
  const double y = row.c0[j] * x0 + row.c1[j] * x1 + row.c2[j] * x2;
  row.miss[j] = miss;
  row.expected[j] = y;
  row.sum[j] += share * y;
  row.shares[j] += share;
}

/// One step of one filter of the bank, and what the rows make of it.
GAUNTLET_VECTORISED void StepFilter(FilterArrays s, Transition t, RowArrays row, double forget,
                                    const double* z, int channel_count, int rows) {
  GAUNTLET_CHANNEL_LOOP
  for (int i = 0; i < channel_count; ++i) {
    const double measured = WithoutSubnormal(z[i]);
    // x^- = A x,  x = x^- + K (z - H x^-)
    const double x0_prior = t.a00 * s.x0[i] + t.a01 * s.x1[i] + t.a02 * s.x2[i];
    const double x1_prior = t.a10 * s.x0[i] + t.a11 * s.x1[i] + t.a12 * s.x2[i];
    const double x2_prior = t.a20 * s.x0[i] + t.a21 * s.x1[i] + t.a22 * s.x2[i];
    const double innovation = measured - (t.h0 * x0_prior + t.h1 * x1_prior);
    const double x0 = WithoutSubnormal(x0_prior + s.k0[i] * innovation);
    const double x1 = WithoutSubnormal(x1_prior + s.k1[i] * innovation);
    const double x2 = WithoutSubnormal(x2_prior + s.k2[i] * innovation);
    Look(row, i, forget, measured, x0, x1, x2);
    s.x0[i] = x0;
    s.x1[i] = x1;
    s.x2[i] = x2;
  }
  for (int r = 1; r < rows; ++r) {
    const int first = r * channel_count;
    GAUNTLET_CHANNEL_LOOP
    for (int i = 0; i < channel_count; ++i) {
      Look(row, first + i, forget, WithoutSubnormal(z[i]), s.x0[i], s.x1[i], s.x2[i]);
    }
  }
}

GAUNTLET_VECTORISED void DivideByShares(const double* sum, const double* shares, double* output,
                                        int channel_count) {
  GAUNTLET_CHANNEL_LOOP
  for (int i = 0; i < channel_count; ++i) output[i] = sum[i] / shares[i];
}

class AdaptivePredictor final : public StateFilter<Filter> {
 public:
  AdaptivePredictor(const AdaptiveBank& bank, int rows)
      : StateFilter(Start::kFirst, bank.channel_count()),
        rows_(rows),
        row_length_(channel_count() / rows),
        forget_(bank.forget),
        delay_(bank.delay_steps),
        old_steps_(bank.kept_steps()),
        history_(old_steps_, kExperts * channel_count()),
        start_(delay_.size()),
        age_(delay_.size()),
        filters_(kExperts * kFilterValues, row_length_),
        row_values_(kExperts * kRowValues, channel_count()),
        scratch_(kScratchArrays, channel_count()) {
    std::ranges::copy(bank.inverse_r, scratch_[kInverseR]);
    for (int m = 0; m < kExperts; ++m) {
      const AdaptiveBank::Member& member = bank.members[static_cast<std::size_t>(m)];
      SetTransition(m, member.transition, member.angle_of_state);
      for (int state = 0; state < 3; ++state) {
        for (int i = 0; i < row_length_; ++i) {
          OfFilter(m, kGain0 + state)[i] = member.gain(state, i);
        }
        for (int i = 0; i < channel_count(); ++i) {
          OfRows(m, kAhead0 + state)[i] = member.look_ahead(state, i);
        }
      }
    }
    Reset();
  }

 private:
  enum Scratch { kSum, kShares, kInverseR, kWasExpected, kScratchArrays = kWasExpected + kExperts };

  double* OfFilter(int m, int array) noexcept { return filters_[m * kFilterValues + array]; }
  double* OfRows(int m, int array) noexcept { return row_values_[m * kRowValues + array]; }

  void SetTransition(int m, const Eigen::Matrix3d& a, const Eigen::RowVector3d& h) {
    transitions_[m] = {a(0, 0), a(0, 1), a(0, 2), a(1, 0), a(1, 1), a(1, 2),
                       a(2, 0), a(2, 1), a(2, 2), h[0],    h[1]};
  }

  /// Values that were expected of now. Before its start a channel was where it starts; this is not
  /// in the history, which would take up to a millisecond to fill.
  void LookBack() noexcept {
    const int n = channel_count();
    const bool some_are_young = young_steps_ > 0;
    if (some_are_young) {
      --young_steps_;
      for (int& age : age_) age = std::min(age + 1, old_steps_);
    }
    for (int i = 0; i < n; ++i) {
      const double* then = history_.Row(delay_[i]) + i;
      const bool before_start = some_are_young && age_[i] <= delay_[i];
      for (int m = 0; m < kExperts; ++m) {
        scratch_[kWasExpected + m][i] = before_start ? start_[i] : then[m * n];
      }
    }
  }

  void StepAll(std::span<const double> input, std::span<double> output) noexcept override {
    const int n = channel_count();
    double* expected = history_.Push();
    double* sum = scratch_[kSum];
    double* shares = scratch_[kShares];
    std::fill_n(sum, n, 0.0);
    std::fill_n(shares, n, 0.0);
    LookBack();
    for (int m = 0; m < kExperts; ++m) {
      const FilterArrays filter = {OfFilter(m, kX0),    OfFilter(m, kX1),    OfFilter(m, kX2),
                                   OfFilter(m, kGain0), OfFilter(m, kGain1), OfFilter(m, kGain2)};
      const RowArrays rows = {OfRows(m, kMiss),
                              OfRows(m, kAhead0),
                              OfRows(m, kAhead1),
                              OfRows(m, kAhead2),
                              scratch_[kWasExpected + m],
                              scratch_[kInverseR],
                              expected + m * n,
                              sum,
                              shares};
      StepFilter(filter, transitions_[m], rows, forget_, input.data(), row_length_, rows_);
    }
    DivideByShares(sum, shares, output.data(), n);
  }
  void SetState(int channel, double position) noexcept override {
    const double settled = WithoutSubnormal(position);
    for (int m = 0; m < kExperts; ++m) {
      OfFilter(m, kX0)[channel % row_length_] = settled;
      OfFilter(m, kX1)[channel % row_length_] = 0.0;
      OfFilter(m, kX2)[channel % row_length_] = 0.0;
      OfRows(m, kMiss)[channel] = 1.0;
    }
    start_[channel] = settled;
    age_[channel] = 0;
    young_steps_ = old_steps_;
  }
  bool SwapChecked(Filter& from) noexcept override {
    auto* other = dynamic_cast<AdaptivePredictor*>(&from);
    if (other == nullptr || other->delay_ != delay_ || other->rows_ != rows_) return false;
    for (int m = 0; m < kExperts; ++m) {
      filters_.Copy(other->filters_, m * kFilterValues, m * kFilterValues + kGain0);
      row_values_.Copy(other->row_values_, m * kRowValues, m * kRowValues + kAhead0);
    }
    std::swap(history_, other->history_);
    start_.swap(other->start_);
    age_.swap(other->age_);
    std::swap(young_steps_, other->young_steps_);
    SwapFresh(*other);
    return true;
  }

  int rows_;
  int row_length_;
  double forget_;
  std::vector<int> delay_;     // per channel, in steps
  int old_steps_;              // more than all delays
  History history_;            // what each filter expected of each channel
  std::vector<double> start_;  // per channel, its first value
  std::vector<int> age_;       // and its steps since then, up to old_steps_
  int young_steps_ = 0;        // until all channels are that old
  std::array<Transition, kExperts> transitions_{};
  ChannelArrays filters_;
  ChannelArrays row_values_;
  ChannelArrays scratch_;
};

}  // namespace

void AdaptivePredictionConfig::Visit(SettingsVisitor& visitor) {
  VisitHorizon(visitor, horizon_ms);
  VisitMeasurementNoise(visitor, r_deg2);
  visitor.Number({"memory_ms", "how long a miss is remembered", 1, 1e5}, memory_ms);
}

int AdaptiveBank::kept_steps() const { return 1 + std::ranges::max(delay_steps); }

AdaptiveBank BankOf(const AdaptivePredictionConfig& config, int channel_count, double rate_hz,
                    int settled_channels) {
  CheckFilter(config, channel_count, rate_hz);
  const Eigen::ArrayXd horizon_steps = HorizonSteps(config.horizon_ms, channel_count, rate_hz);
  const Eigen::ArrayXd r_deg2 = PerChannel("r_deg2", config.r_deg2, channel_count);
  const double memory_steps = config.memory_ms * 1e-3 * rate_hz;
  AdaptiveBank bank;
  bank.forget = -std::expm1(-1.0 / memory_steps);
  for (int i = 0; i < channel_count; ++i) {
    bank.delay_steps.push_back(std::max(1, static_cast<int>(std::lround(horizon_steps[i]))));
    bank.inverse_r.push_back(1.0 / (kRadPerDeg * kRadPerDeg * r_deg2[i]));
  }
  const auto experts = Experts();
  for (std::size_t m = 0; m < experts.size(); ++m) {
    const auto& [model, looks_ahead] = experts[m];
    AdaptiveBank::Member& member = bank.members[m];
    member.angle_of_state = model.h;
    member.gain.resize(3, settled_channels);
    member.look_ahead.resize(3, channel_count);
    for (int i = 0; i < settled_channels; ++i) {
      if (i > 0 && r_deg2[i] == r_deg2[i - 1]) {
        member.gain.col(i) = member.gain.col(i - 1);
        continue;
      }
      const SettledFilter filter = Settle(model, r_deg2[i], 1.0 / rate_hz);
      member.transition = filter.a;
      member.gain.col(i) = filter.k.array();
    }
    for (int i = 0; i < channel_count; ++i) {
      member.look_ahead.col(i) =
          LookAhead(model, looks_ahead ? horizon_steps[i] / rate_hz : 0.0).transpose().array();
    }
  }
  return bank;
}

std::unique_ptr<Filter> MakePredictor(const AdaptivePredictionConfig& config, int channel_count,
                                      double rate_hz, int rows) {
  return std::make_unique<AdaptivePredictor>(
      BankOf(config, channel_count, rate_hz, channel_count / rows), rows);
}

}  // namespace gauntlet::controller
