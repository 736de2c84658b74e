#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "controller/controller_config.h"

namespace gauntlet::sim {

/// Origin of a robot file, for the people who read it.
struct RobotOrigin {
  std::string gauntlet_version;
  std::string scenario;
  std::string controller;
  std::string model_hash;  // of the simulated hand
  std::string file = {};   // name of the file that is written
};

/// Everything that a Controller is made from, as one YAML file: a table of the glove's channels, of
/// the hand's joints and motors, and the coupling as a matrix with a row per motor. LoadRobot()
/// reads it back to the same values, bit for bit. A comment at its head says where it comes from
/// and how a robot's program loads it.
std::string RobotToYaml(const controller::RobotConfig& robot, const RobotOrigin& origin);

/// Reads what `gauntlet export` wrote, or a person changed since; a file that ends in .txt is one
/// of `gauntlet export --text`. The result is known to make a Controller.
/// Errors: UserError with file:line:column (of a text: the line) and key for what is unknown, given
/// twice, missing, of a wrong type, out of range, or does not fit to the rest.
controller::RobotConfig LoadRobot(const std::filesystem::path& file);
/// Robot from the text of a file.
controller::RobotConfig ParseRobot(const std::filesystem::path& file, std::string_view text);

/// All problems of such a file, or of its text, a line each (see controller::Validate()); of one
/// that cannot be read, or has values outside their ranges, the first error.
std::vector<std::string> ProblemsOfRobot(const std::filesystem::path& file,
                                         const std::optional<std::string>& text = {});

}  // namespace gauntlet::sim
