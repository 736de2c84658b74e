#include "sim/calibrate/chain_fit.h"

#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <vector>

#include "controller/assert.h"
#include "sim/base/signal.h"
#include "sim/calibrate/least_squares.h"
#include "sim/score/delay.h"

namespace gauntlet::sim {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Beginning of the log that is not compared, because the state of the chain is unknown there.
constexpr double kBeginning_s = 0.5;
constexpr double kLeastDamping = 0.05;
constexpr double kLongestDelay_s = 2.0;
constexpr double kLead_s = 0.2;  // a lead up to this is told from a delay of a motion that repeats
/// Noise of a motor's angle that may appear as play, in standard deviations.
constexpr double kNoiseInLost = 3.0;

/// Indices of the parameters of a fit. The fit of the delay has the first three, the fit of lost
/// motion between two angles the first four, the fit of a chain without lost motion the first six.
enum Parameter { kDeadTime, kGain, kOffset, kPlay, kLag, kInertia, kLostPlay };
constexpr Index kShiftParameters = 3;
constexpr Index kPlayParameters = 4;
constexpr Index kTightParameters = 6;
constexpr Index kLooseParameters = 7;

ChainModel ModelOf(const VectorXd& parameters) {
  ChainModel model{.dead_time_s = parameters[kDeadTime],
                   .gain = parameters[kGain],
                   .offset_deg = parameters[kOffset]};
  if (parameters.size() == kShiftParameters) return model;
  model.play_deg = parameters[kPlay];
  if (parameters.size() == kPlayParameters) return model;
  model.lag_s = parameters[kLag];
  model.inertia_s2 = parameters[kInertia];
  if (parameters.size() == kTightParameters) return model;
  model.lost_play_deg = parameters[kLostPlay];
  return model;
}

double Rms(const VectorXd& values) {
  return std::sqrt(values.squaredNorm() / static_cast<double>(values.size()));
}

/// Least-squares problem for one log: the model's parameters with bounds and steps for derivatives.
/// The offset needs no step.
class Problem : public LeastSquaresProblem {
 public:
  Problem(std::span<const double> command_deg, std::span<const double> angle_deg, double rate_hz,
          Index parameters, const std::optional<FrameClock>& frames = {},
          double beginning_s = kBeginning_s)
      : command_(RefineCommand(command_deg, rate_hz, frames)),
        first_(std::lround(beginning_s * rate_hz)),
        angle_deg_(
            Eigen::Map<const VectorXd>(angle_deg.data() + first_, std::ssize(angle_deg) - first_)),
        simulated_deg_(command_deg.size()),
        low_(parameters),
        high_(parameters),
        step_(parameters) {
    const double period_s = 1.0 / rate_hz;
    const auto [least, most] = std::ranges::minmax(command_deg);
    const double travel_deg = most - least;
    // A command in steps, such as command frames, needs a wide difference quotient. For a smooth
    // command with lost motion a wide one is too flat, because of the corners of the angle.
    constexpr double kWide_s = 0.01;
    constexpr double kNarrow_s = 0.001;
    const bool narrow = parameters == kLooseParameters && command_.smooth;
    Bound(kDeadTime, 0.0, kLongestDelay_s, narrow ? kNarrow_s : kWide_s);
    Bound(kGain, 0.01, 100.0, 1e-4);
    Bound(kOffset, -1e4, 1e4);
    if (parameters == kShiftParameters) return;
    // With two plays the sum of squares is rough. A step smaller than the row distance would give
    // the slope of the noise.
    const double play_step_deg = (parameters == kLooseParameters ? 2e-3 : 1e-4) * travel_deg;
    Bound(kPlay, 0.0, travel_deg, play_step_deg);
    if (parameters == kPlayParameters) return;
    Bound(kLag, 0.0, kLongestDelay_s, 1e-4);
    Bound(kInertia, std::pow(0.25 * period_s, 2), 1.0, 1e-6);
    if (parameters == kTightParameters) return;
    Bound(kLostPlay, 0.0, travel_deg, play_step_deg);
    exchange_deg_ = 5e-3 * travel_deg;
  }

  Index parameters() const { return low_.size(); }
  Index rows() const { return angle_deg_.size(); }

