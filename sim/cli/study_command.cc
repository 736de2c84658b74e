#include "sim/cli/study_command.h"

#include <algorithm>
#include <filesystem>
#include <optional>
#include <utility>

#include "sim/answers/compare/finish_study.h"
#include "sim/answers/compare/study_files.h"
#include "sim/answers/compare/study_folder.h"
#include "sim/base/error.h"
#include "sim/base/json.h"
#include "sim/base/manifest.h"
#include "sim/base/output_folder.h"
#include "sim/base/signal_storage.h"
#include "sim/base/threads.h"
#include "sim/cli/interrupt.h"
#include "sim/cli/progress.h"
#include "sim/cli/recording_scenario.h"
#include "sim/cli/standard_streams.h"
#include "sim/results/runs.h"
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

CauseSeeds CausesOf(const StudyCommand& options) {
  if (options.causes == "none") return CauseSeeds::kNone;
  if (options.causes == "first") return CauseSeeds::kFirst;
  return options.causes == "all" ? CauseSeeds::kAll : CauseSeeds::kAuto;
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
  return {.seeds = options.seeds, .jobs = JobsOrCores(options.jobs), .causes = CausesOf(options)};
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
  Print("{}: about {} with {} at a time\n", TrialsText(trials), TimeText(seconds), work.jobs);
}

/// Runs the trials, with a progress bar. Returns what study.db lacks, if anything.
std::optional<std::string> Compute(const StudyCommand& options, FinishedStudy& finished) {
  const std::filesystem::path file = finished.folder / "study.db";
  if (options.comparison) KeepsTrials(file);
  StudyWork work = WorkOf(options);
  Progress progress(TrialsText(TrialCount(finished.study, work.seeds, work.causes)));
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

}  // namespace

void WarnIfUnchecked(const std::string& folder, bool checked) {
  if (checked) return;
  Say("gauntlet: warning: {} has no manifest.json: its files are not checked\n", folder);
}

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
  WriteStudyFolder(finished, {.csv = options.csv, .mcap = options.mcap}, options.video, files);
  folder.Keep();
  PrintText(options.json ? ScoresJson(finished)
                         : TextOf(ScoreText(finished, options.verbose), StyleOf(options.terminal)));
  FlushOutput();
  if (options.video) DrawVideo(options, folder.path());
  SayWritten(options, folder.path());
  const std::vector<std::string> failures =
      Failures(finished.summary, finished.result.seeds.size());
  if (!failures.empty() && not_kept) Say("gauntlet: {}\n", *not_kept);
  if (!failures.empty()) throw RunError(failures.front());
  if (not_kept) throw RunError(*not_kept);
}

}  // namespace gauntlet::sim
