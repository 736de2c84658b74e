#include "sim/fit/chain_fit.h"

#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <vector>

#include "controller/assert.h"
#include "sim/base/signal.h"
#include "sim/fit/chain_selection.h"
#include "sim/score/delay.h"

namespace gauntlet::sim {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

/// Beginning of the log that is not compared, because the state of the chain is unknown there.
constexpr double kBeginning_s = 0.5;
constexpr double kEndless = std::numeric_limits<double>::infinity();
constexpr double kLead_s = 0.2;  // a lead up to this is told from a delay of a motion that repeats
/// A delay is searched up to here, in parts that each overlap with the one before.
constexpr double kLongestSearch_s = 3.0;
constexpr double kOneSearch_s = 0.9;
/// Noise of a motor's angle that may appear as play, in standard deviations.
constexpr double kNoiseInLost = 3.0;

double Rms(const VectorXd& values) {
  return std::sqrt(values.squaredNorm() / static_cast<double>(values.size()));
}

/// Image of an estimate under a monotonic function.
template <class Function>
ChainEstimate Through(const ChainEstimate& estimate, const Function& function) {
  const auto [low, high] = std::minmax({function(estimate.low), function(estimate.high)});
  return {function(estimate.value), low, high};
}

/// `value_of` maps a model to the value. The interval is cut off at `least`.
template <class ValueOf>
ChainEstimate EstimateOf(const FittedFamily& fit, double least, const ValueOf& value_of) {
  const auto of_parameters = [&](const VectorXd& p) { return value_of(fit.ModelOf(p)); };
  const double value = of_parameters(fit.solution.parameters);
  const double half_width =
      HalfWidthOf(StandardErrorOf(fit.solution, fit.without, of_parameters),
                  DegreesOfFreedomOf(fit.solution, fit.without, of_parameters));
  return {value, std::max(least, value - half_width), value + half_width};
}

/// The estimate of the first fit. Its interval also contains the disagreement with the others,
/// which explain the log as well, and with itself by other weights of the rows.
/// Source: Buckland, Burnham, Augustin, Biometrics 53, 603-618 (1997).
template <class ValueOf>
ChainEstimate EstimateOf(const std::vector<FittedFamily>& fits, double least,
                         const ValueOf& value_of) {
  const FittedFamily& first = fits.front();
  const ChainEstimate own = EstimateOf(first, -kEndless, value_of);
  double of_models = 0.0;
  for (const FittedFamily& fit : fits) {
    const double value = value_of(fit.ModelOf(fit.solution.parameters));
    of_models = std::max(of_models, std::abs(value - own.value));
  }
  double of_weights = 0.0;
  for (const Reweighted& other : first.reweighted) {
    of_weights = std::max(
        of_weights, DisagreementOf(first.solution, first.without, other,
                                   [&](const VectorXd& p) { return value_of(first.ModelOf(p)); }));
  }
  const double half_width = std::hypot(own.high - own.value, of_models, of_weights);
  return {own.value, std::max(least, own.value - half_width), own.value + half_width};
}

/// The parts of a model in words.
std::string WordsFor(const FittedFamily& fit) {
  const ChainModel model = fit.ModelOf(fit.solution.parameters);
  std::string words = !fit.family.Has(kPlay)      ? "no hysteresis"
                      : !fit.family.Has(kStretch) ? "play"
                      : model.friction_in_lag     ? "friction of the moving mass"
                                                  : "friction";
  words += !fit.family.Has(kExtraLag) ? ", 2nd order"
           : model.extra_lag_s > 0.0  ? ", 3rd order"
                                      : ", 2nd order with a zero";
  if (fit.family.Has(kSlowness)) words += ", speed limit";
  if (fit.family.Has(kBend)) words += ", load";
  if (fit.family.Has(kLostPlay)) words += ", lost motion";
  return words;
}

/// True if a chain of third order explains the log as well, with another natural frequency.
bool OrderIsOpen(const std::vector<FittedFamily>& fits) {
  constexpr double kSame = 0.15;
  const FittedFamily& first = fits.front();
  const double inertia_s2 = first.ModelOf(first.solution.parameters).inertia_s2;
  return std::ranges::any_of(fits, [&](const FittedFamily& fit) {
    const double other_s2 = fit.ModelOf(fit.solution.parameters).inertia_s2;
    return fit.family.Has(kExtraLag) && std::abs(0.5 * std::log(other_s2 / inertia_s2)) > kSame;
  });
}

void EstimateSecondOrder(const std::vector<FittedFamily>& fits, ChainFit& fit) {
  if (!fits.front().second_order || fits.front().family.Has(kExtraLag)) return;
  const ChainEstimate inertia_s2 =
      EstimateOf(fits, 0.0, [](const ChainModel& m) { return m.inertia_s2; });
  if (!(inertia_s2.low > 0.0) || OrderIsOpen(fits)) return;
  fit.natural_frequency_hz = Through(inertia_s2, [](double inertia) {
    return 1.0 / (2.0 * std::numbers::pi * std::sqrt(inertia));
  });
  // The logarithm of the damping ratio is closest to a normal distribution and always defined.
  const auto log_damping = [](const ChainModel& m) {
    return std::log(std::max(m.lag_s, 1e-9) / (2.0 * std::sqrt(std::max(m.inertia_s2, 1e-12))));
  };
  fit.damping_ratio =
      Through(EstimateOf(fits, -1e3, log_damping), [](double l) { return std::exp(l); });
}

/// A load that depends on the angle changes the slope of the steady angle, and with it the loop.
/// The intervals contain the slopes of the whole travel.
void WidenByBend(const FittedFamily& fit, ChainEstimate& gain, ChainEstimate& hysteresis_deg) {
  const ChainModel model = fit.ModelOf(fit.solution.parameters);
  const double change = std::abs(2.0 * model.bend_per_deg * fit.half_travel_deg);
  const double share = change / model.gain;
  gain = {gain.value, std::max(gain.low - change, 0.0), gain.high + change};
  hysteresis_deg = {hysteresis_deg.value, hysteresis_deg.low * (1.0 - share),
                    hysteresis_deg.high * (1.0 + share)};
}

/// Friction of the moving mass that is larger at slow speeds (Stribeck, 20 to 50 %) looks like a
/// wider loop with less damping, and a log rarely tells them apart. The allowances are the largest
/// errors in simulated logs: see docs/evidence/measurements.md.
void AllowForStribeck(ChainFit& fit) {
  fit.hysteresis_deg.low *= 0.88;
  fit.lag_ms.high *= 1.08;
  fit.damping_ratio.high *= 1.14;
}

void EstimateSplit(const std::vector<FittedFamily>& fits, ChainFit& fit) {
  const auto estimate = [&](const auto& value_of, double least = 0.0) {
    return EstimateOf(fits, least, value_of);
  };
  const FittedFamily& selected = fits.front();
  fit.model = selected.ModelOf(selected.solution.parameters);
  fit.model_text = WordsFor(selected);
  fit.residual_rms_deg = Rms(selected.solution.residual);
  fit.held_out_rms_deg = Rms(selected.held_out);
  fit.dead_time_ms = estimate([](const ChainModel& m) { return 1e3 * m.dead_time_s; });
  fit.lag_ms = estimate([](const ChainModel& m) { return 1e3 * (m.lag_s + m.extra_lag_s); });
  fit.gain = estimate([](const ChainModel& m) { return m.gain; });
  fit.offset_deg = estimate([](const ChainModel& m) { return m.offset_deg; }, -kEndless);
  fit.hysteresis_deg =
      estimate([](const ChainModel& m) { return 2.0 * (m.play_deg + m.lost_play_deg); });
  WidenByBend(selected, fit.gain, fit.hysteresis_deg);
  if (selected.family.Has(kLostPlay)) {
    fit.motor_hysteresis_deg = estimate([](const ChainModel& m) { return 2.0 * m.play_deg; });
    fit.lost_motion_deg = estimate([](const ChainModel& m) { return 2.0 * m.lost_play_deg; });
  }
  if (selected.family.Has(kSlowness)) {
    fit.speed_limit_deg_s = Through(
        EstimateOf(selected, 1e-9, [](const ChainModel& m) { return 1.0 / m.speed_limit_deg_s; }),
        [](double slowness) { return 1.0 / slowness; });
  }
  EstimateSecondOrder(fits, fit);
  if (selected.family.friction_in_lag) AllowForStribeck(fit);
}

std::string TextOf(const ChainEstimate& estimate, const char* unit) {
  return fmt::format("{:.0f} {} ({:.0f}..{:.0f})", estimate.value, unit, estimate.low,
                     estimate.high);
}

/// Withholds a value whose interval is at least as wide as `range`.
bool Withhold(double range, const std::string& name, const std::string& need,
              ChainEstimate& estimate, ChainFit& fit) {
  if (!(estimate.high - estimate.low >= range)) return false;
  estimate = {};
  fit.remarks.push_back(name + " not identifiable from this log (needs " + need + ")");
  return true;
}

/// Dead time and lag share the delay; if one of them is open, so is the other.
void WithholdShares(const ChainEstimate& sum_ms, double range_ms, ChainFit& fit) {
  const double widest_ms =
      std::max(fit.dead_time_ms.high - fit.dead_time_ms.low, fit.lag_ms.high - fit.lag_ms.low);
  const bool sum_known = sum_ms.high - sum_ms.low < range_ms;
  if (!(widest_ms >= range_ms)) return;
  fit.dead_time_ms = fit.lag_ms = {};
  fit.remarks.push_back(
      std::string("dead time and lag are not identifiable from this log (needs faster motion or "
                  "more rows per second)") +
      (sum_known ? "; their sum is " + TextOf(sum_ms, "ms") : ""));
}

/// Withholds values that the log does not determine.
void WithholdUnknown(const PartRows& rows, const std::vector<FittedFamily>& fits, ChainFit& fit) {
  const FittedFamily& selected = fits.front();
  WithholdUnknown({.travel_deg = 2.0 * selected.half_travel_deg * fit.model.gain,
                   .rate_hz = rows.rate_hz,
                   .delay_ms = EstimateOf(fits, 0.0,
                                          [](const ChainModel& m) {
                                            return 1e3 * (m.dead_time_s + m.lag_s + m.extra_lag_s);
                                          }),
                   .has_play = selected.family.Has(kPlay),
                   .has_frames = fit.frames.has_value()},
                  fit);
}

/// Part of the dead time that no length of log tells: when the frames were sent, and the step in
/// which a limited speed is simulated.
double OpenOfDeadTime_ms(const PartRows& rows, const FittedFamily& selected) {
  double open_ms = rows.frames ? 1e3 * rows.frames->open_rows / rows.rate_hz : 0.0;
  if (selected.family.Has(kSlowness)) {
    open_ms += 500.0 / RefineCommand(rows.command_deg, rows.rate_hz, rows.frames).rate_hz;
  }
  return open_ms;
}

/// The delay of the model without its speed limit, if that is another one.
void FindUnlimitedDelay(const PartRows& rows, const FittedFamily& selected, ChainFit& fit) {
  if (!selected.family.Has(kSlowness)) return;
  PartRows free = rows;
  ChainProblem problem(rows.command_deg, rows.angle_deg, rows.rate_hz, selected.family, rows.frames,
                       0.0);
  ChainModel model = fit.model;
  model.speed_limit_deg_s = kEndless;
  const VectorXd simulated_deg = problem.Simulated(model);
  free.angle_deg = {simulated_deg.data(), rows.angle_deg.size()};
  free.frames = {};
  const VectorXd start = Eigen::Vector3d(1e-3 * fit.delay_ms.value, fit.model.gain, 0.0);
  const auto without = FitFamily(free, ShiftFamily(), {start});
  constexpr double kSame = 0.05;
  const double delay_ms = without ? 1e3 * without->solution.parameters[kDeadTime] : 0.0;
  if (std::abs(delay_ms - fit.delay_ms.value) <= kSame * fit.delay_ms.value) return;
  fit.unlimited_delay_ms = delay_ms;
}

/// Standard deviation of white noise and encoder quantisation, from third differences. Motion
/// contributes almost nothing to them.
double FastNoise(const VectorXd& values) {
  const Index count = values.size() - 3;
  const VectorXd third = values.tail(count) - values.head(count) -
                         3.0 * (values.segment(2, count) - values.segment(1, count));
  return Rms(third) / std::sqrt(20.0);  // 1 + 9 + 9 + 1
}

/// Start of a fit of the basic chain, with `share` of the delay as dead time.
VectorXd StartOfSplit(const FittedFamily& shifted, double share) {
  constexpr double kDamping = 0.8;
  const double lag_s = (1.0 - share) * shifted.solution.parameters[kDeadTime];
  VectorXd start(6);
  start << shifted.solution.parameters, 0.2 * Rms(shifted.solution.residual), lag_s,
      std::pow(lag_s / (2.0 * kDamping), 2);
  start[kDeadTime] *= share;
  return start;
}

/// Time at which the angle no longer depends on the initial state of the hysteresis: the command
/// has travelled its whole width. kBeginning_s if that takes half of the log.
double BeginningBehindPlay(std::span<const double> command_deg, double rate_hz,
                           const VectorXd& basic) {
  constexpr double kMargin = 1.25;  // the fitted width may be too small
  const double width_deg = kMargin * 2.0 * basic[kPlay] / basic[kGain];
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

/// True if the command is nearly always at one of two positions.
bool HasTwoPositions(std::span<const double> command_deg) {
  constexpr double kNear = 0.02;  // of the travel
  constexpr double kNearlyAlways = 0.95;
  const auto range = std::ranges::minmax(command_deg);
  const double near_deg = kNear * (range.max - range.min);
  const auto there = std::ranges::count_if(command_deg, [&](double value) {
    return value - range.min <= near_deg || range.max - value <= near_deg;
  });
  return static_cast<double>(there) >= kNearlyAlways * static_cast<double>(command_deg.size());
}

/// True if the interval of the hysteresis is narrower than half of the angle's travel.
bool KnowsHysteresis(const FittedFamily& basic) {
  const ChainEstimate width_deg =
      EstimateOf(basic, -kEndless, [](const ChainModel& m) { return 2.0 * m.play_deg; });
  const double travel_deg = 2.0 * basic.half_travel_deg * basic.solution.parameters[kGain];
  return width_deg.high - width_deg.low < 0.5 * travel_deg;
}

/// The basic chain, compared from where its hysteresis is known. None if the log does not
/// distinguish the parameters.
std::optional<FittedFamily> FitBasic(const FittedFamily& shifted, PartRows& rows) {
  std::vector<VectorXd> starts;
  for (const double share : {0.25, 0.5, 0.75}) starts.push_back(StartOfSplit(shifted, share));
  std::optional<FittedFamily> basic = FitFamily(rows, BasicFamily(), starts);
  if (!basic || HasTwoPositions(rows.command_deg) || !KnowsHysteresis(*basic)) {
    // A command between two positions: the log does not separate gain and hysteresis.
    const ChainFamily family = ShiftFamily().With(kLag).With(kInertia);
    for (VectorXd& start : starts) {
      start.segment(kPlay, 2) = VectorXd(start.tail(2));
      start.conservativeResize(std::ssize(family.free));
    }
    return FitFamily(rows, family, starts);
  }
  rows.beginning_s =
      BeginningBehindPlay(rows.command_deg, rows.rate_hz, basic->solution.parameters);
  if (rows.beginning_s == kBeginning_s) return basic;
  return FitFamily(rows, BasicFamily(), {basic->solution.parameters});
}

/// Every n-th row of a log of more than 500 Hz: the models are selected on these.
struct ThinRows {
  explicit ThinRows(const PartRows& all) : rows(all) {
    constexpr double kEnough_hz = 500.0;
    const auto stride = static_cast<std::size_t>(std::floor(all.rate_hz / kEnough_hz));
    if (stride < 2) return;
    for (std::size_t k = 0; k < all.command_deg.size(); k += stride) {
      command_deg.push_back(all.command_deg[k]);
      angle_deg.push_back(all.angle_deg[k]);
    }
    rows.command_deg = command_deg;
    rows.angle_deg = angle_deg;
    const auto share = 1.0 / static_cast<double>(stride);
    rows.rate_hz *= share;
    if (!rows.frames) return;
    rows.frames = CommandClock{.period_rows = share * rows.frames->period_rows,
                               .first_row = share * rows.frames->first_row,
                               .open_rows = share * rows.frames->open_rows};
  }
  ThinRows(const ThinRows&) = delete;

  std::vector<double> command_deg;
  std::vector<double> angle_deg;
  PartRows rows;
};

/// The selected chain first, by all rows, then others that explain the log as well. Empty if the
/// log does not distinguish the parameters.
std::vector<FittedFamily> FitSplit(const PartRows& rows, const FittedFamily& shifted, int parts,
                                   ChainDetail detail) {
  ThinRows thin(rows);
  std::optional<FittedFamily> basic = FitBasic(shifted, thin.rows);
  if (!basic) return {};
  std::vector<FittedFamily> fits = SelectChain(thin.rows, std::move(*basic), parts, detail);
  FittedFamily& selected = fits.front();
  PartRows all = rows;
  all.beginning_s = thin.rows.beginning_s;
  if (thin.rows.rate_hz < rows.rate_hz) {
    auto refined = FitFamily(all, selected.family, {selected.solution.parameters});
    if (!refined) return {};
    selected = std::move(*refined);
  }
  if (detail == ChainDetail::kBasic) {
    fits.resize(1);
  } else {
    selected.reweighted = ReweighRows(all, selected);
  }
  return fits;
}

/// Fit of dead time and play only, between a motor and its joint. None if the rows do not
/// distinguish them.
std::optional<FittedFamily> FitLost(std::span<const double> motor_deg,
                                    std::span<const double> angle_deg, double rate_hz) {
  // Shift of the motor's angle to earlier times, so that the dead time stays positive: the two
  // sensors have different delays.
  constexpr double kEarlier_s = 0.1;
  const auto earlier = static_cast<std::size_t>(std::lround(kEarlier_s * rate_hz));
  const std::span<const double> motor = motor_deg.subspan(earlier);
  const PartRows rows{motor, angle_deg.first(motor.size()), rate_hz, {}, kBeginning_s};
  const auto shifted = FitFamily(
      rows, ShiftFamily(), {Eigen::Vector3d(static_cast<double>(earlier) / rate_hz, 1.0, 0.0)});
  if (!shifted) return std::nullopt;
  std::vector<VectorXd> starts;
  for (const double share : {0.2, 1.0, 2.0}) {  // play over RMS residual of a shift
    starts.emplace_back(4);
    starts.back() << shifted->solution.parameters, share * Rms(shifted->solution.residual);
  }
  return FitFamily(rows, PlayFamily(), starts);
}

/// Pearson's coefficient of the command with the angle so many samples later.
double CorrelationAt(const std::vector<double>& command, const std::vector<double>& angle,
                     double samples) {
  const auto lag = static_cast<Index>(std::lround(samples));
  const Index count = std::ssize(command) - std::abs(lag);
  const Eigen::Map<const VectorXd> c(command.data(), std::ssize(command));
  const Eigen::Map<const VectorXd> a(angle.data(), std::ssize(angle));
  VectorXd x = c.segment(std::max<Index>(0, -lag), count);
  VectorXd y = a.segment(std::max<Index>(0, lag), count);
  x.array() -= x.mean();
  y.array() -= y.mean();
  return x.dot(y) / (x.norm() * y.norm());
}

/// The delay of the angle [samples]. A long one must fit better than a short one of the opposite
/// motion, one of the first search no worse: half a period later, any motion that repeats is its
/// opposite.
std::optional<double> DelayOf(const std::vector<double>& command, std::vector<double> angle,
                              double rate_hz) {
  constexpr double kBetter = 0.05;
  Fourier fourier;
  const CountedTicks all{{0, static_cast<int>(command.size())}};
  std::optional<double> found;
  double earliest_s = -kLead_s;
  for (; !found && earliest_s < kLongestSearch_s; earliest_s += kOneSearch_s) {
    found = DelaySamples(command, angle, rate_hz, earliest_s, all, fourier);
  }
  if (!found) return found;
  const double correlation = CorrelationAt(command, angle, *found);
  for (double& value : angle) value = -value;
  const auto opposite = DelaySamples(command, angle, rate_hz, -kLead_s, all, fourier);
  const double lead = earliest_s < kOneSearch_s ? -kBetter : kBetter;
  const bool is_better = !opposite || correlation > CorrelationAt(command, angle, *opposite) + lead;
  return is_better ? found : std::nullopt;
}

/// True if the angle follows the opposite of the command.
bool IsOpposite(const std::vector<double>& command, std::vector<double> angle, double rate_hz) {
  constexpr double kClearly = 0.8;
  for (double& value : angle) value = -value;
  Fourier fourier;
  const CountedTicks all{{0, static_cast<int>(command.size())}};
  const auto delay = DelaySamples(command, angle, rate_hz, -kLead_s, all, fourier);
  return delay && CorrelationAt(command, angle, *delay) > kClearly;
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
  const auto delay_samples = DelayOf(command, angle, rate_hz);
  if (!delay_samples) {
    return IsOpposite(command, angle, rate_hz)
               ? "its angle falls where its command rises: turn the sign of one of the columns"
               : "it does not follow its command: no delay to be seen";
  }
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
                  double rate_hz, int parts, const std::optional<CommandClock>& frames,
                  ChainDetail detail) {
  GAUNTLET_ASSERT(rate_hz > 0.0 && parts > 0 && angle_deg.size() == command_deg.size());
  ChainFit fit;
  fit.frames = frames ? frames : FindCommandClock(ChangesOf(command_deg));
  if (!fit.frames) fit.frames = StepsOf(ChangesOf(command_deg));
  double delay_s = 0.0;
  fit.problem = ProblemOf(command_deg, angle_deg, rate_hz, delay_s);
  if (!fit.problem.empty()) return fit;

  PartRows rows{command_deg, angle_deg, rate_hz, {}, kBeginning_s};
  const auto shifted = FitFamily(rows, ShiftFamily(), {Eigen::Vector3d(delay_s, 1.0, 0.0)});
  if (!shifted) {
    fit.problem = "its rows do not determine a delay";
    return fit;
  }
  fit.shifted_rms_deg = Rms(shifted->solution.residual);
  fit.delay_ms = EstimateOf(*shifted, 0.0, [](const ChainModel& m) { return 1e3 * m.dead_time_s; });
  if (detail == ChainDetail::kDelay) return fit;
  rows.frames = fit.frames;
  const std::vector<FittedFamily> fits = FitSplit(rows, *shifted, parts, detail);
  if (fits.empty()) {
    fit.split_problem =
        "this motion does not tell dead time, lag and hysteresis apart: one of more speeds may";
    return fit;
  }
  EstimateSplit(fits, fit);
  const Eigen::Map<const VectorXd> angle(angle_deg.data(), std::ssize(angle_deg));
  fit.left_share =
      std::min(fit.residual_rms_deg, fit.shifted_rms_deg) / Rms(angle.array() - angle.mean());
  fit.open_ms = OpenOfDeadTime_ms(rows, fits.front());
  WidenDeadTime(fit);
  FindUnlimitedDelay(rows, fits.front(), fit);
  if (detail == ChainDetail::kBasic) return fit;
  WithholdLimited(fmt::format("{:.0f} ms", fit.delay_ms.value), fit);
  WithholdUnknown(rows, fits, fit);
  return fit;
}

void WidenDeadTime(ChainFit& fit) {
  fit.dead_time_ms.low = std::max(fit.dead_time_ms.low - fit.open_ms, 0.0);
  fit.dead_time_ms.high += fit.open_ms;
}

void WithholdLimited(const std::string& in_log, ChainFit& fit) {
  if (std::isnan(fit.speed_limit_deg_s.value)) return;
  fit.remarks.push_back(fmt::format("limited to {:.3g} {{unit}}/s", fit.speed_limit_deg_s.value));
  if (std::isnan(fit.unlimited_delay_ms)) return;
  fit.remarks.push_back(
      fmt::format("the delay depends on the size of the motion: {} in this log, {:.0f} ms below "
                  "the speed limit",
                  in_log, fit.unlimited_delay_ms));
  fit.delay_ms = {};
}

void WithholdUnknown(const KnownOfLog& known, ChainFit& fit) {
  WithholdShares(known.delay_ms, std::max(known.delay_ms.value, 1e3 / known.rate_hz), fit);
  const std::string larger = "larger motion";
  Withhold(known.travel_deg, "the offset is", larger, fit.offset_deg, fit);
  Withhold(fit.gain.value, "the gain is", larger, fit.gain, fit);
  Withhold(known.has_play ? 0.5 * known.travel_deg : 0.0, "the hysteresis is",
           "slow motion that turns at many positions", fit.hysteresis_deg, fit);
  if (std::isnan(fit.natural_frequency_hz.value)) {
    fit.remarks.emplace_back(
        "natural frequency and damping are not identifiable from this log (needs a second-order "
        "lag, faster motion or more rows per second)");
  } else if (Withhold(fit.natural_frequency_hz.value, "the natural frequency is",
                      "faster motion or more rows per second", fit.natural_frequency_hz, fit)) {
    fit.damping_ratio = {};
  }
  constexpr double kFewRows_hz = 100.0;
  if (!known.has_frames && known.rate_hz < kFewRows_hz) {
    fit.remarks.push_back(fmt::format(
        "at {:.3g} Hz the log does not tell whether commands are held from row to row; if they "
        "are, the dead time is up to {:.0f} ms shorter (see --held)",
        known.rate_hz, 500.0 / known.rate_hz));
  }
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
  const auto lost = FitLost({scaled.data(), motor_deg.size()}, angle_deg, rate_hz);
  if (!lost) return;
  fit.lost_motion_deg =
      EstimateOf(*lost, 0.0, [](const ChainModel& m) { return 2.0 * m.play_deg; });
  scaled *= lost->solution.parameters[kGain];
  const double noise_deg = kNoiseInLost * FastNoise(scaled);
  fit.lost_motion_deg.low = std::max(fit.lost_motion_deg.low - noise_deg, 0.0);
  ChainEstimate& own = fit.motor_hysteresis_deg;
  own = FitChain(command_deg, {scaled.data(), motor_deg.size()}, rate_hz, parts, fit.frames)
            .hysteresis_deg;
  if (std::isnan(own.value)) return;
  // The interval also contains the uncertainty of the gain between motor and joint.
  const ChainEstimate gain = EstimateOf(*lost, 0.0, [](const ChainModel& m) { return m.gain; });
  const double of_gain = (gain.high - gain.value) / gain.value * own.value;
  own.low = std::max(own.value - std::hypot(own.value - own.low, of_gain), 0.0);
  own.high = own.value + std::hypot(own.high - own.value, of_gain);
}

}  // namespace gauntlet::sim