  VectorXd Residual(const VectorXd& parameters) override {
    SimulateChain(ModelOf(parameters), command_, simulated_deg_);
    return angle_deg_ - Eigen::Map<const VectorXd>(simulated_deg_.data() + first_, rows());
  }

  /// Derivative of the model's angle for each parameter, one-sided at a bound.
  MatrixXd Derivatives(const VectorXd& parameters) override {
    MatrixXd result(rows(), this->parameters());
    const bool loose = this->parameters() == kLooseParameters;
    const Index by_themselves = loose ? Index{kLostPlay} : this->parameters();
    for (Index i = 0; i < by_themselves; ++i) {
      if (i == kOffset) {
        result.col(i).setOnes();
        continue;
      }
      VectorXd below = parameters;
      VectorXd above = parameters;
      below[i] = std::max(below[i] - step_[i], low_[i]);
      above[i] = std::min(above[i] + step_[i], high_[i]);
      result.col(i) = (Residual(below) - Residual(above)) / (above[i] - below[i]);
    }
    if (loose) result.col(kLostPlay) = result.col(kPlay) + DerivativeOfExchange(parameters);
    return result;
  }

  void KeepWithinBounds(VectorXd& parameters) const override {
    parameters = parameters.cwiseMax(low_).cwiseMin(high_);
    if (this->parameters() < kTightParameters) return;
    const double least_lag_s = 2.0 * kLeastDamping * std::sqrt(parameters[kInertia]);
    parameters[kLag] = std::max(parameters[kLag], least_lag_s);
  }

 private:
  /// Derivative of the angle for play that is moved from before the lag to behind it. The sum of
  /// both plays stays the same. The two separate derivatives are rough, because they move all
  /// corners of the angle, and their difference would be mostly error. With a constant sum the
  /// corners stay, so a wider step is smooth.
  VectorXd DerivativeOfExchange(const VectorXd& parameters) {
    VectorXd below = parameters;
    VectorXd above = parameters;
    const double less = std::min(exchange_deg_, parameters[kLostPlay]);
    const double more = std::min(exchange_deg_, parameters[kPlay]);
    below[kLostPlay] -= less;
    below[kPlay] += less;
    above[kLostPlay] += more;
    above[kPlay] -= more;
    return (Residual(below) - Residual(above)) / std::max(less + more, 1e-9);
  }

  void Bound(Index parameter, double low, double high, double step = 0.0) {
    low_[parameter] = low;
    high_[parameter] = high;
    step_[parameter] = step;
  }

