#pragma once

#include <string>

#include "controller/controller_config.h"
#include "sim/settings/robot_file.h"

namespace gauntlet::sim {

/// The settings of RobotToYaml() as text with all digits, which controller::RobotFromText() and
/// gauntlet_controller_create() read.
std::string RobotToText(const controller::RobotConfig& robot, const RobotOrigin& origin);

/// Steps of the loop from one sample of the glove to the next, also where that is a fraction.
std::string TicksPerSampleText(const controller::Timing& timing);

/// Settings of embedded::Controller, as a C++ header of constants in `float`: `robot::Controller`
/// is made of `robot::kSettings`. Errors: SettingError for what the embedded form does not hold.
std::string RobotToEmbeddedHeader(const controller::RobotConfig& robot, const RobotOrigin& origin);

}  // namespace gauntlet::sim
