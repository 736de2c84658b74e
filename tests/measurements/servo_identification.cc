// How near the simulated hand's hysteresis, joint by joint, comes to that of a hand whose servos
// are of another kind, with what gauntlet identify found of it. The table of
// docs/evidence/measurements.md.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "controller/calibration/robust_statistics.h"
#include "sim/fit/answering_servo.h"
#include "sim/hand/hand_model.h"
#include "tests/calibrate/joint_commands.h"

namespace gauntlet::sim {
namespace {

constexpr double kDuration_s = 30.0;

/// All that hand.servo turns.
std::vector<std::string> Joints() {
  const HandModel hand{HandConfig()};
  std::vector<std::string> joints;
  for (const Drive& drive : hand.drives()) {
    if (drive.servo_key == "hand.servo") joints.push_back(drive.name);
  }
  return joints;
}

double Median(const std::vector<ChainFit>& fits, ChainEstimate ChainFit::*quantity) {
  std::vector<double> values;
  for (const ChainFit& fit : fits) {
    if (std::isfinite((fit.*quantity).value)) values.push_back((fit.*quantity).value);
  }
  return controller::MedianOf(values);
}

/// What one hand answers, beside the other.
void Print(const std::string& name, const std::vector<std::string>& joints,
           const std::vector<ChainFit>& hidden, const std::vector<ChainFit>& found) {
  std::vector<double> off_percent;
  double worst = 0.0;
  std::string worst_joint;
  for (std::size_t i = 0; i < joints.size(); ++i) {
    const double was_deg = hidden[i].hysteresis_deg.value;
    const double off = 100.0 * (found[i].hysteresis_deg.value / was_deg - 1.0);
    if (!std::isfinite(off)) continue;
    off_percent.push_back(std::abs(off));
    if (std::abs(off) < std::abs(worst)) continue;
    worst = off;
    worst_joint =
        fmt::format("{}, {:.2f} -> {:.2f}", joints[i], was_deg, found[i].hysteresis_deg.value);
  }
  const auto median = [&](ChainEstimate ChainFit::*quantity, int digits) {
    return fmt::format("{:.{}f} -> {:.{}f}", Median(hidden, quantity), digits,
                       Median(found, quantity), digits);
  };
  fmt::print("| {} | {} | {} | {:.0f} | {:+.0f}: {} |\n", name, median(&ChainFit::delay_ms, 0),
             median(&ChainFit::hysteresis_deg, 2), controller::MedianOf(off_percent), worst,
             worst_joint);
  std::fflush(stdout);
}

void Measure(const ServoSettings& servo) {
  HandConfig hidden;
  hidden.servo.settings = servo;
  const std::vector<std::string> joints = Joints();
  const ChainLog log = SimulatedAnswer(JointCommands(joints, kDuration_s, 1), hidden);
  const std::vector<ChainFit> fits = FitChains(log, {}, ChainDetail::kBasic);
  const auto untried = UntriedServo(log, fits, HandModel(HandConfig()));
  if (!untried) return;
  const auto trial = TryServos(log, fits, *untried, HandConfig());
  if (!trial) return;
  const std::string kind(controller::KindName(servo));
  Print(kind + ", same commands", joints, fits, trial->fits);
  const ChainLog others = JointCommands(joints, kDuration_s, 2);
  Print(kind + ", others", joints,
        FitChains(SimulatedAnswer(others, hidden), {}, ChainDetail::kBasic),
        FitChains(SimulatedAnswer(others, trial->servo.PutInto(HandConfig())), {},
                  ChainDetail::kBasic));
}

/// What is lost between motor and joint in hands with slack cables and play: means over finger
/// joints of what is found, beside what the geometry says.
void MeasureLostMotion() {
  struct Loose {
    double slack_mm;
    double backlash_deg;
    double capstan_friction;
  };
  const std::vector<std::string> joints = {"index_mcp",  "index_pip",  "middle_mcp",
                                           "middle_pip", "little_mcp", "wrist_flexion"};
  fmt::print(
      "\n| slack [mm] | play [deg of the drum] | capstan friction | joint | dead zone [deg] | lost "
      "motion found [deg] | of the motor [deg] | all [deg] |\n|---|---|---|---|---|---|---|---|\n");
  for (const Loose& loose :
       {Loose{0.0, 0.0, 0.0}, Loose{0.0, 0.0, 0.03}, Loose{0.0, 6.0, 0.0}, Loose{0.0, 6.0, 0.03},
        Loose{1.0, 0.0, 0.0}, Loose{1.0, 0.0, 0.03}, Loose{0.7, 3.0, 0.03}}) {
    HandConfig hidden;
    hidden.cable.slack_mm = {loose.slack_mm};
    hidden.cable.backlash_deg = loose.backlash_deg;
    hidden.cable.capstan_friction = loose.capstan_friction;
    const HandModel hand(hidden);
    const ChainLog log = SimulatedAnswer(JointCommands(joints, kDuration_s, 3), hidden);
    const std::vector<ChainFit> fits = FitChains(log);
    for (std::size_t i = 0; i < joints.size(); ++i) {
      const auto& map = hand.transmission();
      const auto motor = std::ranges::find(map.motor_names, joints[i]) - map.motor_names.begin();
      const double spool_per_joint = std::abs(map.coupling[motor * map.joint_names.size() + motor]);
      const double arm_mm = 1e3 * hand.drives()[motor].drum_radius_m * spool_per_joint;
      const double slack_mm = std::max(loose.slack_mm - hidden.cable.pretension_mm, 0.0);
      const double dead_deg =
          loose.backlash_deg / spool_per_joint + 2.0 * slack_mm / arm_mm * kDegPerRad;
      const auto text = [](const ChainEstimate& e) {
        return fmt::format("{:.2f} ({:.2f} to {:.2f})", e.value, e.low, e.high);
      };
      fmt::print("| {} | {} | {} | {} | {:.2f} | {} | {} | {} |\n", loose.slack_mm,
                 loose.backlash_deg, loose.capstan_friction, joints[i], dead_deg,
                 text(fits[i].lost_motion_deg), text(fits[i].motor_hysteresis_deg),
                 text(fits[i].hysteresis_deg));
      std::fflush(stdout);
    }
  }
}

}  // namespace
}  // namespace gauntlet::sim

int main(int count, char** arguments) {
  using namespace gauntlet::sim;
  const std::string wanted = count > 1 ? arguments[1] : "";
  if (wanted == "lost_motion") {
    MeasureLostMotion();
    return 0;
  }
  fmt::print(
      "| servo, commands | delay [ms] | hysteresis [deg] | off by [%] | worst joint [%] |\n"
      "|---|---|---|---|---|\n");
  const auto measure = [&](const ServoSettings& servo) {
    if (gauntlet::controller::KindName(servo).find(wanted) != std::string::npos) Measure(servo);
  };
  measure(RcAnalogServo{});
  measure(RcDigitalServo{});
  measure(BusServo{});
  measure(DynamixelServo{});
}
