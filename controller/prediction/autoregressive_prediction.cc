#include "controller/prediction/autoregressive_prediction.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "controller/angle.h"
#include "controller/filters/channel_arrays.h"
#include "controller/filters/check_filter.h"
#include "controller/filters/state_filter.h"
#include "controller/filters/subnormal.h"
#include "controller/filters/vectorise.h"
#include "controller/prediction/history.h"
#include "controller/prediction/horizon.h"
#include "controller/prediction/predictor.h"

namespace gauntlet::controller {
namespace {

/// As if one sample had already moved by so much: what is learned has to be larger.
constexpr double kFirstMotionDeg = 5.0;
/// No joint moves further: nothing is learned from a glove that says so.
constexpr double kMostMotionRad = std::numbers::pi;

/// Learned values of every channel, and memory of one step of learning.
struct Learned {
  Learned(int taps, int channel_count)
      : order(taps),
        weight(taps, channel_count),
        p(taps * (taps + 1) / 2, channel_count),
        past(taps, channel_count),
        gain(taps, channel_count),
        then(1, channel_count),
        off(1, channel_count),
        size(1, channel_count),
        trace(1, channel_count),
        scale(1, channel_count),
        grow(1, channel_count) {}

  /// Rows of P below each other, each up to the diagonal: P is symmetric.
  static int Place(int row, int column) { return row * (row + 1) / 2 + column; }
  /// column <= row
  double* P(int row, int column) noexcept { return p[Place(row, column)]; }

