#pragma once

#include <string>

#include "controller/controller_config.h"
#include "sim/settings/robot_file.h"

namespace gauntlet::sim {

/// The settings of RobotToYaml() as a C++ header of constants, for a robot that reads no files: it
/// needs gauntlet::controller only. `robot::Settings()` gives them back, bit for bit.
std::string RobotToHeader(const controller::RobotConfig& robot, const RobotOrigin& origin);

/// The same as text, which controller::RobotFromText() and gauntlet_controller_create() read.
std::string RobotToText(const controller::RobotConfig& robot, const RobotOrigin& origin);

/// What embedded::Controller runs, as a C++ header of constants in `float`: `robot::Controller` is
/// made of `robot::kSettings`. Errors: SettingError for what the embedded form does not hold.
std::string RobotToEmbeddedHeader(const controller::RobotConfig& robot, const RobotOrigin& origin);

}  // namespace gauntlet::sim
