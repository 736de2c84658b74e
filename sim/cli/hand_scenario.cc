#include "sim/cli/hand_scenario.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <iterator>
#include <utility>

#include "sim/base/channels.h"
#include "sim/base/error.h"
#include "sim/base/signal.h"
#include "sim/base/text.h"
#include "sim/recordings/inspect/joint_names.h"
#include "sim/recordings/inspect/starter_files.h"
#include "sim/tables/name_words.h"

namespace gauntlet::sim {
namespace {

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

}  // namespace

StarterHand MakeStarterHand(const std::filesystem::path& model) {
  StarterHand starter;
  HandConfig& config = starter.config;
  config.model_path = model.string();
  std::vector<double> stall, rotor, friction;
  bool lacks_stall = false, lacks_rotor = false, lacks_drum = false;
  for (const MotorInModel& motor : ReadMotors(model)) {
    if (motor.has_spool) return {.config = config, .assumed = {}};
    lacks_drum = lacks_drum || motor.pulls_cable;
    lacks_stall = lacks_stall || !(motor.stall_torque_nm > 0.0);
    const double lever = motor.pulls_cable ? 1e-3 * kDrumRadiusMm : 1.0;
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
  if (lacks_drum) {
    config.motor.drum_radius_mm = {kDrumRadiusMm};
    config.cable.stiffness_n_m = kCableStiffnessNM;
    config.cable.pretension_mm = kPretensionMm;
    starter.assumed.emplace_back("hand.motor.drum_radius_mm");
    starter.assumed.emplace_back("hand.cable.stiffness_n_m");
  }
  // The kinds of servo have factors on the small motors of models/: these numbers are whole.
  ServoNumbers& servo = config.servo.numbers();
  servo.inertia_scale = servo.friction_scale = 1.0;
  return starter;
}

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

}  // namespace gauntlet::sim
