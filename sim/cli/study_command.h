#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "sim/cli/recording_scenario.h"
#include "sim/cli/shared_options.h"
#include "sim/hand/hand_model.h"
#include "sim/study/scenario/scenario.h"
#include "sim/study/scenario/scenario_reader.h"
#include "sim/study/study.h"

namespace gauntlet::sim {

/// Common part of `run` and `compare`: options, and the way from a scenario to an output folder.
struct StudyCommand {
  std::string scenario_file;
  RecordingArguments recording;    // of a recording in place of a scenario
  std::string out;                 // empty: out/<scenario>
  std::vector<std::string> added;  // controllers, as in ApplySet()
  std::vector<std::string> overrides;
  std::vector<std::string> controllers;  // empty: all of the scenario
  int seeds = 1;                         // 0: of a comparison, 8 or one for each repetition
  int jobs = 0;                          // 0: one per core
  bool comparison = false;
  bool estimate = false;  // print how long it takes, and run nothing
  bool video = false;
  bool json = false;
  bool csv = false;
  bool mcap = false;
  std::string priority;  // empty: the scenario's
  bool allow_programs = false;
  bool verbose = false;
  std::string causes = "auto";
  TerminalOptions terminal;

  /// `seeds_option`: --seeds or --seed.
  Options Rows(const Option& seeds_option) {
    return {
        ScenarioArgument(scenario_file),
        seeds_option,
        OutOption(out, "output folder [out/<scenario>]"),
        SetOption(
            overrides,
            "change a value, as in --set controllers.tuned.filter.q=0.001; += adds to it; may "
            "be repeated"),
        Option("--add", &added, {.value = "KIND:key=value"},
               "another controller with this filter, as one_euro:beta=0.1; may be repeated"),
        ControllersOption(controllers),
        JobsOption(jobs),
        AllowProgramsOption(allow_programs),
        Option("--video", &video, {}, "also draw comparison.mp4"),
        Option("--priority", &priority, {},
               "tracking, delay or jitter, with optional bounds: \"tracking, jitter_rms_deg<=0.1\" "
               "[as in the scenario]"),
        VerboseOption(verbose),
        Option("--json", &json, {}, "print scores.json instead of the answer"),
        Option("--csv", &csv, {}, "also write the trace as CSV, one file per controller"),
        Option("--mcap", &mcap, {}, "also write trace.mcap, for Foxglove, PlotJuggler and rerun"),
        Option(
            "--causes", &causes,
            {.value = "SEEDS", .choices = {"none", "auto", "first", "all"}, .shows_default = true},
            "compute the causes of the error for these seeds, with about ten more trials for "
            "each controller and seed; auto: as much of the first seed as takes a quarter of "
            "the time"),
        terminal.Rows(),
        recording.RowsBesideScenario(),
    };
  }
};

/// Runs the trials, writes the folder, prints the table, draws the video if asked.
void RunStudyCommand(const StudyCommand& options);

/// Tells on standard error if an output folder has no manifest, so that its files are not checked.
void WarnIfUnchecked(const std::string& folder, bool checked);

}  // namespace gauntlet::sim
