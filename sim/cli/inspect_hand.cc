#include "sim/cli/inspect_hand.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "sim/base/channels.h"
#include "sim/base/signal.h"
#include "sim/cli/standard_streams.h"
#include "sim/hand/hand_model.h"

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

std::size_t WidthOf(const std::vector<std::string>& names) {
  std::size_t width = 5;
  for (const std::string& name : names) width = std::max(width, name.size());
  return width;
}

}  // namespace

bool IsHandFile(const std::filesystem::path& file) {
  const std::string ending = file.extension().string();
  return ending == ".xml" || ending == ".mjcf";
}

void PrintHand(const std::filesystem::path& file) {
  HandConfig config;
  config.model_path = std::filesystem::absolute(file).string();
  const HandModel hand(config);
  const controller::TendonTransmission& transmission = hand.transmission();
  Print("{}: a hand of {} motors, {} cables and {} joints; MuJoCo {}\n\n", file.string(),
        hand.motor_names().size(), hand.cable_names().size(), hand.joint_names().size(),
        HandModel::EngineVersion());
  const std::size_t motor_width = WidthOf(hand.motor_names());
  Print("{:<{}}  drum mm  stall N m  cables\n", "motor", motor_width);
  for (const Drive& drive : hand.drives()) {
    std::vector<std::string> cables;
    for (const Cable& cable : drive.cables) cables.push_back(cable.name);
    Print("{:<{}}  {:>7.3g}  {:>9.3g}  {}\n", drive.name, motor_width, 1e3 * drive.drum_radius_m,
          drive.servo.stall_torque_nm, fmt::join(cables, ", "));
  }
  const std::size_t joint_width = WidthOf(hand.joint_names());
  Print("\n{:<{}}  range deg      turned by\n", "joint", joint_width);
  std::vector<std::string> without_channel;
  const std::vector<std::string> channels = KnownChannelNames();
  for (std::size_t i = 0; i < hand.joints().size(); ++i) {
    const HandJoint& joint = hand.joints()[i];
    Print("{:<{}}  {:>5.0f} .. {:<5.0f} {}\n", joint.name, joint_width, joint.min_rad * kDegPerRad,
          joint.max_rad * kDegPerRad, TurnedBy(transmission, i));
    if (std::ranges::find(channels, joint.name) == channels.end()) {
      without_channel.push_back(joint.name);
    }
  }
  if (hand.engine_measures_cables()) {
    Print("\nMuJoCo has to follow its cables through space, which takes most of a step.\n");
  }
  if (!without_channel.empty()) {
    Print("\nNo channel of a glove is called like {}: a scenario's joint_map moves them.\n",
          fmt::join(without_channel, ", "));
  }
  Print("\nA scenario takes it by hand: {{model_path: {}}}\n", file.string());
}

}  // namespace gauntlet::sim
