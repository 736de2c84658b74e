#include "sim/cli/inspect_hand.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "sim/base/channels.h"
#include "sim/base/error.h"
#include "sim/base/output_file.h"
#include "sim/base/shell_word.h"
#include "sim/base/signal.h"
#include "sim/base/text.h"
#include "sim/cli/recording_scenario.h"
#include "sim/cli/standard_streams.h"
#include "sim/hand/hand_model.h"
#include "sim/recordings/inspect/joint_names.h"
#include "sim/recordings/inspect/starter_files.h"
#include "sim/tables/name_words.h"

namespace gauntlet::sim {
namespace {

/// The hand of a model file with numbers for what the file does not say of its motors.
struct StarterHand {
  HandConfig config;
  std::vector<std::string> assumed;  // keys whose values are not those of the file
};

/// Source of the angle of a joint.
struct JointStart {
  std::string channel;  // empty: held
  double weight = 1.0;
  double offset_deg = 0.0;
  std::string why;
};

// XL330-M288 at 5 V: ROBOTIS e-manual; rotor and dry friction: Rhoban/bam.
constexpr double kStallTorqueNm = 0.52;
constexpr double kRotorKgM2 = 0.002;
/// A rotor below this has not the torque of its motor: some models have a number for the solver.
constexpr double kLeastRotorPerTorque = 4e-4;  // kg m^2 per N m; that of the XL330 is 4e-3
constexpr double kDryFrictionNm = 0.013;
// Stiffness of the finger cables in models/hand_arm.xml; a pretension that weak springs can hold.
constexpr double kDrumRadiusMm = 10.0;
constexpr double kCableStiffnessNM = 20000.0;
constexpr double kPretensionMm = 0.05;

/// One value where all are equal, else all.
std::vector<double> Shortened(const std::vector<double>& values) {
  const bool equal = std::ranges::all_of(values, [&](double v) { return v == values.front(); });
  return equal ? std::vector{values.front()} : values;
}

std::string ListText(const std::vector<double>& values) {
  return fmt::format("[{}]", fmt::join(values, ", "));
}

/// Names as ReadSensorName() takes them: Shadow and Allegro number the joints of a finger from
/// different ends, but a model has them in the order from the palm to the tip.
std::string NameByPlace(const std::string& joint) {
  const std::vector<std::string> words = WordsOf(joint);
  const bool numbered = std::ranges::any_of(words, [](const std::string& word) {
    return word == "thj" || word == "ffj" || word == "mfj" || word == "rfj" || word == "lfj";
  });
  if (!numbered) return joint;
  const auto finger =
      std::ranges::find_if(words, [](const std::string& word) { return !FingerOf(word).empty(); });
  return finger == words.end() ? joint : std::string(FingerOf(*finger));
}

/// A glove has no end joints of fingers: they follow the middle joint, as a person's do.
void UseMiddleJoint(const std::vector<JointStart>& joints, JointStart& joint) {
  const std::size_t end = joint.channel.find("_dip");
  if (end == std::string::npos) return;
  joint.channel = joint.channel.substr(0, end) + "_pip";
  const bool also_middle = std::ranges::any_of(joints, [&](const JointStart& other) {
    return &other != &joint && other.channel == joint.channel;
  });
  joint.weight = also_middle ? kEndJointPerMiddleJoint : 1.0;
  joint.why = also_middle ? "end joint: a share of the middle joint" : "the only joint of both";
}

/// Lays the channel's range over the joint's, where the joint's own angles do not fit.
void FitRange(const HandJoint& joint, JointStart& start) {
  const Channel& channel = KnownChannels()[ChannelIndex(start.channel)];
  const double min_deg = joint.min_rad * kDegPerRad;
  const double max_deg = joint.max_rad * kDegPerRad;
  const double low_deg = std::max(0.0, channel.min_deg);
  const double asked_deg = start.weight * (channel.max_deg - low_deg);
  const double reached_deg =
      std::min(max_deg, start.weight * channel.max_deg) - std::max(min_deg, low_deg);
  constexpr double kMostlyWithin = 0.6;
  if (reached_deg >= kMostlyWithin * asked_deg) return;
  const bool mirrored = -min_deg > max_deg;
  start.weight = (mirrored ? -1.0 : 1.0) * (max_deg - min_deg) / (channel.max_deg - low_deg);
  start.offset_deg = (mirrored ? max_deg : min_deg) - start.weight * low_deg;
  start.why = "the channel's range is laid over the joint's";
}

bool HasRotor(const MotorInModel& motor, double stall_torque_nm) {
  return motor.rotor_inertia_kg_m2 > kLeastRotorPerTorque * stall_torque_nm;
}

/// Errors: UserError for a joint that joint_map cannot name.
void CheckKey(const std::string& joint) {
  const bool fits = std::ranges::all_of(joint, [](char c) {
    return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c == '-' || c == '+';
  });
  if (fits) return;
  throw UserError(
      fmt::format("joint '{}' of the model: a name in joint_map has letters, digits, _, "
                  "- and + only; rename the joint",
                  Shown(joint)));
}

/// Assumed are the numbers of an XL330-M288: stall torque, rotor in proportion to it, gear.
StarterHand MakeStarterHand(const std::filesystem::path& model) {
  StarterHand starter;
  HandConfig& config = starter.config;
  config.model_path = model.string();
  std::vector<double> stall, rotor, friction, drum_mm;
  bool lacks_stall = false, lacks_rotor = false, lacks_drum = false;
  bool has_cable = false;
  for (const MotorInModel& motor : ReadMotors(model)) {
    if (motor.has_spool) return {.config = config, .assumed = {}};
    lacks_drum = lacks_drum || (motor.pulls_cable && !(motor.drum_radius_m > 0.0));
    drum_mm.push_back(motor.drum_radius_m > 0.0 ? 1e3 * motor.drum_radius_m : kDrumRadiusMm);
    has_cable = has_cable || motor.pulls_cable;
    lacks_stall = lacks_stall || !(motor.stall_torque_nm > 0.0);
    const double lever = motor.pulls_cable ? 1e-3 * drum_mm.back() : 1.0;
    stall.push_back(motor.stall_torque_nm > 0.0 ? lever * motor.stall_torque_nm : kStallTorqueNm);
    const bool has_rotor = HasRotor(motor, stall.back());
    lacks_rotor = lacks_rotor || !has_rotor;
    rotor.push_back(has_rotor ? motor.rotor_inertia_kg_m2
                              : kRotorKgM2 / kStallTorqueNm * stall.back());
    friction.push_back(has_rotor ? motor.dry_friction_nm
                                 : std::max(kDryFrictionNm, motor.dry_friction_nm));
  }
  if (lacks_stall) {
    config.motor.stall_torque_nm = Shortened(stall);
    starter.assumed.emplace_back("hand.motor.stall_torque_nm");
  }
  if (lacks_rotor) {
    config.motor.rotor_inertia_kg_m2 = Shortened(rotor);
    config.motor.dry_friction_nm = Shortened(friction);
    starter.assumed.emplace_back("hand.motor.rotor_inertia_kg_m2");
  }
  if (has_cable) {
    config.motor.drum_radius_mm = Shortened(drum_mm);
    config.cable.stiffness_n_m = kCableStiffnessNM;
    config.cable.pretension_mm = kPretensionMm;
    if (lacks_drum) starter.assumed.emplace_back("hand.motor.drum_radius_mm");
    starter.assumed.emplace_back("hand.cable.stiffness_n_m");
  }
  // The kinds of servo have factors on the small motors of models/: these numbers are whole.
  ServoNumbers& servo = config.servo.numbers();
  servo.inertia_scale = servo.friction_scale = 1.0;
  return starter;
}

/// Start of each joint of the hand, from its name, its place in the finger and its range.
std::vector<JointStart> StarterJoints(const HandModel& hand) {
  std::vector<std::string> names;
  // In the model's order, so that joints of a finger are in the order from the palm to the tip.
  std::vector<std::size_t> order(hand.joints().size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::ranges::sort(order, {}, [&](std::size_t i) { return hand.joints()[i].joint; });
  for (const std::size_t i : order) names.push_back(NameByPlace(hand.joints()[i].name));
  std::string unused;
  const std::vector<ColumnJoint> found = JointsByNames(names, unused);
  std::vector<JointStart> starts(order.size());
  for (std::size_t k = 0; k < order.size(); ++k) {
    starts[order[k]] = {.channel = found[k].channel, .why = found[k].why};
  }
  for (std::size_t i = 0; i < starts.size(); ++i) {
    const HandJoint& joint = hand.joints()[i];
    UseMiddleJoint(starts, starts[i]);
    if (!starts[i].channel.empty()) {
      FitRange(joint, starts[i]);
      continue;
    }
    starts[i].offset_deg = std::clamp(0.0, joint.min_rad * kDegPerRad, joint.max_rad * kDegPerRad);
    starts[i].why = "held: no channel of the glove found for its name";
  }
  return starts;
}

/// A scenario that moves the hand at random. `model`: its path in the scenario.
/// Errors: UserError for a joint that joint_map must name and cannot.
std::string StarterHandScenario(const HandModel& hand, const StarterHand& starter,
                                const std::string& model) {
  const HandConfig& config = starter.config;
  std::string text = fmt::format(
      "# Starter scenario for {}, written by gauntlet inspect. Check the joint map{}.\n"
      "question: Which filter does this hand follow best?\n"
      "seed: 1\n"
      "glove:\n"
      "  motion: {{kind: random, duration_s: 10, bandwidth_hz: 0.7, range_percent: 60}}\n"
      "hand:\n"
      "  model_path: {}\n",
      OneLine(model), starter.assumed.empty() ? "" : " and the assumed numbers", YamlText(model));
  const MotorConfig& motor = config.motor;
  if (!starter.assumed.empty()) {
    text +=
        "  motor:\n    # Assumed where the model has no number (or too small a rotor): XL330-M288 "
        "at 5 V.\n";
    const std::pair<const char*, const std::vector<double>&> lists[] = {
        {"stall_torque_nm", motor.stall_torque_nm},
        {"rotor_inertia_kg_m2", motor.rotor_inertia_kg_m2},
        {"dry_friction_nm", motor.dry_friction_nm},
        {"drum_radius_mm", motor.drum_radius_mm}};
    for (const auto& [key, values] : lists) {
      if (!values.empty()) text += fmt::format("    {}: {}\n", key, ListText(values));
    }
  }
  if (config.cable.stiffness_n_m > 0.0) {
    text += fmt::format("  cable: {{stiffness_n_m: {}, pretension_mm: {}}}  # assumed\n",
                        config.cable.stiffness_n_m, config.cable.pretension_mm);
  }
  if (config.servo.numbers().inertia_scale == 1.0) {
    text += fmt::format("  servo: {{kind: {}, inertia_scale: 1, friction_scale: 1}}\n",
                        config.servo.kind());
  }
  const std::vector<JointStart> starts = StarterJoints(hand);
  bool has_map = false;
  for (std::size_t i = 0; i < starts.size(); ++i) {
    const JointStart& start = starts[i];
    if (start.channel == hand.joint_names()[i] && start.weight == 1.0) continue;  // as without it
    if (!std::exchange(has_map, true)) text += "joint_map:\n";
    const std::string& name = hand.joint_names()[i];
    CheckKey(name);
    const std::string why = start.why.empty() ? "" : "  # " + start.why;
    text += start.channel.empty()
                ? fmt::format("  {}: {{channels: [], offset_deg: {:.4g}}}{}\n", name,
                              start.offset_deg, why)
                : fmt::format("  {}: {{channels: [{}], weights: [{:.3g}], offset_deg: {:.4g}}}{}\n",
                              name, start.channel, start.weight, start.offset_deg, why);
  }
  text +=
      "controllers:\n"
      "  raw:\n"
      "    filter: none\n"
      "  mean_20:\n"
      "    filter: {kind: moving_average, window: 20}\n"
      "  tuned_kalman:\n"
      "    filter: {kind: kalman, q: 0.01}\n"
      "  prediction:\n"
      "    filter: none\n"
      "    prediction: {kind: adaptive, horizon_ms: 75, r_deg2: 0.8}\n";
  return text;
}

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
  constexpr const char* kNames[] = {"cables", "direct", "linkage"};
  return kNames[static_cast<std::size_t>(TransmissionOf(drive))];
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
