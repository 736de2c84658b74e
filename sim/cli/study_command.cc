#include "sim/cli/study_command.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <optional>

#include "sim/base/error.h"
#include "sim/base/manifest.h"
#include "sim/base/mathematics.h"
#include "sim/base/nearest_name.h"
#include "sim/base/output_file.h"
#include "sim/base/signal_storage.h"
#include "sim/cli/interrupt.h"
#include "sim/cli/output_folder.h"
#include "sim/cli/progress.h"
#include "sim/cli/recording_scenario.h"
#include "sim/cli/shared_options.h"
#include "sim/cli/standard_streams.h"
#include "sim/comparison/decisive_second.h"
#include "sim/comparison/study_files.h"
#include "sim/external/external_filters.h"
#include "sim/report/report_page.h"
#include "sim/report/score_table.h"
#include "sim/scenario/scenario.h"
#include "sim/scenario/scenario_files.h"
#include "sim/scenario/scenario_reader.h"
#include "sim/score/priority.h"
#include "sim/settings/yaml_reader.h"
#include "sim/trial_table/study_database.h"
#include "sim/video/comparison_video.h"
#include "sim/video/render_folder.h"
#include "sim/video/score_board.h"

namespace gauntlet::sim {
namespace {

/// Whether the scores of an output folder are those of a comparison.
bool HoldsComparison(const std::filesystem::path& folder) {
  std::error_code unreadable;
  if (!std::filesystem::is_regular_file(folder / "scores.json", unreadable)) return false;
  std::ifstream file(folder / "scores.json");
  const auto scores = nlohmann::json::parse(file, nullptr, false);
  return scores.is_object() && scores.contains("seeds");
}

/// Where the results go. One run does not take the place of a comparison unless it is told to, and
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

std::string Trials(int count) { return fmt::format("{} trial{}", count, count == 1 ? "" : "s"); }

CauseSeeds CausesOf(const StudyCommand& options) {
  if (options.causes == "none") return CauseSeeds::kNone;
  return options.causes == "all" ? CauseSeeds::kAll : CauseSeeds::kFirst;
}

/// The trials with their progress bar. Those of a comparison are kept in study.db as they finish;
/// `not_kept` tells what it lacks in the end, if anything.
StudyResult RunTrials(const Study& study, const StudyCommand& options,
                      const std::filesystem::path& folder, std::optional<std::string>& not_kept) {
  const CauseSeeds causes = CausesOf(options);
  const int total = TrialCount(study, options.seeds, causes);
  const std::filesystem::path file = folder / "study.db";
  std::optional<StudyDatabase> database;
  if (options.comparison) {
    database.emplace(KeepsTrials(file), study, StudyDatabaseOptions{.seeds = options.seeds});
    if (const int known = database->TrialCount(); known > 0) {
      Say("continues from {} with {}\n", file.string(), Trials(known));
    }
    if (const int damaged = database->DamagedCount(); damaged > 0) {
      Say("gauntlet: {}: {} damaged, computed again\n", file.string(), Trials(damaged));
    }
  }
  Progress progress(Trials(total));
  try {
    StudyResult result = RunStudy(
        study, {.seeds = options.seeds,
                .jobs = JobsOrCores(options.jobs),
                .progress = [&](double done, int all) { return progress.Update(done, all); },
                .remark = [](const std::string& line) { Say("gauntlet: {}\n", line); },
                .keep_first_traces = true,
                .causes = causes,
                .store = database ? &*database : nullptr});
    if (database) not_kept = database->Finish();
    return result;
  } catch (const Cancelled&) {
    if (database) not_kept = database->Finish();
    const int known = database ? database->TrialCount() : 0;
    if (known == 0) throw;
    throw Cancelled{
        fmt::format("{} {} {}", Trials(known), known == 1 ? "is" : "are", KeptIn(file))};
  }
}

/// The scenario with the controllers that are asked for. Fills in the number of seeds.
Scenario ReadScenario(const ScenarioSource& source, StudyCommand& options) {
  Scenario scenario = ParseScenario(source);
  if (const std::string lost = KeepControllers(options.controllers, scenario); !lost.empty()) {
    Say("gauntlet: the baseline {} is not among --controllers: the rule for scenarios that name "
        "none decides\n",
        lost);
  }
  if (options.seeds == 0) {
    constexpr int kFewest = 8;
    options.seeds = std::max(kFewest, static_cast<int>(scenario.repetitions.gloves.size()));
  }
  return scenario;
}

void WarnOf(const Study& study) {
  WarnIfMadeElsewhere(study.scenario.made_with, *study.hand, "the run may differ");
  WarnIfOtherMathematics(study.scenario.made_with);
  WarnIfFilesChanged(study.scenario);
  for (const std::string& remark : study.remarks) Say("gauntlet: {}\n", remark);
}

/// Runs the trials and computes all that the files contain. Returns what study.db lacks, if
/// anything.
std::optional<std::string> Compute(const StudyCommand& options, FinishedStudy& finished) {
  std::optional<std::string> not_kept;
  finished.result = RunTrials(finished.study, options, finished.folder, not_kept);
  finished.summary = Summarise(finished.study, finished.result,
                               options.comparison ? DivideRecording(finished.study, finished.result,
                                                                    JobsOrCores(options.jobs))
                                                  : RecordingBlocks());
  if (options.comparison) {
    finished.ceilings =
        MeasurePredictionCeilings(finished.study, finished.result,
                                  [](const std::string& line) { Say("gauntlet: {}\n", line); });
  }
  finished.smoothing = RankBySmoothing(finished.study, finished.result);
  return not_kept;
}

void DrawVideo(const StudyCommand& options, const std::filesystem::path& folder) {
  Progress progress("video");
  RenderOptions video;
  video.folder = folder;
  video.jobs = JobsOrCores(options.jobs);
  RenderFolder(video, [&progress](int done, int total) { return progress.Update(done, total); });
}

/// What a video of the finished study shows, drawn now or later by `gauntlet render`.
VideoBeside VideoOfPage(const FinishedStudy& finished, bool is_drawn) {
  VideoBeside video{.exists = is_drawn};
  std::optional<Excerpt> again;
  if (const auto second = DecisiveSecondOf(finished)) again = SlowMotionOf(*second);
  for (const VideoStretch& stretch : StretchesOf(
           !finished.study.scenario.question.empty(), finished.result.first_glove->tick_rate_hz,
           finished.result.first_reference_rad.rows(), finished.study.scenario.video.frames_per_s,
           again)) {
    video.stretches.push_back({stretch.video_s, stretch.from_s, stretch.to_s, stretch.speed});
  }
  return video;
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

Study PrepareStudyOf(const ScenarioSource& source, Scenario scenario) {
  try {
    return PrepareStudy(std::move(scenario));
  } catch (const controller::SettingError& error) {
    throw AtPlace(PlaceOfSetting(source, error.key()), error);
  } catch (const UserError& error) {
    if (!error.place().empty()) throw;
    throw UserError({.place = PlaceOfSetting(source, error.key()),
                     .key = error.key(),
                     .problem = error.problem()});
  }
}

const NamedController& FindController(const Scenario& scenario, const std::string& name) {
  const NamedController* found = FindNamed(scenario.controllers, name);
  if (found != nullptr) return *found;
  throw UserError(
      {.place = "--controller " + name,
       .problem = "unknown controller" + Suggestion(name, AllNames(scenario.controllers))});
}

void CheckProgramsOf(const ScenarioSource& source, const std::vector<std::string>& controllers) {
  Scenario scenario = ParseScenario(source);
  KeepControllers(controllers, scenario);
  try {
    for (const NamedController& named : scenario.controllers) {
      controller::WithinSetting("controllers." + named.name, [&] { CheckPrograms(named.config); });
    }
  } catch (const controller::SettingError& error) {
    throw AtPlace(PlaceOfSetting(source, error.key()), error);
  }
}

void WarnIfMadeElsewhere(const MadeWith& made, const HandModel& hand,
                         std::string_view consequence) {
  if (made.model_hash.empty() || made.model_hash == hand.Hash()) return;
  Say("gauntlet: warning: this scenario was resolved with another hand model (hash {}, now "
      "{}); {}\n",
      made.model_hash, hand.Hash(), consequence);
}

void WarnIfOtherMathematics(const MadeWith& made) {
  if (made.mathematics.empty() || made.mathematics == HashOfMathematics()) return;
  Say("gauntlet: warning: this scenario was resolved on a machine whose sin, exp, ... differ "
      "in the last bits (another kind of processor or system); so will the results\n");
}

void WarnIfFilesChanged(const Scenario& scenario) {
  for (const auto& [then, now] : ChangedFiles(scenario)) {
    Say("gauntlet: warning: {} is not as it was when this scenario was resolved (hash {}, now {}): "
        "the results will be others\n",
        now.file, then.hash, now.hash);
  }
}

void WarnIfUnchecked(const std::string& folder, bool checked) {
  if (checked) return;
  Say("gauntlet: warning: {} has no manifest.json: its files are not checked\n", folder);
}

void RunStudyCommand(const StudyCommand& asked) {
  StudyCommand options = asked;
  if (options.allow_programs) AllowPrograms();
  if (!options.priority.empty()) options.overrides.push_back(PriorityOverride(options.priority));
  if (IsRecordingFile(asked.scenario_file)) {
    const std::filesystem::path recording = asked.scenario_file;
    const std::string folder = asked.out.empty() ? "out/" + recording.stem().string() : asked.out;
    options.scenario_file = ScenarioOfRecording(recording, asked.map, asked.array, folder);
  } else if (!asked.array.empty()) {
    throw UserError({.place = "--topic " + Shown(asked.array),
                     .problem = "needs a recording, not a scenario, which has it as "
                                "glove.motion.array"});
  } else if (!asked.map.empty()) {
    throw UserError({.place = "--map " + asked.map,
                     .problem = "needs a recording, not a scenario, which names its own map"});
  }
  const ScenarioSource source{.file = options.scenario_file,
                              .text = ReadYamlText(options.scenario_file),
                              .overrides = options.overrides};
  Scenario scenario = ReadScenario(source, options);
  FinishedStudy finished;
  finished.comparison = options.comparison;
  const std::string out = OutputOf(options, scenario.name);
  SetSignalFolder(out);
  finished.study = PrepareStudyOf(source, std::move(scenario));
  WarnOf(finished.study);
  if (options.video) CheckVideoTarget(VideoOf(out));
  OutputFolder folder(out);
  finished.folder = folder.path();
  OutputFiles files({.folder = folder.path(),
                     .command = "run or compare",
                     .results = {"report.html", "scores.json", "scores.csv", "trace.h5",
                                 "scenario.resolved.yaml"}});
  const std::optional<std::string> not_kept = Compute(options, finished);
  files.Write([&](const std::filesystem::path& place) {
    WriteStudyFiles(place, finished, {.csv = options.csv, .mcap = options.mcap});
    WriteOutputFile(place / "report.html",
                    ReportPage(finished, VideoOfPage(finished, options.video)));
  });
  files.Commit();
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
