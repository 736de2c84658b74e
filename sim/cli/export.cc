#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "controller/embedded/embedded_settings.h"
#include "controller/joint_map.h"
#include "controller/validate.h"
#include "sim/base/error.h"
#include "sim/base/input_file.h"
#include "sim/base/manifest.h"
#include "sim/base/output_file.h"
#include "sim/base/signal.h"
#include "sim/cli/commands.h"
#include "sim/cli/export_lines.h"
#include "sim/cli/shared_options.h"
#include "sim/cli/standard_streams.h"
#include "sim/hand/hand_model.h"
#include "sim/hand/mjcf_export.h"
#include "sim/settings/libraries/library.h"
#include "sim/settings/robot_constants.h"
#include "sim/settings/robot_file.h"
#include "sim/study/made_with.h"
#include "sim/study/prediction_fit.h"
#include "sim/study/recorded_units.h"
#include "sim/study/scenario/scenario.h"
#include "sim/study/scenario/scenario_reader.h"
#include "sim/study/study.h"
#include "sim/trial/external/external_filters.h"

namespace gauntlet::sim {
namespace {

struct ExportOptions {
  static constexpr auto kName = "export";
  static constexpr auto kPurpose = "Write a controller for the robot, or the hand";
  static constexpr auto kGroup = Group::kEveryday;
  std::string folder;
  std::string controller;
  std::string out;  // empty: NAME.robot.yaml (or another ending) in the folder
  bool text = false;
  bool embedded = false;
  bool mjcf = false;
  bool settle = false;
  std::optional<double> tick_rate_hz;  // none: as in the trials
  LinesRequest lines;                  // its library is empty without --for

  Options Rows() {
    return {
        Argument("folder", &folder, Offer::kFolders, "output folder of run or compare"),
        Option("--controller", &controller, {.value = "NAME", .offer = Offer::kControllers},
               "which controller of the scenario; needed without --mjcf"),
        OutOption(out, "file to write [NAME.robot.yaml in the folder]", "FILE"),
        Option("--text", &text, {},
               "write plain text [NAME.robot.txt], for C, Python, MATLAB and others"),
        Option("--embedded", &embedded, {.excludes = {"--text"}},
               "write a C++ header for a microcontroller, in float [NAME.embedded.robot.h]"),
        Option("--mjcf", &mjcf, {.excludes = {"--controller", "--text", "--embedded"}},
               "write the hand as one MJCF file for any MuJoCo [hand.mjcf.xml]"),
        Option("--settle", &settle, {.needs = {"--embedded"}},
               "replace filters that a microcontroller cannot run by what they settle to"),
        Option("--tick-rate-hz", &tick_rate_hz,
               {.value = "HZ", .range = {1e-3, 1e6}, .excludes = {"--mjcf"}},
               "steps per second of the robot's loop [as in the trials: the glove's rate times a "
               "whole number, about 1000]"),
        Option("--for", &lines.library,
               {.choices = AllNames(Libraries()),
                .excludes = {"--text", "--embedded", "--mjcf", "--tick-rate-hz"}},
               "print the filter alone, as lines of this library or language"),
        Option("--exact", &lines.exact, {.needs = {"--for"}},
               "fail where the library does not have the filter; else the closest that it has is "
               "tuned"),
        UnitOption(
            lines.unit, {"deg", "rad", "counts"},
            "unit of the signal there, with --for [that of the recording's columns, else deg]"),
        Option("--channel", &lines.channel, {.offer = Offer::kChannels, .needs = {"--for"}},
               "the channel whose settings and scale the lines have [all]"),
    };
  }

