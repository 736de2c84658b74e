#include <fmt/format.h>

#include "sim/answers/tune/tune_request.h"
#include "sim/answers/tune/tune_tables.h"
#include "sim/base/error.h"
#include "sim/base/manifest.h"
#include "sim/base/output_file.h"
#include "sim/base/output_folder.h"
#include "sim/base/shell_word.h"
#include "sim/base/signal_storage.h"
#include "sim/base/threads.h"
#include "sim/cli/commands.h"
#include "sim/cli/progress.h"
#include "sim/cli/recording_scenario.h"
#include "sim/cli/shared_options.h"
#include "sim/cli/standard_streams.h"
#include "sim/results/answer_files.h"
#include "sim/results/runs.h"
#include "sim/settings/yaml_tree.h"
#include "sim/show/pages/pages.h"
#include "sim/study/study.h"
#include "sim/trial/external/external_filters.h"

namespace gauntlet::sim {
namespace {

struct TuneCommand {
  static constexpr auto kName = "tune";
  static constexpr auto kPurpose = "Find the best settings, or the best kind of filter";
  static constexpr auto kGroup = Group::kEveryday;
  TuneRequest request;
  std::string scenario;
  RecordingArguments recording;  // of a recording in place of a scenario
  std::vector<std::string> set;
  std::string out;  // empty: out/<scenario>.tune
  int jobs = 0;
  bool force = false;
  bool json = false;
  bool allow_programs = false;
  bool verbose = false;
  TerminalOptions terminal;

  Options Rows() {
    return {
        ScenarioArgument(scenario),
        Option("--controller", &request.controller, {.offer = Offer::kControllers},
               "controller to tune [with --all: the baseline]"),
        Option("--all", &request.all, {},
               "tune every kind of filter with the same number of evaluations"),
        Option("--free", &request.free, {.value = "KEY=LOW:HIGH"},
               "setting and its range, with optional suffix :log or :whole; may be repeated"),
        Option("--minimise", &request.minimise, {}, "score to optimise [tracking_rmse_deg]"),
        Option("--subject-to", &request.subject_to, {.value = "SCORE<=X"},
               "bound of a score, like \"jitter_rms_deg<=0.2\"; may be repeated"),
        SetOption(set, "change a value of the scenario; may be repeated"),
        Option("--evaluations", &request.evaluations, {.range = {1, 100000}},
               "largest number of settings [100]"),
        Option("--seeds", &request.seeds, {.range = {1, 10000}}, "seeds of the search [8]"),
        Option("--held-out", &request.held_out, {.range = {1, 10000}},
               "further seeds, for the verdict [8]; recordings are divided instead"),
        JobsOption(jobs),
        AllowProgramsOption(allow_programs),
        Option("--filter-only", &request.filter_only, {},
               "score the filter outputs, without the hand"),
        OutOption(out, "output folder [out/<scenario>.tune]"),
        ForceOption(force),
        Option("--json", &json, {}, "print JSON instead of the answer"),
        VerboseOption(verbose),
        terminal.Rows(),
        recording.RowsBesideScenario(),
    };
  }

