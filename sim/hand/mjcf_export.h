#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "sim/hand/hand_model.h"

namespace gauntlet::sim {

/// A file that a model reads: where it is, and its path beside the exported model.
struct ModelAsset {
  std::filesystem::path source;
  std::filesystem::path target;
};

/// A hand for any MuJoCo from 2.2.2 on.
struct ExportedMjcf {
  std::string text;
  std::vector<ModelAsset> assets;
  std::vector<std::string> notes;  // what the text cannot express, a sentence each
};

/// Writes the hand as one MJCF text without Gauntlet: no includes, no spools. Each cable is its
/// spatial tendon, which an actuator of the cable's name pulls; a motor without cables is an
/// actuator on its joint or tendon. The control is the angle of the motor [rad], 0 where all joints
/// are in the middle of their ranges; positive winds the flexor and pays out the extensor:
///
///     pull   = k stretch + d d(length)/dt, within 0 .. stall torque / drum radius   [N]
///     torque = gain (control - shaft) - damping d(shaft)/dt, within the stall torque [N m]
///
/// Inertias, springs and dampers of all joints are those that a trial of Gauntlet has, with the
/// rotors of motors without cables. The keyframe `middle` is the posture of control 0.
/// `name`: for the first lines. `asset_folder`: relative, for meshes and pictures.
/// Errors: as of ReadModelText().
ExportedMjcf ExportMjcf(const HandModel& hand, const std::string& name,
                        const std::filesystem::path& asset_folder);

}  // namespace gauntlet::sim