  FineCommand command_;
  Index first_;
  VectorXd angle_deg_;
  std::vector<double> simulated_deg_;
  double exchange_deg_ = 0.0;
  VectorXd low_;
  VectorXd high_;
  VectorXd step_;
};

/// `value_of` maps parameters to the value. The interval is cut off at `least`.
template <class ValueOf>
ChainEstimate EstimateOf(const LeastSquaresFit& solution, const std::vector<WithoutBlock>& without,
                         double least, const ValueOf& value_of) {
  const double value = value_of(solution.parameters);
  const double half_width = HalfWidthOf(StandardErrorOf(solution, without, value_of),
                                        DegreesOfFreedomOf(solution, without, value_of));
  return {value, std::max(least, value - half_width), value + half_width};
}

/// Image of an estimate under a monotonic function.
template <class Function>
ChainEstimate Through(const ChainEstimate& estimate, const Function& function) {
  const auto [low, high] = std::minmax({function(estimate.low), function(estimate.high)});
  return {function(estimate.value), low, high};
}

void KeepBetter(LeastSquaresFit solution, std::optional<LeastSquaresFit>& best) {
  if (!best || solution.squares < best->squares) best = std::move(solution);
}

/// A fit of all parameters, and the same fit without each of the blocks.
struct Split {
  LeastSquaresFit solution;
  std::vector<WithoutBlock> without;
  bool second_order = true;  // false: a first-order lag explains the log as well
};

/// None if the log does not distinguish the parameters.
std::optional<Split> SplitOf(const LeastSquaresFit& solution) {
  if (const auto without = WithoutEachBlock(solution)) return Split{solution, *without};
  if (const auto without = WithoutEachBlock(solution, kInertia)) {
    return Split{solution, *without, false};
  }
  return std::nullopt;
}

void TakeSplit(const Split& split, ChainFit& fit) {
  const LeastSquaresFit& solution = split.solution;
  const auto estimate = [&](const auto& value_of, double least) {
    return EstimateOf(solution, split.without, least, value_of);
  };
  const auto parameter = [&](Parameter index, double factor) {
    return estimate([index, factor](const VectorXd& p) { return factor * p[index]; }, 0.0);
  };
  fit.model = ModelOf(solution.parameters);
  fit.residual_rms_deg = Rms(solution.residual);
  fit.dead_time_ms = parameter(kDeadTime, 1e3);
  fit.lag_ms = parameter(kLag, 1e3);
  fit.gain = parameter(kGain, 1.0);
  fit.hysteresis_deg = parameter(kPlay, 2.0);
  if (solution.parameters.size() == kLooseParameters) {
    fit.motor_hysteresis_deg = fit.hysteresis_deg;
    fit.lost_motion_deg = parameter(kLostPlay, 2.0);
    fit.hysteresis_deg =
        estimate([](const VectorXd& p) { return 2.0 * (p[kPlay] + p[kLostPlay]); }, 0.0);
  }
  const ChainEstimate inertia_s2 = parameter(kInertia, 1.0);
  if (!split.second_order || !(inertia_s2.low > 0.0)) return;
  fit.natural_frequency_hz = Through(inertia_s2, [](double inertia) {
    return 1.0 / (2.0 * std::numbers::pi * std::sqrt(inertia));
  });
  // The logarithm of the damping ratio is closest to a normal distribution and always defined.
  const auto log_damping = [](const VectorXd& p) {
    return std::log(std::max(p[kLag], 1e-9) / (2.0 * std::sqrt(std::max(p[kInertia], 1e-12))));
  };
  fit.damping_ratio = Through(estimate(log_damping, -1e3), [](double l) { return std::exp(l); });
}

/// Widens the interval by the uncertainty of the times at which the frames were sent.
void WidenDeadTime(double open_ms, ChainEstimate& dead_time_ms) {
  dead_time_ms.low = std::max(dead_time_ms.low - open_ms, 0.0);
  dead_time_ms.high += open_ms;
}

/// Standard deviation of white noise and encoder quantisation, from third differences. Motion
/// contributes almost nothing to them.
double FastNoise(const VectorXd& values) {
  const Index count = values.size() - 3;
  const VectorXd third = values.tail(count) - values.head(count) -
                         3.0 * (values.segment(2, count) - values.segment(1, count));
  return Rms(third) / std::sqrt(20.0);  // 1 + 9 + 9 + 1
}

/// Start of a fit of all parameters, with `share` of the delay as dead time.
VectorXd StartOfSplit(const LeastSquaresFit& shifted, double share) {
  constexpr double kDamping = 0.8;
  const double lag_s = (1.0 - share) * shifted.parameters[kDeadTime];
  VectorXd start(kTightParameters);
  start << shifted.parameters, 0.2 * Rms(shifted.residual), lag_s,
      std::pow(lag_s / (2.0 * kDamping), 2);
  start[kDeadTime] *= share;
  return start;
}

/// Time at which the angle no longer depends on the initial state of the hysteresis: the command
/// has travelled its whole width. kBeginning_s if that takes half of the log.
double BeginningBehindPlay(std::span<const double> command_deg, double rate_hz,
                           const LeastSquaresFit& tight) {
  constexpr double kMargin = 1.25;  // the fitted width may be too small
  const double width_deg = kMargin * 2.0 * tight.parameters[kPlay] / tight.parameters[kGain];
  double least = command_deg.front();
  double most = least;
  std::size_t row = 0;
  while (row < command_deg.size() / 2 && most - least < width_deg) {
    least = std::min(least, command_deg[row]);
    most = std::max(most, command_deg[row]);
    ++row;
  }
  if (most - least < width_deg) return kBeginning_s;
  return static_cast<double>(row) / rate_hz + kBeginning_s;
}

/// Fit with lost motion behind the lag. None if the log gives no evidence of lost motion.
std::optional<Split> FitLoose(std::span<const double> command_deg,
                              std::span<const double> angle_deg, double rate_hz, int parts,
                              const std::optional<FrameClock>& frames,
                              const LeastSquaresFit& shifted, const LeastSquaresFit& tight) {
  Problem problem(command_deg, angle_deg, rate_hz, kLooseParameters, frames,
                  BeginningBehindPlay(command_deg, rate_hz, tight));
  std::optional<LeastSquaresFit> best;
  for (const double share : {0.1, 0.5, 0.9}) {  // lost motion over hysteresis
    VectorXd start(kLooseParameters);
    start << StartOfSplit(shifted, 0.5), share * tight.parameters[kPlay];
    start[kPlay] = (1.0 - share) * tight.parameters[kPlay];
    KeepBetter(Minimise(problem, start), best);
  }
  constexpr double kLeastLost_deg = 0.01;  // noise-free angles always gain a little
  if (!(2.0 * best->parameters[kLostPlay] > kLeastLost_deg)) return std::nullopt;
  if (IsByChance(StudentOfGain(*best, tight), 1)) return std::nullopt;
  std::optional<Split> split = SplitOf(*best);
  if (!split) return std::nullopt;
  const double error_deg =
      StandardErrorOf(*best, split->without, [](const VectorXd& p) { return p[kLostPlay]; });
  if (IsByChance(best->parameters[kLostPlay] / error_deg, parts)) return std::nullopt;
  return split;
}

/// Fit of dead time and play only, between a motor and its joint.
LeastSquaresFit FitLost(std::span<const double> motor_deg, std::span<const double> angle_deg,
                        double rate_hz) {
  // Shift of the motor's angle to earlier times, so that the dead time stays positive: the two
  // sensors have different delays.
  constexpr double kEarlier_s = 0.1;
  const auto earlier = static_cast<std::size_t>(std::lround(kEarlier_s * rate_hz));
  const std::span<const double> motor = motor_deg.subspan(earlier);
  const std::span<const double> angle = angle_deg.first(motor.size());
  Problem shift(motor, angle, rate_hz, kShiftParameters);
  const LeastSquaresFit shifted =
      Minimise(shift, Eigen::Vector3d(static_cast<double>(earlier) / rate_hz, 1.0, 0.0));
  Problem lost(motor, angle, rate_hz, kPlayParameters);
  std::optional<LeastSquaresFit> best;
  for (const double share : {0.2, 1.0, 2.0}) {  // play over RMS residual of a shift
    VectorXd start(kPlayParameters);
    start << shifted.parameters, share * Rms(shifted.residual);
    KeepBetter(Minimise(lost, start), best);
  }
  return *best;
}

/// The reason why no chain can be fitted; empty if there is none. `delay_s` receives the start
/// value.
std::string ProblemOf(std::span<const double> command_deg, std::span<const double> angle_deg,
                      double rate_hz, double& delay_s) {
  const double duration_s = static_cast<double>(command_deg.size()) / rate_hz;
  if (duration_s < kShortestChainLog_s) {
    return fmt::format("is {:.3g} s long, must be at least {:g} s", duration_s,
                       kShortestChainLog_s);
  }
  const auto in_rad = [](std::span<const double> signal_deg) {
    std::vector<double> signal(signal_deg.begin(), signal_deg.end());
    for (double& value : signal) value *= kRadPerDeg;
    return signal;
  };
  const std::vector<double> command = in_rad(command_deg);
  const std::vector<double> angle = in_rad(angle_deg);
  const auto rms = [](const std::vector<double>& signal) {
    const Eigen::Map<const VectorXd> values(signal.data(), std::ssize(signal));
    return Rms(values.array() - values.mean());
  };
  if (rms(command) < kStillRms_rad) return "its command does not move";
  if (rms(angle) < kStillRms_rad) return "it does not move";
  Fourier fourier;
  const CountedTicks all{{0, static_cast<int>(command.size())}};
  const auto delay_samples = DelaySamples(command, angle, rate_hz, -kLead_s, all, fourier);
  if (!delay_samples) return "it does not follow its command: no delay to be seen";
  delay_s = *delay_samples / rate_hz;
  if (delay_s < -1.0 / rate_hz) {
    return fmt::format("it is ahead of its command by {:.1f} ms: are the columns exchanged?",
                       -1e3 * delay_s);
  }
  delay_s = std::max(delay_s, 0.0);
  return "";
}

}  // namespace

