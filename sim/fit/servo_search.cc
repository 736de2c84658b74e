#include "sim/fit/servo_search.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "controller/calibration/robust_statistics.h"
#include "sim/base/error.h"
#include "sim/base/signal.h"
#include "sim/fit/chain_fit.h"
#include "sim/fit/simulated_answer.h"

namespace gauntlet::sim {
namespace {

constexpr double kMostDeadTime_ms = 500.0;
constexpr double kGrid_s = 6.0;
constexpr double kLeastFriction = 0.01;  // scales of motors, as TryServos() has them
constexpr double kMostFriction = 20.0;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Logarithms of damping [ms], error for full torque [deg] and the factor on friction.
using Place = std::array<double, 3>;

constexpr Place kLow = {0.0, -0.69, -4.6};  // 1 ms, 0.5 deg, 0.01
constexpr Place kHigh = {4.6, 4.5, 3.0};    // 100 ms, 90 deg, 20
constexpr std::array<int, 3> kPoints = {4, 5, 4};

AnsweringServo At(const AnsweringServo& start, const Place& place) {
  AnsweringServo servo = start;
  servo.dead_time_ms = 0.0;
  servo.damping_ms = std::exp(place[0]);
  servo.full_torque_error_deg = std::exp(place[1]);
  for (double& scale : servo.motor_friction_scale) {
    scale = std::clamp(scale * std::exp(place[2]), kLeastFriction, kMostFriction);
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

double At(const Signal& signal, Eigen::Index column, double row) {
  const auto before =
      std::clamp<Eigen::Index>(static_cast<Eigen::Index>(row), 0, signal.rows() - 1);
  const Eigen::Index behind = std::min(before + 1, signal.rows() - 1);
  return std::lerp(signal(before, column), signal(behind, column),
                   std::clamp(row - static_cast<double>(before), 0.0, 1.0));
}

std::size_t PartOf(const ChainLog& log, const ChainLog& answer, std::size_t part) {
  return static_cast<std::size_t>(std::ranges::find(log.parts, answer.parts[part]) -
                                  log.parts.begin());
}

/// Square of the share of the motion that is missed if the answer comes so much later, in the mean
/// over the parts.
double MeanSquareMiss(const ChainLog& log, const ChainLog& answer, double dead_time_ms) {
  double sum = 0.0;
  for (Eigen::Index i = 0; i < answer.angle_deg.cols(); ++i) {
    const auto part = static_cast<Eigen::Index>(PartOf(log, answer, static_cast<std::size_t>(i)));
    double error = 0.0, whole = 0.0, squares = 0.0, count = 0.0;
    for (auto row = static_cast<Eigen::Index>(kNotCompared_s * log.rate_hz);
         row < log.angle_deg.rows(); ++row) {
      const double t_s = static_cast<double>(row) / log.rate_hz;
      const double answer_row = (t_s - 1e-3 * dead_time_ms) * answer.rate_hz;
      if (answer_row > static_cast<double>(answer.angle_deg.rows() - 1)) break;
      const double measured_deg = log.angle_deg(row, part);
      error += std::pow(measured_deg - At(answer.angle_deg, i, std::max(answer_row, 0.0)), 2);
      whole += measured_deg;
      squares += measured_deg * measured_deg;
      ++count;
    }
    const double motion = squares - whole * whole / std::max(count, 1.0);
    if (!(motion > 0.0)) return kInfinity;
    sum += error / motion;
  }
  return sum / static_cast<double>(answer.angle_deg.cols());
}

/// Delay of each part, as for scores; NaN where it is not known.
std::vector<double> DelaysOf(const ChainLog& log) {
  std::vector<double> delay_ms;
  for (std::size_t i = 0; i < log.parts.size(); ++i) {
    delay_ms.push_back(FitChain(ColumnOf(log.command_deg, i), ColumnOf(log.angle_deg, i),
                                log.rate_hz, 1, {}, ChainDetail::kDelay)
                           .delay_ms.value);
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

/// The best point of the grid; `start` if none is better.
Place LookEverywhere(const Place& start, const auto& try_place) {
  Place best = start;
  double least = try_place(start).miss;
  for (int point = 0; point < kPoints[0] * kPoints[1] * kPoints[2]; ++point) {
    Place place;
    int rest = point;
    for (std::size_t i = 0; i < place.size(); ++i) {
      const double share = static_cast<double>(rest % kPoints[i]) / (kPoints[i] - 1);
      place[i] = std::lerp(kLow[i], kHigh[i], share);
      rest /= kPoints[i];
    }
    const double miss = try_place(place).miss;
    if (miss >= least) continue;
    least = miss;
    best = place;
  }
  return best;
}

}  // namespace

std::optional<AnsweringServo> SearchServo(const std::vector<ChainLog>& logs,
                                          const AnsweringServo& start, const HandConfig& usual) {
  constexpr double kNear = 0.05;
  constexpr double kSameDelay_ms = 10.0;
  constexpr double kFirstStep = 0.6;  // of a logarithm
  constexpr double kLastStep = 0.05;
  constexpr int kMostRefined = 40;
  Place place = {std::log(std::max(start.damping_ms, 1.0)),
                 std::log(std::max(start.full_torque_error_deg, 0.5)), 0.0};
  for (std::size_t i = 0; i < place.size(); ++i) place[i] = std::clamp(place[i], kLow[i], kHigh[i]);
  std::vector<Wanted> whole;
  for (const ChainLog& log : logs) whole.push_back({.log = log, .delay_ms = DelaysOf(log)});
  const auto try_whole = [&](const Place& at) { return Try(whole, At(start, at), usual); };
  Tried best = try_whole(place);
  const bool has_delay = std::abs(best.dead_time_ms - start.dead_time_ms) < kSameDelay_ms;
  if (best.miss < kNear && has_delay) return start;
  if (best.miss > kNear) {
    const ChainLog begin = BeginOf(logs.front(), kGrid_s);
    const std::vector<Wanted> part = {{.log = begin, .delay_ms = DelaysOf(begin)}};
    const Place found =
        LookEverywhere(place, [&](const Place& at) { return Try(part, At(start, at), usual); });
    const Tried tried = try_whole(found);
    if (tried.miss < best.miss) {
      best = tried;
      place = found;
    }
  }
  int refined = 0;
  for (double step = kFirstStep; step > kLastStep && refined < kMostRefined;) {
    bool is_better = false;
    for (std::size_t i = 0; i < place.size(); ++i) {
      for (const double sign : {1.0, -1.0}) {
        Place next = place;
        next[i] = std::clamp(next[i] + sign * step, kLow[i], kHigh[i]);
        if (next == place) continue;
        const Tried tried = try_whole(next);
        ++refined;
        if (tried.miss >= best.miss) continue;
        best = tried;
        place = next;
        is_better = true;
        break;
      }
    }
    if (!is_better) step *= 0.5;
  }
  if (!(best.miss < 1.0)) return std::nullopt;  // a hand at rest would miss less
  AnsweringServo servo = At(start, place);
  servo.dead_time_ms = best.dead_time_ms;
  return servo;
}

}  // namespace gauntlet::sim
