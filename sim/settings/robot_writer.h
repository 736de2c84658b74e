#pragma once

#include <string>

#include "controller/controller_config.h"

namespace gauntlet::sim {

/// Every setting of the robot, as YAML for people: what is known of glove and hand stands in tables
/// with aligned columns, the rest as SettingsToYaml() writes it.
std::string RobotSettingsToYaml(const controller::RobotConfig& robot);

}  // namespace gauntlet::sim