  static constexpr auto kNotes = R"(
The file contains the controller's settings, the calibration of the glove, the joint map, the
hand's motors and coupling, and the clocks. The calibration is that of the trials: the calibration
file of the controller, else the column map of a recording in counts, else the simulated glove.
The first lines contain warnings about it, the joints without a sensor, and how to load the file.
A recording that is not in counts gives a robot that takes what its columns hold, as degrees.

The robot's loop must step at the rate in the file (timing.tick_rate_hz). A glove of another rate
needs no whole number of steps between two samples.

--mjcf writes no controller but the hand, for simulation without Gauntlet. Its cables are spatial
tendons of MuJoCo with an actuator each; meshes stand beside the file in a folder of its name.

With --for the filter is printed (with --out, written) for a program outside Gauntlet: at the rate
of the scenario, with the version of the library and what differs there. Where the library does not
have the filter, the closest that it has is tuned for the scenario (a small search over six seeds),
and the price is said: its scores beside those of the filter in its place, over the same seeds.

Examples:
  gauntlet export out/door_opening --controller tuned_kalman --out robot.yaml
  gauntlet export out/door_opening --mjcf --out hand.xml
  gauntlet export out/door_opening --controller tuned_kalman --embedded --settle
  gauntlet export out/my_hand --controller one_euro --for oneeurofilter
)";
};

/// Errors: UserError for a file that no export wrote: a person's own, named by mistake.
void RefuseForeign(const std::filesystem::path& target) {
  constexpr std::size_t kHead = 4096;
  std::string head(kHead, '\0');
  std::ifstream file(target, std::ios::binary);
  if (!file) return;
  file.read(head.data(), kHead);
  head.resize(static_cast<std::size_t>(file.gcount()));
  const std::size_t name = head.find("gauntlet ");
  if (head.empty() || (name != std::string::npos && head.find("export", name) != head.npos)) return;
  throw UserError({.place = "--out " + target.string(),
                   .problem = "is a file that gauntlet export did not write, and stays; name "
                              "another"});
}

std::filesystem::path TargetOf(const ExportOptions& options) {
  const std::filesystem::path folder = options.folder;
  if (options.out.empty()) {
    if (options.mjcf) return folder / "hand.mjcf.xml";
    const char* ending = options.text       ? ".robot.txt"
                         : options.embedded ? ".embedded.robot.h"
                                            : ".robot.yaml";
    return folder / (options.controller + ending);
  }
  std::error_code none;
  if (std::filesystem::equivalent(options.out, folder / "scenario.resolved.yaml", none)) {
    throw UserError({.place = "--out " + options.out, .problem = "is the scenario itself"});
  }
  RefuseForeign(options.out);
  return options.out;
}

std::string ContentOf(const ExportOptions& options, const controller::RobotConfig& robot,
                      const RobotOrigin& origin) {
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

/// Adds `name` to the group of `key`.
using Groups = std::vector<std::pair<std::string, std::string>>;
void AddTo(Groups& groups, const std::string& key, const std::string& name) {
  const auto found = std::ranges::find(groups, key, &Groups::value_type::first);
  if (found == groups.end()) {
    groups.emplace_back(key, name);
  } else {
    found->second += ", " + name;
  }
}

/// The parts of the file that are no measurement of the user's glove, and the joints without a
/// sensor: a sentence each.
std::vector<std::string> NotesOf(const GloveConfig& config, const controller::RobotConfig& robot,
                                 const RecordedUnits& recorded) {
  const bool is_calibrated =
      robot.controller.linearisation.kind != controller::LinearisationKind::kGlove;
  std::vector<std::string> notes;
  Groups assumed, simulated, held;
  for (std::size_t i = 0; i < robot.glove.channel_names.size(); ++i) {
    const std::string& name = robot.glove.channel_names[i];
    const auto own = std::ranges::find(config.calibration, name, &OwnCalibration::channel);
    if (own == config.calibration.end()) {
      const std::string counts =
          fmt::format("{:g} to {:g}", robot.glove.low_counts[i], robot.glove.high_counts[i]);
      if (!is_calibrated && recorded.units.empty()) AddTo(simulated, counts, name);
    } else if (!own->assumed.empty()) {
      AddTo(assumed, own->assumed, name);
    }
  }
  for (const auto& [counts, names] : simulated) {
    notes.push_back(
        fmt::format("warning: the calibration is that of the simulated glove ({} counts over the "
                    "joint's range): {}. Calibrate your glove (gauntlet calibrate)",
                    counts, names));
  }
  for (const auto& [words, names] : assumed) {
    notes.push_back(fmt::format(
        "warning: the column map assumes {} of {}. Confirm it with the row all,confirmed{}", words,
        names, is_calibrated ? "; the calibration file decides the range" : ""));
  }
  if (!recorded.assumptions.empty()) notes.push_back("warning: " + recorded.assumptions);
  if (!recorded.units.empty()) notes.push_back(recorded.units);
  for (const controller::RobotProblem& problem : controller::Validate(robot)) {
    notes.push_back(TextOf(problem));
  }
  const controller::JointMap map(robot.joint_map, robot.glove.channel_names, robot.hand);
  for (int joint = 0; joint < map.joint_count(); ++joint) {
    if (map.measured(joint)) continue;
    AddTo(held, fmt::format("{:.4g} deg", map.offset_rad(joint) * kDegPerRad),
          robot.hand.joint_names[static_cast<std::size_t>(joint)]);
  }
  std::string text;
  for (const auto& [angle, names] : held) {
    text += fmt::format("{} {}: {}", text.empty() ? "" : ";", angle, names);
  }
  if (!text.empty()) notes.push_back("joints without a sensor hold an angle:" + text);
  return notes;
}

/// Fits what is still to be fitted, to all replicates of the scenario.
controller::ControllerConfig ForRobot(const Scenario& scenario,
                                      const controller::ControllerConfig& config) {
  if (!std::holds_alternative<controller::FittedToOthersPredictionConfig>(
          config.prediction.settings)) {
    return config;
  }
  const Study study = PrepareStudy(scenario);
  Say("gauntlet: its prediction has weights that are fitted to the {} motions of {}\n",
      MotionCount(study), scenario.name);
  return ControllerForRobot(study, config);
}

void WriteMjcf(const Scenario& scenario, const HandModel& hand,
               const std::filesystem::path& target) {
  const std::filesystem::path folder = target.stem().string() + "_files";
  const ExportedMjcf exported = ExportMjcf(hand, scenario.name, folder);
  OutputFile file(target);  // refused before anything is written
  for (const ModelAsset& asset : exported.assets) {
    std::ifstream stream(InputFile(asset.source), std::ios::binary);
    const std::string content(std::istreambuf_iterator<char>(stream), {});
    MakeDirectoryOf(target.parent_path() / asset.target);
    WriteOutputFile(target.parent_path() / asset.target, content);
  }
  file.Write(exported.text);
  file.Commit();
  for (const std::string& note : hand.notes()) Say("gauntlet: {}\n", note);
  for (const std::string& note : exported.notes) Say("gauntlet: {}\n", note);
  Say("wrote {}\n", target.string());
}

/// Changes `robot` to the loop and the processor of the options; a note for each change.
std::vector<std::string> Adapt(const ExportOptions& options, controller::RobotConfig& robot) {
  std::vector<std::string> notes;
  controller::Timing& timing = robot.timing;
  if (options.tick_rate_hz) {
    try {
      timing = WithTickRate(timing, *options.tick_rate_hz);
    } catch (const controller::SettingError& error) {
      throw UserError({.place = "--tick-rate-hz", .problem = error.problem()});
    }
  } else if (constexpr double kUsual_hz = 1000.0; timing.tick_rate_hz != kUsual_hz) {
    notes.push_back(
        fmt::format("the robot's loop must step {:.6g} times per second, {} times per sample of a "
                    "glove of {:.6g} Hz; --tick-rate-hz chooses another rate",
                    timing.tick_rate_hz, timing.ticks_per_sample, timing.sample_rate_hz()));
  }
  if (options.settle) {
    std::vector<std::string> replaced;
    robot.controller = Settled(robot, replaced);
    for (const std::string& one : replaced) {
      notes.push_back("--settle replaces " + one +
                      "; its commands differ from those of the trials");
    }
  }
  return notes;
}

void PrintLines(const Scenario& scenario, const ExportOptions& options) {
  LinesRequest request = options.lines;
  request.folder = options.folder;
  request.controller = options.controller;
  const std::string lines = LinesOf(scenario, request);
  if (options.out.empty()) {
    PrintText(lines);
    return;
  }
  const std::filesystem::path target = TargetOf(options);
  MakeDirectoryOf(target);
  WriteOutputFile(target, lines);
  Say("wrote {}\n", target.string());
}

void RunExport(const ExportOptions& options) {
  if (options.controller.empty() && !options.mjcf) {
    throw UserError("--controller is required; see gauntlet export --help");
  }
  const Manifest manifest(options.folder);
  const Scenario scenario = LoadScenario(manifest.Checked("scenario.resolved.yaml"), {});
  const NamedController* const named =
      options.mjcf ? nullptr : &FindController(scenario, options.controller);
  if (named != nullptr && HasPrograms(named->config)) {
    throw UserError({.place = "--controller " + options.controller,
                     .key = "filter",
                     .problem = "is a program or its answers (kind external), which a robot's "
                                "file cannot contain; must be a filter of Gauntlet"});
  }
  if (!options.lines.library.empty()) {
    WarnIfUnchecked(options.folder, manifest.exists());
    PrintLines(scenario, options);
    return;
  }
  if (!options.lines.unit.empty()) {
    throw UserError({.place = "--unit " + options.lines.unit, .problem = "needs --for"});
  }
  const HandModel hand(scenario.hand, TimingOf(scenario));
  WarnIfUnchecked(options.folder, manifest.exists());
  const std::string elsewhere =
      MadeElsewhere(scenario.made_with, hand, "the file is for the hand as it is now");
  if (!elsewhere.empty()) Say("gauntlet: {}\n", elsewhere);
  const std::filesystem::path target = TargetOf(options);
  MakeDirectoryOf(target);
  if (named == nullptr) return WriteMjcf(scenario, hand, target);
  controller::RobotConfig robot = RobotOf(scenario, hand, ForRobot(scenario, named->config));
  const RecordedUnits units = UseRecordedUnits(scenario.glove, robot);
  std::vector<std::string> notes = Adapt(options, robot);
  const RobotOrigin origin{.gauntlet_version = GAUNTLET_VERSION,
                           .scenario = scenario.name,
                           .controller = named->name,
                           .model_hash = hand.Hash(),
                           .file = target.filename().string()};
  const std::vector<std::string> of_robot = NotesOf(scenario.glove, robot, units);
  notes.insert(notes.begin(), of_robot.begin(), of_robot.end());
  WriteOutputFile(
      target, CommentsOf(notes, options.embedded ? "//" : "#") + ContentOf(options, robot, origin));
  for (const std::string& note : notes) Say("gauntlet: {}\n", note);
  Say("wrote {}\n", target.string());
}

}  // namespace

Command MakeExportCommand() { return MakeCommand(RunExport); }

}  // namespace gauntlet::sim
