#include <algorithm>
#include <filesystem>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "sim/answers/compare/finish_study.h"
#include "sim/answers/compare/study_files.h"
#include "sim/answers/compare/study_folder.h"
#include "sim/base/error.h"
#include "sim/base/json.h"
#include "sim/base/manifest.h"
#include "sim/base/output_folder.h"
#include "sim/base/signal_storage.h"
#include "sim/base/threads.h"
#include "sim/cli/commands.h"
#include "sim/cli/interrupt.h"
#include "sim/cli/progress.h"
#include "sim/cli/recording_scenario.h"
#include "sim/cli/shared_options.h"
#include "sim/cli/standard_streams.h"
#include "sim/results/runs.h"
#include "sim/results/table_text.h"
#include "sim/score/priority.h"
#include "sim/show/pages/score_table.h"
#include "sim/show/pages/study_folder_files.h"
#include "sim/show/video/comparison_video.h"
#include "sim/show/video/render_folder.h"
#include "sim/study/made_with.h"
#include "sim/study/scenario/scenario.h"
#include "sim/study/scenario/scenario_reader.h"
#include "sim/trial/external/external_filters.h"

namespace gauntlet::sim {
namespace {

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
        Option("--add", &added, {.value = "KIND:key=value", .offer = Offer::kFiles},
               "another controller with this filter, as one_euro:beta=0.1; or FILE.csv, what your "
               "own program made of the recording; may be repeated"),
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

/// Folder of the results. One run does not take the place of a comparison unless it is told to, and
/// then says so.
std::string OutputOf(const StudyCommand& options, const std::string& scenario) {
  std::string out = options.out.empty() ? "out/" + scenario : options.out;
  if (options.comparison || !HoldsComparison(out)) return out;
  if (options.out.empty()) {
    Say("gauntlet: {} contains a comparison and is kept; this run is written to {}_run\n", out,
        out);
    return out + "_run";
  }
  Say("gauntlet: {} contained a comparison; this run replaces its scores, page and trace\n", out);
  return out;
}

/// The scenario with the controllers that are asked for. Fills in the number of seeds.
Scenario ReadScenario(const ScenarioSource& source, StudyCommand& options) {
  Scenario scenario = ParseScenario(source);
  // Those of --add are the last, and meant whatever --controllers names.
  for (std::size_t i = 0; i < options.added.size() && !options.controllers.empty(); ++i) {
    const std::size_t place = scenario.controllers.size() - options.added.size() + i;
    const std::string& name = scenario.controllers[place].name;
    if (std::ranges::count(options.controllers, name) == 0) options.controllers.push_back(name);
  }
  if (const std::string lost = KeepControllers(options.controllers, scenario); !lost.empty()) {
    Say("gauntlet: the baseline {} is not among --controllers: the rule for scenarios that name "
        "none decides\n",
        lost);
  }
  if (options.seeds == 0) options.seeds = SeedsOfComparison(scenario);
  return scenario;
}

StudyWork WorkOf(const StudyCommand& options) {
  return {.seeds = options.seeds,
          .jobs = JobsOrCores(options.jobs),
          .causes = CauseSeedsOf(options.causes),
          .traces_go = true};
}

/// The number of trials, and how long they take on this computer.
void PrintEstimate(const StudyCommand& options, const Study& study) {
  StudyWork work = WorkOf(options);
  Progress progress("measuring");
  work.progress = [&](double done, int all) { return progress.Update(done, all); };
  const int trials = TrialCount(study, work.seeds, work.causes);
  const double seconds = EstimateSeconds(study, work);
  if (options.json) {
    return PrintText(Json({{"trials", trials}, {"seconds", seconds}, {"jobs", work.jobs}}).dump() +
                     "\n");
  }
  Print("{}: about {} with {} at a time\n", Counted(trials, "trial"), TimeText(seconds), work.jobs);
}

/// Runs the trials, with a progress bar. Returns what study.db lacks, if anything.
std::optional<std::string> Compute(const StudyCommand& options, FinishedStudy& finished) {
  const std::filesystem::path file = finished.folder / "study.db";
  if (options.comparison) KeepsTrials(file);
  StudyWork work = WorkOf(options);
  Progress progress(Counted(TrialCount(finished.study, work.seeds, work.causes), "trial"));
  work.progress = [&](double done, int all) { return progress.Update(done, all); };
  work.note = [](const std::string& line) { Say("{}\n", line); };
  work.remark = [](const std::string& line) { Say("gauntlet: {}\n", line); };
  return FinishStudy(work, finished);
}

void DrawVideo(const StudyCommand& options, const std::filesystem::path& folder) {
  Progress progress("video");
  RenderOptions video;
  video.folder = folder;
  video.jobs = JobsOrCores(options.jobs);
  RenderFolder(video, [&progress](int done, int total) { return progress.Update(done, total); });
}

void SayWritten(const StudyCommand& options, const std::filesystem::path& folder) {
  Say("wrote {}: report.html, scores.json, scores.csv, trace.h5, scenario.resolved.yaml, "
      "manifest.json{}{}{}{}\n",
      folder.string(), options.csv ? ", trace.<controller>.csv" : "",
      options.mcap ? ", trace.mcap" : "", options.comparison ? ", study.db" : "",
      options.video ? ", comparison.mp4" : "");
}

/// The option as a setting of the scenario. Errors: UserError.
std::string PriorityOverride(const std::string& priority) {
  try {
    ParsePriority(priority);
  } catch (const controller::SettingError& error) {
    throw UserError({.place = "--priority " + priority, .problem = error.problem()});
  }
  return "priority=" + priority;
}

/// Runs the trials, writes the folder, prints the table, draws the video if asked.
void RunStudyCommand(const StudyCommand& asked) {
  StudyCommand options = asked;
  if (options.allow_programs) AllowPrograms();
  // Before all --set, which may name them.
  options.overrides = {};
  for (const std::string& filter : asked.added) {
    options.overrides.push_back("controllers+=" + filter);
  }
  std::ranges::copy(asked.overrides, std::back_inserter(options.overrides));
  if (!options.priority.empty()) options.overrides.push_back(PriorityOverride(options.priority));
  const std::string stem = std::filesystem::path(asked.scenario_file).stem().string();
  options.scenario_file = ScenarioOrOfRecording(asked.scenario_file, asked.recording,
                                                asked.out.empty() ? "out/" + stem : asked.out);
  const ScenarioSource source{.file = options.scenario_file,
                              .text = ReadYamlText(options.scenario_file),
                              .overrides = options.overrides};
  Scenario scenario = ReadScenario(source, options);
  FinishedStudy finished;
  finished.comparison = options.comparison;
  finished.choices = ChoicesText({.set = asked.overrides,
                                  .added = asked.added,
                                  .controllers = asked.controllers,
                                  .priority = asked.priority});
  const std::string out = OutputOf(options, scenario.name);
  SetSignalFolder(out);
  finished.study = PrepareStudy(source, std::move(scenario));
  for (const std::string& line : WarningsOf(finished.study)) Say("gauntlet: {}\n", line);
  if (options.estimate) return PrintEstimate(options, finished.study);
  if (options.video) CheckVideoTarget(VideoOf(out));
  OutputFolder folder(out);
  finished.folder = folder.path();
  OutputFiles files = FilesOfStudy(finished);
  const std::optional<std::string> not_kept = Compute(options, finished);
  const std::string answer =
      options.json ? ScoresJson(finished)
                   : TextOf(ScoreText(finished, options.verbose), StyleOf(options.terminal));
  WriteLastStudyFolder(finished, {.csv = options.csv, .mcap = options.mcap}, options.video, files);
  folder.Keep();
  PrintText(answer);
  FlushOutput();
  if (options.video) DrawVideo(options, folder.path());
  SayWritten(options, folder.path());
  const std::vector<std::string> failures =
      Failures(finished.summary, finished.result.seeds.size());
  if (!failures.empty() && not_kept) Say("gauntlet: {}\n", *not_kept);
  if (!failures.empty()) throw RunError(failures.front());
  if (not_kept) throw RunError(*not_kept);
}

struct CompareCommand : StudyCommand {
  static constexpr auto kName = "compare";
  static constexpr auto kPurpose = "Compare all controllers and recommend one";
  static constexpr auto kGroup = Group::kEveryday;
  CompareCommand() {
    seeds = 0;
    comparison = true;
  }