ChainFit FitChain(std::span<const double> command_deg, std::span<const double> angle_deg,
                  double rate_hz, int parts, const std::optional<FrameClock>& frames) {
  GAUNTLET_ASSERT(rate_hz > 0.0 && parts > 0 && angle_deg.size() == command_deg.size());
  ChainFit fit;
  fit.frames = frames ? frames : FindFrameClock(ChangesOf(command_deg));
  double delay_s = 0.0;
  fit.problem = ProblemOf(command_deg, angle_deg, rate_hz, delay_s);
  if (!fit.problem.empty()) return fit;

  Problem shift(command_deg, angle_deg, rate_hz, kShiftParameters);
  const LeastSquaresFit shifted = Minimise(shift, Eigen::Vector3d(delay_s, 1.0, 0.0));
  fit.shifted_rms_deg = Rms(shifted.residual);
  if (const auto without = WithoutEachBlock(shifted)) {
    fit.delay_ms =
        EstimateOf(shifted, *without, 0.0, [](const VectorXd& p) { return 1e3 * p[kDeadTime]; });
  }

  Problem problem(command_deg, angle_deg, rate_hz, kTightParameters, fit.frames);
  std::optional<LeastSquaresFit> tight;
  for (const double share : {0.25, 0.5, 0.75}) {  // dead time over delay
    KeepBetter(Minimise(problem, StartOfSplit(shifted, share)), tight);
  }
  std::optional<Split> split = SplitOf(*tight);
  if (!split) {
    fit.split_problem =
        "this motion does not tell dead time, lag and hysteresis apart: one of more speeds may";
    return fit;
  }
  if (const auto loose =
          FitLoose(command_deg, angle_deg, rate_hz, parts, fit.frames, shifted, *tight)) {
    split = loose;
  }
  TakeSplit(*split, fit);
  if (fit.frames) WidenDeadTime(1e3 * fit.frames->open_rows / rate_hz, fit.dead_time_ms);
  return fit;
}

