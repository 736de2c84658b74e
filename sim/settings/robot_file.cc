#include "sim/settings/robot_file.h"

#include <fmt/format.h>

#include <array>
#include <set>
#include <string_view>
#include <utility>
#include <vector>

#include "controller/controller.h"
#include "controller/robot_text.h"
#include "controller/validate.h"
#include "sim/base/error.h"
#include "sim/base/text.h"
#include "sim/settings/robot_constants.h"
#include "sim/settings/yaml_reader.h"
#include "sim/settings/yaml_writer.h"

namespace gauntlet::sim {
namespace {

using controller::RobotConfig;
using controller::SettingError;

std::string Header(const RobotConfig& robot, const RobotOrigin& origin) {
  const std::string every = TicksPerSampleText(robot.timing);
  return fmt::format(
      R"(# Controller {controller} of scenario {scenario} (hand model {hash}), written by
# gauntlet {version} export. Angles in rad; values have all digits. On the robot (CMake:
# find_package(gauntlet COMPONENTS settings), link gauntlet::settings):
#
#   #include "controller/controller.h"
#   #include "sim/settings/robot_file.h"
#
#   const auto robot = gauntlet::sim::LoadRobot("{file}");
#   gauntlet::controller::Controller controller(robot);
#   std::vector<double> counts(robot.glove.channel_names.size());
#   while (running) {{  // {rate:.6g} times per second; {fresh}
#     const bool fresh = ReadGlove(counts);
#     const auto command = fresh ? controller.Step({{.counts = counts}}) : controller.Step();
#     if (command.event) SendToMotors(command.motor_counts);
#   }}
)",
      fmt::arg("controller", origin.controller), fmt::arg("file", origin.file),
      fmt::arg("scenario", OneLine(origin.scenario)), fmt::arg("hash", origin.model_hash),
      fmt::arg("version", origin.gauntlet_version), fmt::arg("rate", robot.timing.tick_rate_hz),
      fmt::arg("fresh", every == "1" ? "each time with a new sample of the glove"
                                     : fmt::format("a new sample every {} times", every)));
}

/// The keys that Controller's constructor names, as the file has them.
std::string KeyInFile(const std::string& key) {
  static constexpr std::array<std::pair<std::string_view, std::string_view>, 11> kKeys = {{
      {"calibration", "glove"},
      {"transmission.motor_of_joint", "hand.joints"},
      {"transmission.joint_min_rad", "hand.joints"},
      {"transmission.counts_per_rad", "hand.motors"},
      {"transmission.center_counts", "hand.motors"},
      {"transmission.min_counts", "hand.motors"},
      {"transmission.max_counts", "hand.motors"},
      {"transmission", "hand"},
      {"joint_map", "joint_map"},
      {"timing", "timing"},
      {"", "controller."},
  }};
  for (const auto& [theirs, ours] : kKeys) {
    if (key.starts_with(theirs)) return std::string(ours) + key.substr(theirs.size());
  }
  return key;
}

void CheckNames(const std::vector<std::string>& names, const char* key) {
  std::set<std::string> seen;
  for (const std::string& name : names) {
    if (!seen.insert(name).second) throw SettingError(key, name + " is given twice");
  }
}

/// Errors: SettingError with the key as the file has it.
void CheckMakesController(const RobotConfig& robot) {
  CheckNames(robot.glove.channel_names, "glove.channel_names");
  CheckNames(robot.hand.joint_names, "hand.joint_names");
  CheckNames(robot.hand.motor_names, "hand.motor_names");
  try {
    const controller::Controller made(robot);
  } catch (const SettingError& error) {
    throw SettingError(KeyInFile(error.key()), error.problem());
  }
}

}  // namespace

std::string RobotToYaml(const RobotConfig& robot, const RobotOrigin& origin) {
  RobotConfig copy = robot;  // a visitor may change what it sees
  return Header(robot, origin) +
         SettingsToYamlForPeople([&copy](auto& visitor) { copy.Visit(visitor); });
}

RobotConfig LoadRobot(const std::filesystem::path& file) {
  return ParseRobot(file, ReadYamlText(file));
}

RobotConfig ParseRobot(const std::filesystem::path& file, std::string_view text) {
  if (file.extension() == ".txt") {
    try {
      return controller::RobotFromText(text);
    } catch (const SettingError& error) {
      throw UserError({.place = file.string(), .key = error.key(), .problem = error.problem()});
    }
  }
  const YamlNode root = ParseYaml(file, text);
  const YamlSource source{.file = file, .overrides = {}};
  RobotConfig robot;
  ReadAll(root, source, robot);
  try {
    CheckMakesController(robot);
  } catch (const SettingError& error) {
    throw UserError({.place = source.PlaceOf(NodeAt(root, error.key()), ""),
                     .key = error.key(),
                     .problem = error.problem()});
  }
  return robot;
}

std::vector<std::string> ProblemsOfRobot(const std::filesystem::path& file,
                                         const std::optional<std::string>& text) {
  std::vector<std::string> lines;
  try {
    const std::string content = text ? *text : ReadYamlText(file);
    if (file.extension() == ".txt") return controller::ProblemsOfText(content);
    const YamlNode root = ParseYaml(file, content);
    const YamlSource source{.file = file, .overrides = {}};
    RobotConfig robot;
    ReadAll(root, source, robot);
    for (const controller::RobotProblem& problem : controller::Validate(robot)) {
      lines.push_back(source.PlaceOf(NodeAt(root, problem.key), "") + ": " + TextOf(problem));
    }
  } catch (const UserError& error) {
    lines = {error.what()};
  }
  return lines;
}

}  // namespace gauntlet::sim
