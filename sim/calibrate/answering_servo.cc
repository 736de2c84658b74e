#include "sim/calibrate/answering_servo.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "controller/calibration/robust_statistics.h"
#include "sim/base/error.h"
#include "sim/calibrate/simulated_answer.h"

namespace gauntlet::sim {
namespace {

constexpr int kTrials = 5;
constexpr double kCloseEnough = 0.05;

bool IsKnown(const ChainFit& fit) { return fit.problem.empty() && fit.split_problem.empty(); }

/// By how much an answer misses the log, over the parts that have a model in both.
struct Miss {
  double dead_time_ms = 0.0;      // median of what is missing
  double lag_ratio = 1.0;         // median of wanted over given
  double hysteresis_ratio = 1.0;  // medians, wanted over given

  /// As a share, of the quantity that misses most.
  double Share(double delay_ms) const {
    return std::max({std::abs(dead_time_ms) / delay_ms, std::abs(std::log(lag_ratio)),
                     std::abs(std::log(hysteresis_ratio))});
  }
};

Miss MissOf(const std::vector<ChainFit>& wanted, const std::vector<ChainFit>& given) {
  constexpr double kNoLag_ms = 1.0;
  constexpr double kNoHysteresis_deg = 0.05;  // less counts as if it were this
  std::vector<double> dead_time_ms;
  std::vector<double> lag_ratio;
  std::vector<double> wanted_deg;
  std::vector<double> given_deg;
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    dead_time_ms.push_back(wanted[i].dead_time_ms.value - given[i].dead_time_ms.value);
    lag_ratio.push_back((wanted[i].lag_ms.value + kNoLag_ms) / (given[i].lag_ms.value + kNoLag_ms));
    wanted_deg.push_back(wanted[i].hysteresis_deg.value);
    given_deg.push_back(given[i].hysteresis_deg.value);
  }
  return {.dead_time_ms = controller::MedianOf(dead_time_ms),
          .lag_ratio = controller::MedianOf(lag_ratio),
          .hysteresis_ratio = std::max(controller::MedianOf(wanted_deg), kNoHysteresis_deg) /
                              std::max(controller::MedianOf(given_deg), kNoHysteresis_deg)};
}

/// The servo of the next trial. Little friction gives no hysteresis, beyond that it grows faster
/// than friction does: the power keeps trials from swinging around it.
AnsweringServo Corrected(AnsweringServo servo, const Miss& miss) {
  servo.dead_time_ms = std::max(0.0, servo.dead_time_ms + miss.dead_time_ms);
  servo.damping_ms *= std::clamp(miss.lag_ratio, 0.5, 2.0);
  const double friction = std::pow(std::clamp(miss.hysteresis_ratio, 0.4, 2.5), 0.8);
  servo.friction_scale *= friction;
  servo.capstan_friction *= friction;
  return servo;
}

}  // namespace

HandConfig AnsweringServo::PutInto(const HandConfig& usual) const {
  HandConfig config = usual;
  config.servo.settings = IdealServo{};
  ServoNumbers& numbers = config.servo.numbers();
  numbers.dead_time_ms = std::clamp(dead_time_ms, 0.0, 500.0);
  numbers.damping_ms = std::clamp(damping_ms, 0.0, 100.0);
  numbers.inertia_scale = inertia_scale;
  numbers.full_torque_error_deg = std::clamp(full_torque_error_deg, 0.5, 90.0);
  numbers.friction_scale = std::clamp(friction_scale, 0.0, 100.0);
  config.cable.capstan_friction = std::clamp(capstan_friction, 0.0, 0.5);
  return config;
}

std::optional<ServoTrial> TryServos(const ChainLog& log, const std::vector<ChainFit>& fits,
                                    const AnsweringServo& first, const HandConfig& usual) {
  std::optional<ServoTrial> best;
  double least_miss = std::numeric_limits<double>::infinity();
  AnsweringServo servo = first;
  servo.friction_scale = usual.servo.numbers().friction_scale;
  servo.capstan_friction = usual.cable.capstan_friction;
  const double delay_ms = std::max(first.dead_time_ms + first.damping_ms, 1.0);
  try {
    for (int trial = 0; trial < kTrials && least_miss > kCloseEnough; ++trial) {
      ChainLog answer = SimulatedAnswer(log, servo.PutInto(usual));
      if (answer.angle_deg.rows() == 0) break;
      std::vector<ChainFit> answer_fits = FitChains(answer);
      std::vector<ChainFit> wanted;
      std::vector<ChainFit> given;
      for (std::size_t i = 0; i < answer_fits.size(); ++i) {
        const auto part = std::ranges::find(log.parts, answer.parts[i]) - log.parts.begin();
        const ChainFit& of_log = fits[static_cast<std::size_t>(part)];
        if (!IsKnown(of_log) || !IsKnown(answer_fits[i])) continue;
        wanted.push_back(of_log);
        given.push_back(answer_fits[i]);
      }
      if (wanted.empty()) break;
      const Miss miss = MissOf(wanted, given);
      if (miss.Share(delay_ms) < least_miss) {
        least_miss = miss.Share(delay_ms);
        best = {.servo = servo, .answer = std::move(answer), .fits = std::move(answer_fits)};
      }
      servo = Corrected(servo, miss);
    }
  } catch (const UserError&) {  // a hand that is refused, or an answer that no chain fits
  }
  return best;
}

}  // namespace gauntlet::sim
