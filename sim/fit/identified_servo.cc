#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "controller/calibration/robust_statistics.h"
#include "sim/base/signal.h"
#include "sim/fit/answering_servo.h"
#include "sim/fit/chain_log.h"
#include "sim/fit/fit_tables.h"

namespace gauntlet::sim {
namespace {

/// Median and range of a quantity over the parts.
struct OverParts {
  double median = 0.0;
  double low = 0.0;
  double high = 0.0;
};

OverParts Over(const std::vector<double>& values) {
  const auto [low, high] = std::ranges::minmax(values);
  return {.median = controller::MedianOf(values), .low = low, .high = high};
}

bool HasHandServo(const Drive& drive) { return drive.servo_key == "hand.servo"; }

/// Median over the hand's motors, without the scales of their settings.
struct UsualSpool {
  double stall_per_inertia = 0.0;   // 1/s^2
  double friction_per_stall = 0.0;  // dry friction over stall torque
};

UsualSpool UsualSpoolOf(const HandModel& hand) {
  std::vector<double> stall_per_inertia;
  std::vector<double> friction_per_stall;
  for (const Drive& drive : hand.drives()) {
    if (!HasHandServo(drive)) continue;
    const double stall_nm = drive.servo.stall_torque_nm / drive.numbers.torque_scale;
    stall_per_inertia.push_back(stall_nm * drive.numbers.inertia_scale / drive.spool.inertia_kg_m2);
    friction_per_stall.push_back(drive.spool.dry_friction_nm / drive.numbers.friction_scale /
                                 stall_nm);
  }
  return {.stall_per_inertia = controller::MedianOf(stall_per_inertia),
          .friction_per_stall = controller::MedianOf(friction_per_stall)};
}

/// True for parts with another servo: elbow and shoulder.
bool HasOtherServo(const HandModel& hand, const std::string& part) {
  const auto drive = std::ranges::find(hand.drives(), part, &Drive::name);
  return drive != hand.drives().end() && !HasHandServo(*drive);
}

/// Turns of a spool per turn of the joint of the same name.
double SpoolPerJoint(const HandModel& hand, const std::string& part) {
  const controller::TendonTransmission& transmission = hand.transmission();
  const std::vector<std::string>& joints = transmission.joint_names;
  std::vector<double> ratios;
  for (std::size_t m = 0; m < transmission.motor_names.size() && m < joints.size(); ++m) {
    if (joints[m] != transmission.motor_names[m]) continue;
    ratios.push_back(std::abs(transmission.coupling[m * joints.size() + m]));
    if (joints[m] == part) return ratios.back();
  }
  return ratios.empty() ? 1.0 : controller::MedianOf(ratios);
}

double WidthOf(const ChainEstimate& estimate) { return estimate.high - estimate.low; }

/// Parts with a model and a motor of hand.servo: the half with the best-known lag. In the others
/// the lag may as well be dead time.
std::vector<std::size_t> TellingParts(const ChainLog& log, const std::vector<ChainFit>& fits,
                                      const HandModel& hand) {
  std::vector<std::size_t> parts;
  std::vector<double> widths;
  for (std::size_t i = 0; i < fits.size(); ++i) {
    if (!fits[i].problem.empty() || !fits[i].split_problem.empty()) continue;
    if (HasOtherServo(hand, log.parts[i])) continue;
    parts.push_back(i);
    widths.push_back(WidthOf(fits[i].lag_ms));
  }
  if (parts.empty()) return parts;
  const double widest = controller::MedianOf(widths);
  std::erase_if(parts, [&](std::size_t part) { return WidthOf(fits[part].lag_ms) > widest; });
  return parts;
}

/// Values of these parts of a log.
struct LogOfServo {
  std::vector<double> dead_time_ms;
  std::vector<double> lag_ms;
  std::vector<double> inertia_s2;
  std::vector<double> at_spool_deg;  // hysteresis
  std::vector<double> hysteresis_deg;
  std::vector<double> gain;
  std::vector<double> speed_deg_s;  // limits at the spool, of parts that have one
};

LogOfServo LogOfServoOf(const ChainLog& log, const std::vector<ChainFit>& fits,
                        const HandModel& hand) {
  LogOfServo of_log;
  for (const std::size_t i : TellingParts(log, fits, hand)) {
    const ChainFit& fit = fits[i];
    constexpr double kDampingOfFirstOrder = 1.5;
    const double slow_s = fit.model.lag_s / (2.0 * kDampingOfFirstOrder);
    const bool second_order = std::isfinite(fit.natural_frequency_hz.value);
    of_log.dead_time_ms.push_back(fit.dead_time_ms.value);
    of_log.lag_ms.push_back(fit.lag_ms.value);
    of_log.inertia_s2.push_back(second_order ? fit.model.inertia_s2 : slow_s * slow_s);
    of_log.hysteresis_deg.push_back(fit.hysteresis_deg.value);
    of_log.at_spool_deg.push_back(fit.hysteresis_deg.value * SpoolPerJoint(hand, log.parts[i]));
    of_log.gain.push_back(fit.gain.value);
    const double limit_deg_s = fit.speed_limit_deg_s.value;
    if (std::isfinite(limit_deg_s)) {
      of_log.speed_deg_s.push_back(limit_deg_s * SpoolPerJoint(hand, log.parts[i]));
    }
  }
  return of_log;
}

std::string Line(const std::string& key, double asked, double value, const std::string& comment) {
  const bool within = std::abs(asked - value) <= 1e-9 * std::abs(value);
  return fmt::format("    {}: {:.4g}  # {}{}\n", key, value, comment,
                     within ? "" : fmt::format("; {:.4g}, which the key does not take", asked));
}

/// Comment text: hysteresis of each part in the log and in the simulated hand with these settings.
std::string HysteresisOfParts(const ChainLog& log, const std::vector<ChainFit>& fits,
                              const ServoTrial& trial) {
  const auto value = [](const ChainFit& fit) { return FixedText(fit.hysteresis_deg.value, 2); };
  std::string text =
      "# - Delay and lag of each part. Hysteresis of the log, and simulated [deg]:\n";
  for (std::size_t i = 0; i < trial.fits.size(); ++i) {
    const std::string& part = trial.answer.parts[i];
    const auto in_log = std::ranges::find(log.parts, part) - log.parts.begin();
    text += fmt::format("#     {}: {}, {}\n", part, value(fits[static_cast<std::size_t>(in_log)]),
                        value(trial.fits[i]));
  }
  return text;
}

}  // namespace

std::optional<AnsweringServo> UntriedServo(const ChainLog& log, const std::vector<ChainFit>& fits,
                                           const HandModel& hand) {
  const LogOfServo of_log = LogOfServoOf(log, fits, hand);
  if (of_log.gain.empty()) return std::nullopt;
  const UsualSpool spool = UsualSpoolOf(hand);
  AnsweringServo servo;
  servo.dead_time_ms = std::max(Over(of_log.dead_time_ms).median, 0.0);
  servo.damping_ms = Over(of_log.lag_ms).median;
  servo.inertia_scale = hand.config().servo.numbers().inertia_scale;
  servo.full_torque_error_deg =
      Over(of_log.inertia_s2).median * spool.stall_per_inertia / servo.inertia_scale * kDegPerRad;
  if (2 * of_log.speed_deg_s.size() > of_log.gain.size()) {
    servo.no_load_speed_deg_s = Over(of_log.speed_deg_s).median;
  }
  // The torque that overcomes the friction, as a share of the stall torque, belongs to half the
  // loop.
  const double error_deg = servo.PutInto(hand.config()).servo.numbers().full_torque_error_deg;
  servo.friction_scale =
      0.5 * Over(of_log.at_spool_deg).median / error_deg / spool.friction_per_stall;
  return servo;
}

std::string ServoSettingsText(const ChainLog& log, const HandModel& hand,
                              const ChainProgress& progress) {
  // The servo of the simulated hand has the parts of the basic chain only.
  const std::vector<ChainFit> fits = FitChains(log, {}, ChainDetail::kBasic);
  const std::optional<AnsweringServo> untried = UntriedServo(log, fits, hand);
  if (!untried) return "";
  const std::optional<ServoTrial> trial = TryServos(log, fits, *untried, hand.config(), progress);
  const AnsweringServo& servo = trial ? trial->servo : *untried;
  const LogOfServo of_log = LogOfServoOf(log, fits, hand);
  const HandConfig config = servo.PutInto(hand.config());
  const ServoNumbers& numbers = config.servo.numbers();

  const auto parts = [](const OverParts& over, int digits) {
    return fmt::format("{:.{}f} to {:.{}f} in the parts", over.low, digits, over.high, digits);
  };
  const OverParts dead_time = Over(of_log.dead_time_ms);
  const OverParts lag = Over(of_log.lag_ms);
  const OverParts hysteresis = Over(of_log.hysteresis_deg);
  const OverParts gain = Over(of_log.gain);
  const double inertia_s2 = Over(of_log.inertia_s2).median;
  std::string text = fmt::format(
      "# Made by gauntlet identify of {}:\n"
      "# the servo with which the simulated hand answers commands as that hand does, to be put "
      "into\n"
      "# a scenario. The hand has one servo for all its motors; values are for the median of the\n"
      "# parts, {}.\n"
      "hand:\n  servo:\n    kind: ideal\n",
      FileNameOf(log),
      trial ? "found by trials of the simulated hand with the log's commands; friction is each "
              "motor's own"
            : "not tried: the simulated hand has no such joints, or cannot be built so");
  text += Line("dead_time_ms", servo.dead_time_ms, numbers.dead_time_ms,
               fmt::format("the log's is {:.4g}, {}", dead_time.median, parts(dead_time, 1)));
  text += Line("damping_ms", servo.damping_ms, numbers.damping_ms,
               fmt::format("the log's lag is {:.4g}, {}", lag.median, parts(lag, 1)));
  text += Line("inertia_scale", servo.inertia_scale, numbers.inertia_scale, "as a usual servo's");
  text +=
      Line("full_torque_error_deg", servo.full_torque_error_deg, numbers.full_torque_error_deg,
           inertia_s2 > 0.0 ? fmt::format("with it a natural frequency of {:.3g} Hz",
                                          1.0 / (2.0 * std::numbers::pi * std::sqrt(inertia_s2)))
                            : "as stiff as may be");
  if (servo.no_load_speed_deg_s > 0.0) {
    text += Line("no_load_speed_deg_s", servo.no_load_speed_deg_s, numbers.no_load_speed_deg_s,
                 fmt::format("the log's limit is {:.4g}", Over(of_log.speed_deg_s).median));
  }
  const std::string loop =
      fmt::format("a loop of {:.2f} deg at the joint, {}", hysteresis.median, parts(hysteresis, 2));
  text += Line("friction_scale", servo.friction_scale, numbers.friction_scale,
               trial ? "as a usual servo's" : loop);
  text +=
      "  cable:\n" + Line("capstan_friction", servo.capstan_friction, config.cable.capstan_friction,
                          trial ? "as usual" : "is in friction_scale");
  if (trial) {
    text += fmt::format(
        "  # {}. On friction_scale and capstan_friction of the motors\n  # {}.\n"
        "  motor_friction_scale: [{:.3g}]\n",
        loop, fmt::join(hand.motor_names(), ", "), fmt::join(config.motor_friction_scale, ", "));
  }
  text +=
      "event:\n  delay_ms: 0  # of the link; is in dead_time_ms\n"
      "# What no key of the hand has:\n";
  text +=
      "# - Dead zones: all of the hysteresis is friction here. " + WhatHysteresisIs(fits) + "\n";
  text += fmt::format("# - The gain, {:.3f} ({}), and the offset: a controller's calibration.\n",
                      gain.median, parts(gain, 3));
  text += trial ? HysteresisOfParts(log, fits, *trial) : "# - Friction of each motor.\n";
  return text;
}

}  // namespace gauntlet::sim