  int order;
  ChannelArrays weight;  // w
  ChannelArrays p;
  ChannelArrays past;   // p of the header: how far s was from where it is
  ChannelArrays gain;   // P p
  ChannelArrays then;   // s
  ChannelArrays off;    // z - s - w p
  ChannelArrays size;   // p' P p; below 0 or NaN: rounding has spoilt P
  ChannelArrays trace;  // of P
  ChannelArrays scale;  // 1 / (f + p' P p), or 0 where nothing is learned
  ChannelArrays grow;   // 1 / f
};

struct LearningRule {
  double forget;  // f
  double leash_rad;
  double first_p;  // P begins as so many times I [1/rad^2]
};

/// past = s - past, held to what a joint can do. `from` is s.
GAUNTLET_VECTORISED void TakeMotion(const double* from, Learned& learned) noexcept {
  for (int i = 0; i < learned.order; ++i) {
    double* past = learned.past[i];
    GAUNTLET_CHANNEL_LOOP
    for (int c = 0; c < learned.past.channel_count(); ++c) {
      const double motion = from[c] - past[c];
      past[c] = WithoutSubnormal(std::min(std::max(motion, -kMostMotionRad), kMostMotionRad));
    }
  }
}

/// ahead = w p
GAUNTLET_VECTORISED void LookAhead(Learned& learned, double* ahead) noexcept {
  const int channels = learned.past.channel_count();
  std::fill_n(ahead, channels, 0.0);
  for (int i = 0; i < learned.order; ++i) {
    const double* weight = learned.weight[i];
    const double* past = learned.past[i];
    GAUNTLET_CHANNEL_LOOP
    for (int c = 0; c < channels; ++c) ahead[c] += weight[c] * past[c];
  }
}

/// Four channels of an array, from `channel` on: sums over them stay in a register.
using Lanes [[gnu::may_alias, gnu::vector_size(4 * sizeof(double))]] = double;
constexpr int kLanes = 4;
static_assert(ChannelArrays::kLineValues % kLanes == 0);
inline Lanes& LanesAt(double* array, int channel) {
  return *reinterpret_cast<Lanes*>(array + channel);
}

inline void ClearSubnormals(Lanes& lanes) {
  lanes = ((lanes < kLeastValue) & (lanes > -kLeastValue)) ? Lanes{} : lanes;
}

/// gain = P p, size = p' P p, trace of P.
GAUNTLET_VECTORISED void TakeGain(Learned& learned) noexcept {
  for (int c = 0; c < learned.past.channel_count(); c += kLanes) {
    Lanes size = {};
    Lanes trace = {};
    for (int i = 0; i < learned.order; ++i) {
      Lanes sum = {};
      int place = learned.Place(i, 0);
      for (int j = 0; j < learned.order; ++j) {
        sum += LanesAt(learned.p[place], c) * LanesAt(learned.past[j], c);
        place += j < i ? 1 : j + 1;  // along the row to the diagonal, then down the column
      }
      LanesAt(learned.gain[i], c) = sum;
      size += LanesAt(learned.past[i], c) * sum;
      trace += LanesAt(learned.P(i, i), c);
    }
    LanesAt(learned.size[0], c) = size;
    LanesAt(learned.trace[0], c) = trace;
  }
}

/// Which channels learn, and how much: not from a motion that no joint makes, and not by a P that
/// rounding has spoilt. A sample further off than the leash teaches no more than one at its end.
GAUNTLET_VECTORISED void TakeScale(const LearningRule& rule, const double* measured,
                                   Learned& learned) noexcept {
  const int channels = learned.past.channel_count();
  const double* then = learned.then[0];
  const double* size = learned.size[0];
  const double* trace = learned.trace[0];
  double* off = learned.off[0];
  double* scale = learned.scale[0];
  double* grow = learned.grow[0];
  std::fill_n(scale, channels, 1.0);
  for (int i = 0; i < learned.order; ++i) {
    const double* past = learned.past[i];
    GAUNTLET_CHANNEL_LOOP
    for (int c = 0; c < channels; ++c) {
      scale[c] = std::abs(past[c]) < kMostMotionRad ? scale[c] : 0.0;
    }
  }
  LookAhead(learned, off);
  const double most_trace = learned.order * rule.first_p * rule.forget;
  const double grown = 1.0 / rule.forget;
  GAUNTLET_CHANNEL_LOOP
  for (int c = 0; c < channels; ++c) {
    const double error = measured[c] - (then[c] + off[c]);
    off[c] = std::min(std::max(error, -rule.leash_rad), rule.leash_rad);
    const bool forgets = trace[c] < most_trace;
    scale[c] = size[c] >= 0.0 ? scale[c] / ((forgets ? rule.forget : 1.0) + size[c]) : 0.0;
    grow[c] = scale[c] > 0.0 && forgets ? grown : 1.0;
  }
}

/// w += g off, P = (P - g p' P) / f; a scale of 0 leaves them as they are.
GAUNTLET_VECTORISED void TakeStep(Learned& learned) noexcept {
  for (int c = 0; c < learned.past.channel_count(); c += kLanes) {
    const Lanes off = LanesAt(learned.off[0], c);
    const Lanes scale = LanesAt(learned.scale[0], c);
    const Lanes grow = LanesAt(learned.grow[0], c);
    for (int i = 0; i < learned.order; ++i) {
      const Lanes step = scale > 0.0 ? scale * LanesAt(learned.gain[i], c) : Lanes{};
      Lanes& weight = LanesAt(learned.weight[i], c);
      weight += step * off;
      ClearSubnormals(weight);
      for (int j = 0; j <= i; ++j) {
        Lanes& p = LanesAt(learned.P(i, j), c);
        p = (p - step * LanesAt(learned.gain[j], c)) * grow;
        ClearSubnormals(p);
      }
    }
  }
}

/// s += share (measured - s); measured is cleaned of subnormals.
GAUNTLET_VECTORISED void Smooth(double share, const double* input, double* measured, double* s,
                                int channels) noexcept {
  GAUNTLET_CHANNEL_LOOP
  for (int c = 0; c < channels; ++c) {
    measured[c] = WithoutSubnormal(input[c]);
    s[c] = WithoutSubnormal(s[c] + share * (measured[c] - s[c]));
  }
}

/// output = s + ahead, within the leash of s.
GAUNTLET_VECTORISED void StayNear(const double* s, double leash_rad, double* ahead, double* output,
                                  int channels) noexcept {
  GAUNTLET_CHANNEL_LOOP
  for (int c = 0; c < channels; ++c) {
    output[c] = std::min(std::max(s[c] + ahead[c], s[c] - leash_rad), s[c] + leash_rad);
  }
}

class AutoregressivePredictor final : public StateFilter<Filter> {
 public:
  AutoregressivePredictor(const AutoregressivePredictionConfig& config,
                          const Eigen::ArrayXd& horizon_steps, int tap_steps, double rate_hz)
      : StateFilter(Start::kFirst, horizon_steps.size()),
        tap_steps_(tap_steps),
        smooth_(-std::expm1(-1e3 / (config.smoothing_ms * rate_hz))),
        rule_{.forget = std::exp(-1e3 / (config.memory_ms * rate_hz)),
              .leash_rad = config.leash_deg * kRadPerDeg,
              .first_p = 1.0 / std::pow(kFirstMotionDeg * kRadPerDeg, 2)},
        delay_(horizon_steps.size()),
        measured_(1, channel_count()),
        smoothed_(1, channel_count()),
        learned_(config.order, channel_count()),
        history_(MostSteps(horizon_steps) + config.order * tap_steps + 1, channel_count()) {
    for (int i = 0; i < channel_count(); ++i) delay_[i] = Steps(horizon_steps[i]);
    one_delay_ = std::ranges::count(delay_, delay_[0]) == channel_count();
    Reset();
  }

