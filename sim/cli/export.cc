
#include <algorithm>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "sim/base/error.h"
#include "sim/base/manifest.h"
#include "sim/base/nearest_name.h"
#include "sim/base/output_file.h"
#include "sim/cli/commands.h"
#include "sim/cli/out_option.h"
#include "sim/cli/standard_streams.h"
#include "sim/cli/study_command.h"
#include "sim/scenario/scenario.h"
#include "sim/scenario/scenario_reader.h"
#include "sim/settings/robot_constants.h"
#include "sim/settings/robot_file.h"
#include "sim/study/study.h"

namespace gauntlet::sim {
namespace {

struct ExportOptions {
  std::string folder;
  std::string controller;
  std::string out;  // empty: NAME.robot.yaml (or another ending) in the folder
  bool header = false;
  bool text = false;
  bool embedded = false;
};

const NamedController& Find(const Scenario& scenario, const std::string& name) {
  const auto found = std::ranges::find(scenario.controllers, name, &NamedController::name);
  if (found != scenario.controllers.end()) return *found;
  std::vector<std::string> known;
  for (const NamedController& named : scenario.controllers) known.push_back(named.name);
  throw UserError(
      {.place = "--controller " + name, .problem = "unknown controller" + Suggestion(name, known)});
}

std::filesystem::path TargetOf(const ExportOptions& options) {
  const std::filesystem::path folder = options.folder;
  if (options.out.empty()) {
    const char* ending = options.header     ? ".robot.h"
                         : options.text     ? ".robot.txt"
                         : options.embedded ? ".embedded.robot.h"
                                            : ".robot.yaml";
    return folder / (options.controller + ending);
  }
  std::error_code none;
  if (std::filesystem::equivalent(options.out, folder / "scenario.resolved.yaml", none)) {
    throw UserError({.place = "--out " + options.out, .problem = "is the scenario itself"});
  }
  return options.out;
}

std::string ContentOf(const ExportOptions& options, const controller::RobotConfig& robot,
                      const RobotOrigin& origin) {
  if (options.header) return RobotToHeader(robot, origin);
  if (options.text) return RobotToText(robot, origin);
  if (options.embedded) {
    try {
      return RobotToEmbeddedHeader(robot, origin);
    } catch (const controller::SettingError& error) {
      throw UserError({.place = "--controller " + options.controller,
                       .key = error.key(),
                       .problem = error.problem()});
    }
  }
  return RobotToYaml(robot, origin);
}

void RunExport(const ExportOptions& options) {
  const Manifest manifest(options.folder);
  const Scenario scenario = LoadScenario(manifest.Checked("scenario.resolved.yaml"), {});
  const NamedController& named = Find(scenario, options.controller);
  const HandModel hand(scenario.hand, TimingOf(scenario));
  WarnIfUnchecked(options.folder, manifest.exists());
  WarnIfMadeElsewhere(scenario.made_with, hand, "the file is for the hand as it is now");
  const std::filesystem::path target = TargetOf(options);
  MakeDirectoryOf(target);
  const controller::RobotConfig robot = RobotOf(scenario, hand, named.config);
  const RobotOrigin origin{.gauntlet_version = GAUNTLET_VERSION,
                           .scenario = scenario.name,
                           .controller = named.name,
                           .model_hash = hand.Hash()};
  WriteOutputFile(target, ContentOf(options, robot, origin));
  Say("wrote {}\n", target.string());
}

}  // namespace

void AddExportCommand(CLI::App& app) {
  CLI::App* command = app.add_subcommand(
      "export", "All that a controller on the robot needs, as one file that its program loads");
  const auto options = std::make_shared<ExportOptions>();
  command->add_option("folder", options->folder, "output folder of run or compare")->required();
  command->add_option("--controller", options->controller, "which controller of the scenario")
      ->type_name("NAME")
      ->required();
  AddOutOption(*command, options->out, "file to write [NAME.robot.yaml in the folder]", "FILE");
  CLI::Option* header = command->add_flag(
      "--header", options->header,
      "write a C++ header of constants [NAME.robot.h], for a robot that reads no files");
  CLI::Option* text =
      command
          ->add_flag("--text", options->text,
                     "write plain text [NAME.robot.txt], for C, Python, MATLAB and others")
          ->excludes(header);
  command
      ->add_flag("--embedded", options->embedded,
                 "write a C++ header for a microcontroller, in float [NAME.embedded.robot.h]")
      ->excludes(header)
      ->excludes(text);
  command->footer(
      "\nThe file holds the controller's settings, the calibration of the glove that its trials "
      "used, the\n"
      "joint map, the hand's motors and coupling, and the clocks. Its first lines tell how a "
      "program loads it.\n"
      "\nExample:\n  gauntlet export out/door_opening --controller tuned_kalman --out "
      "robot.yaml\n");
  command->callback([options] { RunExport(*options); });
}

}  // namespace gauntlet::sim
