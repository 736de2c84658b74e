#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "sim/hand/hand_model.h"

namespace gauntlet::sim {

/// The hand of a model file with numbers for what the file does not say of its motors.
struct StarterHand {
  HandConfig config;
  std::vector<std::string> assumed;  // keys whose values are not those of the file
};
/// Assumed are the numbers of an XL330-M288: stall torque, rotor in proportion to it, gear.
StarterHand MakeStarterHand(const std::filesystem::path& model);

/// Source of the angle of a joint.
struct JointStart {
  std::string channel;  // empty: held
  double weight = 1.0;
  double offset_deg = 0.0;
  std::string why;
};
/// Start of each joint of the hand, from its name, its place in the finger and its range.
std::vector<JointStart> StarterJoints(const HandModel& hand);

/// A scenario that moves the hand at random. `model`: its path in the scenario.
/// Errors: UserError for a joint that joint_map must name and cannot.
std::string StarterHandScenario(const HandModel& hand, const StarterHand& starter,
                                const std::string& model);

}  // namespace gauntlet::sim
