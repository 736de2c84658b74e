#include "sim/fit/answering_servo.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <string>
#include <utility>

#include "controller/calibration/robust_statistics.h"
#include "sim/base/error.h"
#include "sim/hand/hand_model.h"

namespace gauntlet::sim {
namespace {

constexpr int kTrials = 8;
constexpr double kCloseEnough = 0.05;

bool IsKnown(const ChainFit& fit) { return fit.problem.empty() && fit.split_problem.empty(); }

/// True if the upper half of the interval of the hysteresis is narrower than half its value, or
/// than 0.4 of the usual hysteresis.
bool TellsHysteresis(const ChainFit& fit, double usual_deg) {
  const auto& [value, low, high] = fit.hysteresis_deg;
  return high - value < std::max(0.5 * value, 0.4 * usual_deg);
}

double MedianHysteresis(const std::vector<ChainFit>& fits) {
  std::vector<double> values;
  for (const ChainFit& fit : fits) {
    if (IsKnown(fit)) values.push_back(fit.hysteresis_deg.value);
  }
  return values.empty() ? 0.0 : controller::MedianOf(values);
}

/// Difference between a simulated answer and the log, over the parts that both have a model for.
struct Miss {
  double dead_time_ms = 0.0;                       // median of log minus answer
  double lag_ratio = 1.0;                          // median of log over answer
  double speed_ratio = 1.0;                        // the same of the speed limits
  std::map<std::string, double> hysteresis_ratio;  // log over answer, by part

  /// Largest relative difference of the quantities; for hysteresis, the mean over the parts.
  double Share(double delay_ms) const {
    double hysteresis = 0.0;
    for (const auto& [part, ratio] : hysteresis_ratio) hysteresis += std::abs(std::log(ratio));
    hysteresis /= std::max(static_cast<double>(hysteresis_ratio.size()), 1.0);
    return std::max({std::abs(dead_time_ms) / delay_ms, std::abs(std::log(lag_ratio)),
                     std::abs(std::log(speed_ratio)), hysteresis});
  }
};

/// None if no part has a model in both.
std::optional<Miss> MissOf(const ChainLog& log, const std::vector<ChainFit>& fits,
                           const ChainLog& answer, const std::vector<ChainFit>& answer_fits) {
  constexpr double kNoLag_ms = 1.0;
  constexpr double kNoHysteresis_deg = 0.1;  // smallest hysteresis in a ratio
  std::vector<double> dead_time_ms;
  std::vector<double> lag_ratio, speed_ratio;
  const double usual_deg = MedianHysteresis(fits);
  Miss miss;
  for (std::size_t i = 0; i < answer_fits.size(); ++i) {
    const auto part = std::ranges::find(log.parts, answer.parts[i]) - log.parts.begin();
    const ChainFit& wanted = fits[static_cast<std::size_t>(part)];
    const ChainFit& given = answer_fits[i];
    if (!IsKnown(wanted) || !IsKnown(given)) continue;
    dead_time_ms.push_back(wanted.dead_time_ms.value - given.dead_time_ms.value);
    lag_ratio.push_back((wanted.lag_ms.value + kNoLag_ms) / (given.lag_ms.value + kNoLag_ms));
    const double of_speeds = wanted.speed_limit_deg_s.value / given.speed_limit_deg_s.value;
    if (std::isfinite(of_speeds)) speed_ratio.push_back(of_speeds);
    if (!TellsHysteresis(wanted, usual_deg)) continue;
    miss.hysteresis_ratio[answer.parts[i]] =
        std::max(wanted.hysteresis_deg.value, kNoHysteresis_deg) /
        std::max(given.hysteresis_deg.value, kNoHysteresis_deg);
  }
  if (lag_ratio.empty()) return std::nullopt;
  miss.dead_time_ms = controller::MedianOf(dead_time_ms);
  miss.lag_ratio = controller::MedianOf(lag_ratio);
  if (!speed_ratio.empty()) miss.speed_ratio = controller::MedianOf(speed_ratio);
  return miss;
}

/// The servo of the next trial. Little friction causes no hysteresis; beyond that, hysteresis grows
/// faster than friction. The exponent below 1 keeps the trials from oscillating.
AnsweringServo Corrected(AnsweringServo servo, const Miss& miss, const std::vector<Drive>& drives) {
  servo.dead_time_ms = std::max(0.0, servo.dead_time_ms + miss.dead_time_ms);
  servo.damping_ms *= std::clamp(miss.lag_ratio, 0.5, 2.0);
  servo.no_load_speed_deg_s *= std::clamp(miss.speed_ratio, 0.5, 2.0);
  std::vector<double> known;
  for (std::size_t motor = 0; motor < drives.size(); ++motor) {
    const auto ratio = miss.hysteresis_ratio.find(drives[motor].name);
    if (ratio == miss.hysteresis_ratio.end()) continue;
    double& scale = servo.motor_friction_scale[motor];
    scale = std::clamp(scale * std::pow(std::clamp(ratio->second, 0.4, 2.5), 0.8), 0.01, 20.0);
    known.push_back(scale);
  }
  for (std::size_t motor = 0; motor < drives.size(); ++motor) {
    const bool of_arm = drives[motor].servo_key != "hand.servo";
    if (of_arm || known.empty() || miss.hysteresis_ratio.contains(drives[motor].name)) continue;
    servo.motor_friction_scale[motor] = controller::MedianOf(known);
  }
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
  if (no_load_speed_deg_s > 0.0) {
    numbers.no_load_speed_deg_s = std::clamp(no_load_speed_deg_s, 1.0, 1e4);
  }
  numbers.friction_scale = std::clamp(friction_scale, 0.0, 100.0);
  config.cable.capstan_friction = std::clamp(capstan_friction, 0.0, 0.5);
  config.motor_friction_scale = motor_friction_scale;
  return config;
}

std::optional<ServoTrial> TryServos(const ChainLog& log, const std::vector<ChainFit>& fits,
                                    const AnsweringServo& first, const HandConfig& usual,
                                    const ChainProgress& progress) {
  std::optional<ServoTrial> best;
  double least_miss = std::numeric_limits<double>::infinity();
  AnsweringServo servo = first;
  servo.friction_scale = usual.servo.numbers().friction_scale;
  servo.capstan_friction = usual.cable.capstan_friction;
  const double delay_ms = std::max(first.dead_time_ms + first.damping_ms, 1.0);
  try {
    const HandModel hand(usual);
    servo.motor_friction_scale.assign(hand.drives().size(), 1.0);
    for (int trial = 0; trial < kTrials && least_miss > kCloseEnough; ++trial) {
      if (progress) progress(trial, kTrials);
      ChainLog answer = SimulatedAnswer(log, servo.PutInto(usual));
      if (answer.angle_deg.rows() == 0) break;
      answer.motor_deg = {};  // not compared
      std::vector<ChainFit> answer_fits = FitChains(answer, {}, ChainDetail::kBasic);
      const std::optional<Miss> miss = MissOf(log, fits, answer, answer_fits);
      if (!miss) break;
      const AnsweringServo tried = servo;
      servo = Corrected(servo, *miss, hand.drives());
      if (miss->Share(delay_ms) >= least_miss) continue;
      least_miss = miss->Share(delay_ms);
      best = {.servo = tried, .answer = std::move(answer), .fits = std::move(answer_fits)};
    }
  } catch (const UserError&) {  // an invalid hand, or an answer without a fit
  }
  return best;
}

}  // namespace gauntlet::sim
