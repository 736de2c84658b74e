#include "sim/cli/inspect_hand.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <functional>
#include <string>
#include <vector>

#include "sim/base/error.h"
#include "sim/base/output_file.h"
#include "sim/base/shell_word.h"
#include "sim/base/signal.h"
#include "sim/cli/hand_scenario.h"
#include "sim/cli/recording_scenario.h"
#include "sim/cli/standard_streams.h"

namespace gauntlet::sim {
namespace {

/// The motors that turn a joint: "index, thumb".
std::string TurnedBy(const controller::TendonTransmission& hand, std::size_t joint) {
  std::string motors;
  const std::size_t joints = hand.joint_names.size();
  for (std::size_t motor = 0; motor < hand.motor_names.size(); ++motor) {
    if (hand.coupling[motor * joints + joint] == 0.0) continue;
    motors += (motors.empty() ? "" : ", ") + hand.motor_names[motor];
  }
  return motors;
}

/// Target of a motor: its cables, its joint, or "1 x rh_FFJ2 + 1 x rh_FFJ1".
std::string TargetOf(const Drive& drive) {
  std::vector<std::string> parts;
  for (const Cable& cable : drive.cables) parts.push_back(cable.name);
  if (!drive.has_shaft()) {
    return fmt::format("{} (drum {:.3g} mm)", fmt::join(parts, ", "), 1e3 * drive.drum_radius_m);
  }
  for (const ShaftJoint& turned : drive.shaft.joints) {
    parts.push_back(TransmissionOf(drive) == Transmission::kDirect
                        ? turned.name
                        : fmt::format("{:.3g} x {}", turned.ratio, turned.name));
  }
  return fmt::format("{}", fmt::join(parts, " + "));
}

std::string KindOf(const Drive& drive) {
  switch (TransmissionOf(drive)) {
    case Transmission::kDirect:
      return "direct";
    case Transmission::kLinkage:
      return "linkage";
    default:
      return "cables";
  }
}

std::size_t WidthOf(const std::vector<std::string>& names) {
  std::size_t width = 5;
  for (const std::string& name : names) width = std::max(width, name.size());
  return width;
}

void PrintMotors(const HandModel& hand, const std::filesystem::path& file) {
  const std::size_t width = WidthOf(hand.motor_names());
  Print("{:<{}}  kind     stall N m  rotor kg m2  moves\n", "motor", width);
  const std::vector<MotorInModel> in_model = ReadMotors(file);
  for (std::size_t i = 0; i < hand.drives().size(); ++i) {
    const Drive& drive = hand.drives()[i];
    const bool has_stall = in_model[i].stall_torque_nm > 0.0;
    const double rotor_kg_m2 = in_model[i].has_spool
                                   ? drive.spool.inertia_kg_m2 / drive.numbers.inertia_scale
                                   : in_model[i].rotor_inertia_kg_m2;
    Print("{:<{}}  {:<7}  {:>9}  {:>11}  {}\n", drive.name, width, KindOf(drive),
          has_stall ? fmt::format("{:.3g}", drive.servo.stall_torque_nm) : "-",
          rotor_kg_m2 > 0.0 ? fmt::format("{:.2g}", rotor_kg_m2) : "-", TargetOf(drive));
  }
}

void PrintJoints(const HandModel& hand) {
  const std::size_t width = WidthOf(hand.joint_names());
  const std::vector<JointStart> starts = StarterJoints(hand);
  std::vector<std::string> motors;
  for (std::size_t i = 0; i < starts.size(); ++i)
    motors.push_back(TurnedBy(hand.transmission(), i));
  const std::size_t motor_width = std::max(std::size_t{9}, WidthOf(motors));
  Print("\n{:<{}}  range deg      {:<{}}  channel\n", "joint", width, "turned by", motor_width);
  for (std::size_t i = 0; i < starts.size(); ++i) {
    const HandJoint& joint = hand.joints()[i];
    Print("{:<{}}  {:>5.0f} .. {:<5.0f} {:<{}}  {}\n", joint.name, width,
          joint.min_rad * kDegPerRad, joint.max_rad * kDegPerRad, motors[i], motor_width,
          starts[i].channel.empty() ? "-" : starts[i].channel);
  }
  const bool needs_map =
      !std::ranges::equal(starts, hand.joint_names(), {}, &JointStart::channel, std::identity{});
  if (needs_map) {
    Print(
        "\nA joint whose name is no channel needs an entry in joint_map: --write-scenario writes "
        "it "
        "from this guess.\n");
  }
  if (hand.followers().empty()) return;
  Print("\nlinkages: ");
  std::string text;
  for (const Follower& follower : hand.followers()) {
    text += fmt::format("{}{} = {:.3g} x {}", text.empty() ? "" : ", ",
                        hand.NameOfJointAt(follower.qpos), follower.Slope(follower.leader_zero_rad),
                        hand.NameOfJointAt(follower.leader_qpos));
  }
  Print("{}\n", text);
}

}  // namespace

bool IsHandFile(const std::filesystem::path& file) {
  const std::string ending = file.extension().string();
  return ending == ".xml" || ending == ".mjcf";
}

void InspectHand(const std::filesystem::path& file, const std::string& scenario, bool force) {
  const StarterHand starter = MakeStarterHand(file);
  const HandModel hand(starter.config);
  for (const std::string& note : hand.notes()) Say("gauntlet: warning: {}\n", note);
  Print("{}: a hand of {} motors, {} cables and {} joints; MuJoCo {}\n\n", file.string(),
        hand.motor_names().size(), hand.cable_names().size(), hand.joint_names().size(),
        HandModel::EngineVersion());
  PrintMotors(hand, file);
  PrintJoints(hand);
  if (hand.engine_measures_cables()) {
    Print("\nMuJoCo has to follow its cables through space, which takes most of a step.\n");
  }
  const std::string missing =
      fmt::format("{} {} needed: the model does not give the number of each motor",
                  fmt::join(starter.assumed, ", "), starter.assumed.size() == 1 ? "is" : "are");
  if (scenario.empty()) {
    if (starter.assumed.empty()) {
      Print(
          "\nA scenario uses it with hand: {{model_path: {}}}. --write-scenario FILE.yaml writes "
          "one.\n",
          file.string());
    }
    FlushOutput();
    if (starter.assumed.empty()) return;
    throw UserError({.place = file.string(),
                     .problem = missing + "; --write-scenario FILE.yaml writes assumed ones"});
  }
  RefuseInput(scenario);
  if (!starter.assumed.empty()) Print("\nAssumed in the scenario: {}\n", missing);
  FlushOutput();
  WriteStarter(scenario, StarterHandScenario(hand, starter, SeenFrom(scenario, file)), force);
  Print("\nNext: gauntlet compare {}\n", ShellPath(scenario));
}

}  // namespace gauntlet::sim