void AddMotor(std::span<const double> command_deg, std::span<const double> motor_deg,
              std::span<const double> angle_deg, double rate_hz, ChainFit& fit, int parts) {
  GAUNTLET_ASSERT(motor_deg.size() == command_deg.size() && angle_deg.size() == command_deg.size());
  if (!fit.problem.empty()) return;
  const Eigen::Map<const VectorXd> motor(motor_deg.data(), std::ssize(motor_deg));
  const Eigen::Map<const VectorXd> angle(angle_deg.data(), std::ssize(angle_deg));
  const VectorXd around = motor.array() - motor.mean();
  const double covariance = around.dot((angle.array() - angle.mean()).matrix());
  if (Rms(around) * kRadPerDeg < kStillRms_rad) {
    fit.motor_problem = "its motor does not move";
    return;
  }
  constexpr double kLeastCorrelation = 0.7;
  const double correlation =
      covariance / (around.norm() * (angle.array() - angle.mean()).matrix().norm());
  if (std::abs(correlation) < kLeastCorrelation) {
    fit.motor_problem =
        fmt::format("its motor's angle is not its own (correlation {:.2f}, must be {:g} or more)",
                    std::abs(correlation), kLeastCorrelation);
    return;
  }
  // In the joint's degrees and sign.
  VectorXd scaled = covariance / around.squaredNorm() * around;
  const LeastSquaresFit lost = FitLost({scaled.data(), motor_deg.size()}, angle_deg, rate_hz);
  const auto without = WithoutEachBlock(lost);
  if (!without) return;
  fit.lost_motion_deg =
      EstimateOf(lost, *without, 0.0, [](const VectorXd& p) { return 2.0 * p[kPlay]; });
  scaled *= lost.parameters[kGain];
  const double noise_deg = kNoiseInLost * FastNoise(scaled);
  fit.lost_motion_deg.low = std::max(fit.lost_motion_deg.low - noise_deg, 0.0);
  ChainEstimate& own = fit.motor_hysteresis_deg;
  own = FitChain(command_deg, {scaled.data(), motor_deg.size()}, rate_hz, parts, fit.frames)
            .hysteresis_deg;
  // The interval also contains the uncertainty of the gain between motor and joint.
  const ChainEstimate gain =
      EstimateOf(lost, *without, 0.0, [](const VectorXd& p) { return p[kGain]; });
  const double of_gain = (gain.high - gain.value) / gain.value * own.value;
  own.low = std::max(own.value - std::hypot(own.value - own.low, of_gain), 0.0);
  own.high = own.value + std::hypot(own.high - own.value, of_gain);
}

}  // namespace gauntlet::sim
