#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "controller/calibration/robust_statistics.h"
#include "sim/base/error.h"
#include "sim/base/optimise.h"
#include "sim/base/signal.h"
#include "sim/fit/answering_servo.h"
#include "sim/fit/chain_fit.h"

namespace gauntlet::sim {
namespace {

constexpr double kMostDeadTime_ms = 500.0;
constexpr double kGrid_s = 6.0;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// A range that is searched evenly in the logarithm.
struct LogRange {
  double low;
  double high;

  double At(double share) const { return low * std::pow(high / low, share); }
  double ShareOf(double value) const {
    return std::clamp(std::log(value / low) / std::log(high / low), 0.0, 1.0);
  }
};
constexpr LogRange kDamping_ms = {1.0, 100.0};
constexpr LogRange kFullTorqueError_deg = {0.5, 90.0};
constexpr LogRange kFriction = {0.01, 20.0};  // factor on the scales of the motors

/// The servo, without dead time, at shares of the ranges.
AnsweringServo At(const AnsweringServo& start, const std::vector<double>& place) {
  AnsweringServo servo = start;
  servo.dead_time_ms = 0.0;
  servo.damping_ms = kDamping_ms.At(place[0]);
  servo.full_torque_error_deg = kFullTorqueError_deg.At(place[1]);
  for (double& scale : servo.motor_friction_scale) {
    scale = std::clamp(scale * kFriction.At(place[2]), kFriction.low, kFriction.high);
  }
  return servo;
}

ChainLog BeginOf(const ChainLog& log, double duration_s) {
  ChainLog begin = log;
  const auto rows = static_cast<Eigen::Index>(duration_s * log.rate_hz);
  for (Signal* signal : {&begin.command_deg, &begin.angle_deg, &begin.motor_deg}) {
    if (signal->rows() > rows) *signal = Signal(signal->topRows(rows));
  }
  return begin;
}

/// The miss with the dead time that gives the log's delay.
struct Tried {
  double miss = kInfinity;
  double dead_time_ms = 0.0;
};

std::size_t PartOf(const ChainLog& log, const ChainLog& answer, std::size_t part) {
  return static_cast<std::size_t>(std::ranges::find(log.parts, answer.parts[part]) -
                                  log.parts.begin());
}

/// Square of the share of the motion that is missed if the answer comes so much later, in the mean
/// over the parts.
double MeanSquareMiss(const ChainLog& log, const ChainLog& answer, double dead_time_ms) {
  double sum = 0.0;
  for (std::size_t i = 0; i < answer.parts.size(); ++i) {
    const std::span<const double> measured_deg = ColumnOf(log.angle_deg, PartOf(log, answer, i));
    const std::span<const double> simulated_deg = ColumnOf(answer.angle_deg, i);
    double error = 0.0, whole = 0.0, squares = 0.0, count = 0.0;
    for (auto row = static_cast<std::size_t>(kNotCompared_s * log.rate_hz);
         row < measured_deg.size(); ++row) {
      const double t_s = static_cast<double>(row) / log.rate_hz;
      const double answer_row = (t_s - 1e-3 * dead_time_ms) * answer.rate_hz;
      if (answer_row > static_cast<double>(simulated_deg.size() - 1)) break;
      error += std::pow(measured_deg[row] - ValueAt(simulated_deg, answer_row), 2);
      whole += measured_deg[row];
      squares += measured_deg[row] * measured_deg[row];
      ++count;
    }
    const double motion = squares - whole * whole / std::max(count, 1.0);
    if (!(motion > 0.0)) return kInfinity;
    sum += error / motion;
  }
  return sum / static_cast<double>(answer.parts.size());
}

/// Delay of each part, as for scores; NaN where it is not known.
std::vector<double> DelaysOf(const ChainLog& log) {
  std::vector<double> delay_ms;
  for (std::size_t i = 0; i < log.parts.size(); ++i) {
    delay_ms.push_back(
        FitDelay_ms(ColumnOf(log.command_deg, i), ColumnOf(log.angle_deg, i), log.rate_hz));
  }
  return delay_ms;
}

/// A log, or the beginning of it, with its delays.
struct Wanted {
  ChainLog log;
  std::vector<double> delay_ms;
};

Tried Try(const std::vector<Wanted>& logs, const AnsweringServo& servo, const HandConfig& usual) {
  constexpr double kUnreachedDelay_ms = 100.0;  // misses as much as all of the motion
  std::vector<ChainLog> answers;
  std::vector<double> missing_ms;
  for (const Wanted& wanted : logs) {
    try {
      answers.push_back(SimulatedAnswer(wanted.log, servo.PutInto(usual)));
    } catch (const UserError&) {  // too stiff for the step of the simulation
      return {};
    }
    const ChainLog& answer = answers.back();
    if (answer.angle_deg.rows() == 0) return {};
    const std::vector<double> delay_ms = DelaysOf(answer);
    for (std::size_t i = 0; i < answer.parts.size(); ++i) {
      const double difference_ms = wanted.delay_ms[PartOf(wanted.log, answer, i)] - delay_ms[i];
      if (std::isfinite(difference_ms)) missing_ms.push_back(difference_ms);
    }
  }
  if (missing_ms.empty()) return {};
  const double median_ms = controller::MedianOf(missing_ms);
  Tried tried;
  tried.dead_time_ms = std::clamp(median_ms, 0.0, kMostDeadTime_ms);
  double squares = 0.0;
  for (std::size_t i = 0; i < logs.size(); ++i) {
    squares += MeanSquareMiss(logs[i].log, answers[i], tried.dead_time_ms);
  }
  tried.miss = std::hypot(std::sqrt(squares / static_cast<double>(logs.size())),
                          (median_ms - tried.dead_time_ms) / kUnreachedDelay_ms);
  return tried;
}

}  // namespace

std::optional<AnsweringServo> SearchServo(const std::vector<ChainLog>& logs,
                                          const AnsweringServo& start, const HandConfig& usual) {
  constexpr double kNear = 0.05;
  constexpr double kSameDelay_ms = 10.0;
  constexpr int kEverywhere = 80;
  constexpr int kAround = 40;
  const auto with_delays = [](const ChainLog& log) {
    return Wanted{.log = log, .delay_ms = DelaysOf(log)};
  };
  std::vector<Wanted> whole;
  for (const ChainLog& log : logs) whole.push_back(with_delays(log));
  const auto miss_of = [&](const std::vector<Wanted>& wanted) {
    return [&](const std::vector<double>& place) {
      return Measured{.objective = Try(wanted, At(start, place), usual).miss};
    };
  };
  std::vector<double> place = {kDamping_ms.ShareOf(start.damping_ms),
                               kFullTorqueError_deg.ShareOf(start.full_torque_error_deg),
                               kFriction.ShareOf(1.0)};
  Tried best = Try(whole, At(start, place), usual);
  const bool has_delay = std::abs(best.dead_time_ms - start.dead_time_ms) < kSameDelay_ms;
  if (best.miss < kNear && has_delay) return start;
  if (best.miss > kNear) {
    const std::vector<Wanted> part = {with_delays(BeginOf(logs.front(), kGrid_s))};
    const std::vector<double> found = BestOf(LookEverywhere(3, kEverywhere, miss_of(part))).place;
    if (Try(whole, At(start, found), usual).miss < best.miss) place = found;
  }
  place = BestOf(LookAround(place, kAround, miss_of(whole))).place;
  best = Try(whole, At(start, place), usual);
  if (!(best.miss < 1.0)) return std::nullopt;  // a hand at rest would miss less
  AnsweringServo servo = At(start, place);
  servo.dead_time_ms = best.dead_time_ms;
  return servo;
}

}  // namespace gauntlet::sim
