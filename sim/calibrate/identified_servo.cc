#include "sim/calibrate/identified_servo.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "controller/calibration/robust_statistics.h"
#include "sim/base/signal.h"

namespace gauntlet::sim {
namespace {

/// A quantity of all parts that have it.
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

/// The motors of the model's hand, in the median, each scale taken out.
struct UsualSpool {
  double stall_per_inertia = 0.0;   // 1/s^2
  double friction_per_stall = 0.0;  // of the dry friction
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

/// Elbow and shoulder have other servos.
bool HasOtherServo(const HandModel& hand, const std::string& part) {
  const auto drive = std::ranges::find(hand.drives(), part, &Drive::name);
  return drive != hand.drives().end() && !HasHandServo(*drive);
}

/// How far a spool turns per turn of its own joint, by the names of joints.
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

/// Parts with a model that hand.servo turns, of them the half whose lag the log tells best: others
/// have a lag that may as well be dead time.
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

/// A value within the range of its key, and a word about it if the log asks for another.
struct ServoSetting {
  double value = 0.0;
  std::string note;
};

ServoSetting Within(double value, double low, double high) {
  if (value >= low && value <= high) return {.value = value, .note = ""};
  return {.value = std::clamp(value, low, high),
          .note = fmt::format("; the log asks for {:.4g}, which the key does not take", value)};
}

std::string Line(const std::string& key, const ServoSetting& setting, const std::string& comment) {
  return fmt::format("    {}: {:.4g}  # {}{}\n", key, setting.value, comment, setting.note);
}

}  // namespace

std::string ServoSettingsText(const ChainLog& log, const std::vector<ChainFit>& fits,
                              const HandModel& hand) {
  std::vector<double> dead_time_ms;
  std::vector<double> lag_ms;
  std::vector<double> inertia_s2;
  std::vector<double> at_spool_deg;
  std::vector<double> hysteresis_deg;
  std::vector<double> gain;
  for (const std::size_t i : TellingParts(log, fits, hand)) {
    const ChainFit& fit = fits[i];
    constexpr double kDampingOfFirstOrder = 1.5;
    const double slow_s = fit.model.lag_s / (2.0 * kDampingOfFirstOrder);
    const bool second_order = std::isfinite(fit.natural_frequency_hz.value);
    dead_time_ms.push_back(fit.dead_time_ms.value);
    lag_ms.push_back(fit.lag_ms.value);
    inertia_s2.push_back(second_order ? fit.model.inertia_s2 : slow_s * slow_s);
    hysteresis_deg.push_back(fit.hysteresis_deg.value);
    at_spool_deg.push_back(fit.hysteresis_deg.value * SpoolPerJoint(hand, log.parts[i]));
    gain.push_back(fit.gain.value);
  }
  if (gain.empty()) return "";
  const OverParts dead_time = Over(dead_time_ms);
  const OverParts lag = Over(lag_ms);
  const OverParts hysteresis = Over(hysteresis_deg);
  const OverParts gains = Over(gain);
  const UsualSpool spool = UsualSpoolOf(hand);
  const double inertia_scale = hand.config().servo.numbers().inertia_scale;
  const double inertia = controller::MedianOf(inertia_s2);
  const ServoSetting error =
      Within(inertia * spool.stall_per_inertia / inertia_scale * kDegPerRad, 0.5, 90.0);
  // What moves the spool against its friction, as a share of the stall torque, is half the loop.
  const double friction_share = 0.5 * controller::MedianOf(at_spool_deg) / error.value;
  const auto parts = [](const OverParts& over) {
    return fmt::format("{:.1f} to {:.1f} in the parts", over.low, over.high);
  };
  std::string text = fmt::format(
      "# Made by gauntlet identify of {}:\n"
      "# the servo with which the simulated hand answers commands as that hand does. To be put "
      "into "
      "a\n# scenario. The hand has one servo for all its motors: each value is the median over {} "
      "parts.\nhand:\n  servo:\n    kind: ideal\n",
      log.name, gain.size());
  text += Line("dead_time_ms", Within(std::max(dead_time.median, 0.0), 0.0, 500.0),
               parts(dead_time) + "; a frame's wait is in it");
  text += Line("damping_ms", Within(lag.median, 0.0, 100.0), "the lag, " + parts(lag));
  text += Line("inertia_scale", {.value = inertia_scale, .note = ""}, "as a usual servo's");
  text += Line("full_torque_error_deg", error,
               inertia > 0.0 ? fmt::format("with it a natural frequency of {:.3g} Hz",
                                           1.0 / (2.0 * std::numbers::pi * std::sqrt(inertia)))
                             : "as stiff as may be");
  text += Line("friction_scale", Within(friction_share / spool.friction_per_stall, 0.0, 100.0),
               fmt::format("a loop of {:.2f} deg at the joint, {:.2f} to {:.2f} in the parts",
                           hysteresis.median, hysteresis.low, hysteresis.high));
  text +=
      "  cable:\n    capstan_friction: 0  # is in friction_scale\n"
      "event:\n  delay_ms: 0  # of the link; is in dead_time_ms\n"
      "# What no key of the hand has:\n"
      "# - Dry friction and backlash look alike in a log: all of it is friction here.\n";
  text += fmt::format(
      "# - The gain, {:.3f} ({:.3f} to {:.3f} in the parts), and the offset: a controller's "
      "calibration.\n# - What differs from part to part.\n",
      gains.median, gains.low, gains.high);
  return text;
}

}  // namespace gauntlet::sim