 private:
  static int Steps(double steps) { return std::max(1, static_cast<int>(std::lround(steps))); }
  static int MostSteps(const Eigen::ArrayXd& steps) { return Steps(steps.maxCoeff()); }

  void ForgetCovariance(int channel) noexcept {
    for (int i = 0; i < learned_.order; ++i) {
      for (int j = 0; j <= i; ++j) learned_.P(i, j)[channel] = i == j ? rule_.first_p : 0.0;
    }
  }
  /// Takes the motion that was known when the present sample was to be predicted.
  void TakeThen() noexcept {
    if (one_delay_) return TakeAt(delay_[0], learned_.then[0]);
    for (int c = 0; c < channel_count(); ++c) {
      learned_.then[0][c] = history_.Row(delay_[c])[c];
      for (int i = 0; i < learned_.order; ++i) {
        learned_.past[i][c] = history_.Row(delay_[c] + (i + 1) * tap_steps_)[c];
      }
    }
    TakeMotion(learned_.then[0], learned_);
  }
  void TakeAt(int age, double* s) noexcept {
    std::copy_n(history_.Row(age), channel_count(), s);
    for (int i = 0; i < learned_.order; ++i) {
      std::copy_n(history_.Row(age + (i + 1) * tap_steps_), channel_count(), learned_.past[i]);
    }
    TakeMotion(s, learned_);
  }

  void StepAll(std::span<const double> input, std::span<double> output) noexcept override {
    double* s = smoothed_[0];
    Smooth(smooth_, input.data(), measured_[0], s, channel_count());
    std::copy_n(s, channel_count(), history_.Push());
    TakeThen();
    TakeGain(learned_);
    TakeScale(rule_, measured_[0], learned_);
    TakeStep(learned_);
    for (int c = 0; c < channel_count(); ++c) {
      if (!(learned_.size[0][c] >= 0.0)) ForgetCovariance(c);
    }
    TakeAt(0, s);
    LookAhead(learned_, learned_.off[0]);
    StayNear(s, rule_.leash_rad, learned_.off[0], output.data(), channel_count());
  }
  void SetState(int channel, double position) noexcept override {
    const double settled = WithoutSubnormal(position);
    smoothed_[0][channel] = settled;
    history_.Fill(channel, settled);
    for (int i = 0; i < learned_.order; ++i) learned_.weight[i][channel] = 0.0;
    ForgetCovariance(channel);
  }
  bool TakeChecked(Filter& from) noexcept override {
    auto* other = dynamic_cast<AutoregressivePredictor*>(&from);
    const bool fits = other != nullptr && other->delay_ == delay_ &&
                      other->learned_.order == learned_.order && other->tap_steps_ == tap_steps_;
    if (!fits) return false;
    std::swap(smoothed_, other->smoothed_);
    std::swap(learned_, other->learned_);
    std::swap(history_, other->history_);
    TakeFresh(*other);
    return true;
  }

  int tap_steps_;
  double smooth_;  // share of the newest sample
  LearningRule rule_;
  std::vector<int> delay_;
  bool one_delay_;          // for all channels
  ChannelArrays measured_;  // z
  ChannelArrays smoothed_;  // s
  Learned learned_;
  History history_;  // of s
};

}  // namespace

void AutoregressivePredictionConfig::Visit(SettingsVisitor& visitor) {
  VisitHorizon(visitor, horizon_ms);
  visitor.Integer({"order", "how many samples of the past", 1, 20}, order);
  visitor.Number({"tap_ms", "how far they lie apart", 0.1, 1000}, tap_ms);
  visitor.Number(
      {"smoothing_ms", "time constant of the smoothing of what it learns from", 0.1, 1e4},
      smoothing_ms);
  visitor.Number({"memory_ms", "how long a sample is remembered", 10, 1e7}, memory_ms);
  visitor.Number({"leash_deg", "how far ahead of the smoothed angle it may look", 0, 360},
                 leash_deg);
}

std::unique_ptr<Filter> MakePredictor(const AutoregressivePredictionConfig& config,
                                      int channel_count, double rate_hz) {
  CheckFilter(config, channel_count, rate_hz);
  const int tap_steps = static_cast<int>(std::lround(config.tap_ms * 1e-3 * rate_hz));
  if (tap_steps < 1) {
    throw SettingError("tap_ms", "is " + NumberText(config.tap_ms) +
                                     ", must be at least a step of the filter, " +
                                     NumberText(1e3 / rate_hz) + " ms");
  }
  return std::make_unique<AutoregressivePredictor>(
      config, HorizonSteps(config.horizon_ms, channel_count, rate_hz), tap_steps, rate_hz);
}

}  // namespace gauntlet::controller
