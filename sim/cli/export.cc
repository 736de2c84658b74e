
#include <filesystem>
#include <string>
#include <variant>
#include <vector>

#include "sim/base/error.h"
#include "sim/base/manifest.h"
#include "sim/base/output_file.h"
#include "sim/cli/commands.h"
#include "sim/cli/shared_options.h"
#include "sim/cli/standard_streams.h"
#include "sim/cli/study_command.h"
#include "sim/scenario/scenario.h"
#include "sim/scenario/scenario_reader.h"
#include "sim/settings/robot_constants.h"
#include "sim/settings/robot_file.h"
#include "sim/study/prediction_fit.h"
#include "sim/study/study.h"

namespace gauntlet::sim {
namespace {

struct ExportOptions {
  static constexpr auto kName = "export";
  static constexpr auto kPurpose = "Write a controller's settings for the robot";
  std::string folder;
  std::string controller;
  std::string out;  // empty: NAME.robot.yaml (or another ending) in the folder
  bool header = false;
  bool text = false;
  bool embedded = false;

  Options Rows() {
    return {
        Argument("folder", &folder, Offer::kFolders, "output folder of run or compare"),
        Option("--controller", &controller,
               {.value = "NAME", .offer = Offer::kControllers, .required = true},
               "which controller of the scenario"),
        OutOption(out, "file to write [NAME.robot.yaml in the folder]", "FILE"),
        Option("--header", &header, {},
               "write a C++ header of constants [NAME.robot.h], for a robot that reads no files"),
        Option("--text", &text, {.excludes = {"--header"}},
               "write plain text [NAME.robot.txt], for C, Python, MATLAB and others"),
        Option("--embedded", &embedded, {.excludes = {"--header", "--text"}},
               "write a C++ header for a microcontroller, in float [NAME.embedded.robot.h]"),
    };
  }

  static constexpr auto kNotes = R"(
The file holds the controller's settings, the calibration of the glove that its trials used, the
joint map, the hand's motors and coupling, and the clocks. Its first lines tell how a program loads it.

Example:
  gauntlet export out/door_opening --controller tuned_kalman --out robot.yaml
)";
};

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

/// Fits what is still to be fitted, to all repetitions of the scenario.
controller::ControllerConfig ForRobot(const Scenario& scenario,
                                      const controller::ControllerConfig& config) {
  if (!std::holds_alternative<controller::FittedToOthersPredictionConfig>(
          config.prediction.settings)) {
    return config;
  }
  Say("gauntlet: its prediction is fitted to all repetitions of the scenario\n");
  return ControllerForRobot(PrepareStudy(scenario), config);
}

void RunExport(const ExportOptions& options) {
  const Manifest manifest(options.folder);
  const Scenario scenario = LoadScenario(manifest.Checked("scenario.resolved.yaml"), {});
  const NamedController& named = FindController(scenario, options.controller);
  const HandModel hand(scenario.hand, TimingOf(scenario));
  WarnIfUnchecked(options.folder, manifest.exists());
  WarnIfMadeElsewhere(scenario.made_with, hand, "the file is for the hand as it is now");
  const std::filesystem::path target = TargetOf(options);
  MakeDirectoryOf(target);
  const controller::RobotConfig robot = RobotOf(scenario, hand, ForRobot(scenario, named.config));
  const RobotOrigin origin{.gauntlet_version = GAUNTLET_VERSION,
                           .scenario = scenario.name,
                           .controller = named.name,
                           .model_hash = hand.Hash()};
  WriteOutputFile(target, ContentOf(options, robot, origin));
  Say("wrote {}\n", target.string());
}

}  // namespace

Command MakeExportCommand() { return MakeCommand(RunExport); }

}  // namespace gauntlet::sim