  Options Rows() {
    return {
        StudyCommand::Rows(
            Option("--seeds", &seeds, {.range = {1, 100'000}},
                   "number of seeds; each draws a new glove and uses the next recording [8, or one "
                   "for each recording]")),
        Option(
            "--estimate", &estimate, {},
            "print how long it takes on this computer, from a measured trial, and write nothing"),
    };
  }

  static constexpr auto kNotes = R"(
Examples:
  gauntlet compare scenarios/door_opening.yaml --video
  gauntlet compare scenarios/random_motion.yaml --seeds 32 --controllers raw,paper_kalman
  gauntlet compare scenarios/door_opening.yaml --priority jitter
)";
};

/// A comparison with one seed: no confidence intervals, and no database to go on from.
struct RunCommand : StudyCommand {
  static constexpr auto kName = "run";
  static constexpr auto kPurpose = "As compare with one seed";
  static constexpr auto kGroup = Group::kOther;
  int seed = -1;  // -1: the scenario's

  Options Rows() {
    return StudyCommand::Rows(Option("--seed", &seed,
                                     {.range = {0, std::numeric_limits<int>::max()}},
                                     "seed of all random numbers [as in the scenario]"));
  }

  static constexpr auto kNotes = R"(
Runs every controller once, without confidence intervals and study.db. A comparison in the same
folder is kept.

Example:
  gauntlet run scenarios/hold_still.yaml --seed 7 --out out/still
)";
};

void Compare(const CompareCommand& command) { RunStudyCommand(command); }

void RunOnce(const RunCommand& command) {
  StudyCommand study = command;
  if (command.seed >= 0) study.overrides.push_back("seed=" + std::to_string(command.seed));
  RunStudyCommand(study);
}

}  // namespace

Command MakeRunCommand() { return MakeCommand(RunOnce); }

Command MakeCompareCommand() { return MakeCommand(Compare); }

}  // namespace gauntlet::sim