  static constexpr auto kNotes = R"(
Examples:
  gauntlet tune random_motion --all --minimise delay_ms \
    --subject-to "jitter_rms_deg<=0.2" --filter-only   # the best kind of filter
  gauntlet tune random_motion --controller tuned_kalman --minimise delay_ms \
    --free filter.q=1e-6:10:log --subject-to "jitter_rms_deg<=0.2"
  gauntlet tune my_glove.csv --all
)";
};

/// Use of the answer in a scenario.
std::string IncludeText(const std::filesystem::path& file) {
  return fmt::format("in a scenario, controllers: {{tuned: !include {}}}", file.string());
}

OutputFiles FilesOf(const std::vector<std::string>& controllers, const TuneCommand& asked,
                    const OutputFolder& folder) {
  OutputPlan plan{.folder = folder.path(),
                  .command = "tune",
                  .choices = ChoicesText({.set = asked.set}),
                  .results = {"tune.csv", "report.html", kAnswerFile, kVerboseAnswerFile},
                  .force = asked.force};
  for (const std::string& name : controllers) plan.editable.push_back(name + ".yaml");
  plan.results.insert(plan.results.end(), plan.editable.begin(), plan.editable.end());
  return OutputFiles(std::move(plan));
}

/// Writes the files of what was found, with the controllers that `write_controllers` writes, and
/// prints it.
void Conclude(const TunePlan& plan, const auto& found, const TuneCommand& asked, OutputFiles& files,
              OutputFolder& folder, const auto& write_controllers) {
  files.Write([&](const std::filesystem::path& place) {
    write_controllers(place);
    WriteOutputFile(place / "tune.csv", TuneCsv(plan, found));
    WriteOutputFile(place / "report.html", TunePage(plan, found));
    WriteAnswer(place, TuneText(plan, found, false), TuneText(plan, found, true));
  });
  files.Commit();
  folder.Keep();
  PrintText(asked.json ? TuneJson(plan, found)
                       : TextOf(TuneText(plan, found, asked.verbose), StyleOf(asked.terminal)));
  FlushOutput();
}

void TuneOne(const TunePlan& plan, const TuneCommand& asked, OutputFolder& folder) {
  OutputFiles files = FilesOf({plan.controller}, asked, folder);
  const TuneResult result = [&] {
    Progress progress(fmt::format("{} settings", plan.evaluations));
    return Tune(plan, JobsOrCores(asked.jobs),
                [&](double done, double all) { return progress.Update(done, all); });
  }();
  const std::filesystem::path yaml = folder.path() / (plan.controller + ".yaml");
  Conclude(plan, result, asked, files, folder, [&](const std::filesystem::path& place) {
    WriteOutputFile(place / yaml.filename(), WithChecksum(ControllerYaml(result.controller)));
  });
  std::string sets;
  for (std::size_t a = 0; a < plan.free.size(); ++a) {
    sets += " --set " + ShellWord(plan.free[a].key + "=" + result.tried[result.chosen].values[a]);
  }
  const bool is_recommended = !VerdictOf(plan, result).recommended.empty();
  Say("wrote {}: {}.yaml ({}), tune.csv, report.html\n", folder.path().string(), plan.controller,
      is_recommended ? fmt::format("{}, or{}", IncludeText(yaml), sets) : "not recommended");
}

void TuneEveryKind(const TunePlan& plan, const TuneCommand& asked, OutputFolder& folder) {
  OutputFiles files = FilesOf(AllNames(controller::FilterKinds()), asked, folder);
  const std::vector<TunedKind> kinds = [&] {
    Progress progress("kinds of filters");
    return TuneAll(plan, JobsOrCores(asked.jobs),
                   [&](double done, double all) { return progress.Update(done, all); });
  }();
  Conclude(plan, kinds, asked, files, folder, [&](const std::filesystem::path& place) {
    for (const TunedKind& tuned : kinds) {
      if (!tuned.has_answer()) continue;
      WriteOutputFile(place / (tuned.kind + ".yaml"),
                      WithChecksum(ControllerYaml(tuned.result.controller)));
    }
  });
  if (!kinds.front().has_answer()) {
    Say("wrote {}: tune.csv, report.html\n", folder.path().string());
    throw RunError("no kind of filter has an answer: " + VerdictOf(plan, kinds).Text());
  }
  const std::string kind = VerdictOf(plan, kinds).recommended;
  Say("wrote {}: a YAML file of each kind ({}), tune.csv, report.html\n", folder.path().string(),
      kind.empty() ? "none recommended" : IncludeText(folder.path() / (kind + ".yaml")));
}

void RunTuneCommand(const TuneCommand& asked) {
  if (asked.allow_programs) AllowPrograms();
  const std::string scenario =
      ScenarioOrOfRecording(asked.scenario, asked.recording,
                            "out/" + std::filesystem::path(asked.scenario).stem().string());
  const TunePlan plan = PlanOf(
      asked.request, {.file = scenario, .text = ReadYamlText(scenario), .overrides = asked.set});
  CheckProgramsOf(plan.scenario, {plan.controller});
  const std::string name = plan.scenario.file.stem().string();
  const std::string out = asked.out.empty() ? "out/" + name + ".tune" : asked.out;
  SetSignalFolder(out);
  OutputFolder folder(out);
  asked.request.all ? TuneEveryKind(plan, asked, folder) : TuneOne(plan, asked, folder);
}

}  // namespace

Command MakeTuneCommand() { return MakeCommand(RunTuneCommand); }

}  // namespace gauntlet::sim
