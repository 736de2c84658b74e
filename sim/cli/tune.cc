#include <fmt/format.h>

#include <algorithm>

#include "sim/base/error.h"
#include "sim/base/manifest.h"
#include "sim/base/output_file.h"
#include "sim/base/shell_word.h"
#include "sim/base/signal_storage.h"
#include "sim/cli/commands.h"
#include "sim/cli/output_folder.h"
#include "sim/cli/progress.h"
#include "sim/cli/shared_options.h"
#include "sim/cli/standard_streams.h"
#include "sim/cli/study_command.h"
#include "sim/external/external_filters.h"
#include "sim/report/tune_all_page.h"
#include "sim/report/tune_page.h"
#include "sim/scenario/scenario_reader.h"
#include "sim/search/tune_tables.h"
#include "sim/settings/yaml_tree.h"

namespace gauntlet::sim {
namespace {

struct TuneCommand {
  static constexpr auto kName = "tune";
  static constexpr auto kPurpose = "Find the best settings, or the best kind of filter";
  std::string scenario;
  std::string controller;
  std::vector<std::string> free;
  std::string minimise = "tracking_rmse_deg";
  std::vector<std::string> subject_to;
  std::vector<std::string> set;
  std::string out;  // empty: out/<scenario>.tune
  int seeds = 8;
  int held_out = 8;
  int evaluations = 100;
  int jobs = 0;
  bool all = false;
  bool filter_only = false;
  bool force = false;
  bool json = false;
  bool allow_programs = false;
  bool verbose = false;
  TerminalOptions terminal;

  Options Rows() {
    return {
        ScenarioArgument(scenario),
        Option("--controller", &controller, {.offer = Offer::kControllers},
               "controller to tune [with --all: the baseline]"),
        Option("--all", &all, {}, "tune every kind of filter with the same number of evaluations"),
        Option("--free", &free, {.value = "KEY=LOW:HIGH"},
               "setting and its range, with optional suffix :log or :whole; may be repeated"),
        Option("--minimise", &minimise, {}, "score to optimise [tracking_rmse_deg]"),
        Option("--subject-to", &subject_to, {.value = "SCORE<=X"},
               "bound of a score, like \"jitter_rms_deg<=0.2\"; may be repeated"),
        SetOption(set, "change a value of the scenario; may be repeated"),
        Option("--evaluations", &evaluations, {.range = {1, 100000}},
               "largest number of settings [100]"),
        Option("--seeds", &seeds, {.range = {1, 10000}}, "seeds of the search [8]"),
        Option("--held-out", &held_out, {.range = {1, 10000}},
               "further seeds, for the verdict [8]"),
        JobsOption(jobs),
        AllowProgramsOption(allow_programs),
        Option("--filter-only", &filter_only, {}, "score the filter outputs, without the hand"),
        OutOption(out, "output folder [out/<scenario>.tune]"),
        ForceOption(force),
        Option("--json", &json, {}, "print JSON instead of the answer"),
        VerboseOption(verbose),
        terminal.Rows(),
    };
  }

  static constexpr auto kNotes = R"(
Examples:
  gauntlet tune scenarios/random_motion.yaml --controller tuned_kalman \
    --free filter.q=1e-6:10:log --minimise delay_ms --subject-to "jitter_rms_deg<=0.2"
  gauntlet tune scenarios/random_motion.yaml --all --minimise delay_ms \
    --subject-to "jitter_rms_deg<=0.2" --filter-only   # which filter should I use?
)";
};

/// Runs `work`; what it says of a setting is said of this option.
template <class Work>
auto OfOption(const std::string& option, const Work& work) {
  try {
    return work();
  } catch (const controller::SettingError& error) {
    throw UserError({.place = option, .problem = error.problem()});
  }
}

/// Errors: UserError for a score that there is none of without a hand.
void CheckScores(const TunePlan& plan) {
  std::vector<std::size_t> metrics = {plan.minimise};
  for (const Constraint& constraint : plan.constraints) metrics.push_back(constraint.metric);
  for (const std::size_t metric : metrics) {
    if (plan.physics || Metrics()[metric].part == ScoredPart::kJoint) continue;
    throw UserError({.place = "--filter-only",
                     .key = std::string(Metrics()[metric].key),
                     .problem = "is not a score of a joint: there is none without a hand"});
  }
}

/// Which one is tuned: with --all the baseline by default. Errors: UserError.
std::string ControllerOf(const TuneCommand& command, const Scenario& scenario) {
  const std::optional<std::size_t> baseline = BaselineOf(scenario);
  if (command.controller.empty() && command.all && baseline) {
    return scenario.controllers[*baseline].name;
  }
  if (command.controller.empty()) {
    throw UserError({.place = "--controller",
                     .problem = command.all ? "is needed, as the scenario has no baseline"
                                            : "is needed, or --all for all kinds of filters"});
  }
  return FindController(scenario, command.controller).name;
}

/// Errors: UserError where --all and --free are both there, or neither.
void CheckWhatIsFree(const TuneCommand& command) {
  if (command.all && !command.free.empty()) {
    throw UserError({.place = "--free",
                     .problem = "and --all contradict each other: --all has ranges for every kind "
                                "of filter"});
  }
  if (!command.all && command.free.empty()) {
    throw UserError({.place = "--free", .problem = "is needed, or --all for all kinds of filters"});
  }
}

TunePlan PlanOf(const TuneCommand& command) {
  CheckWhatIsFree(command);
  TunePlan plan;
  plan.scenario = {
      .file = command.scenario, .text = ReadYamlText(command.scenario), .overrides = command.set};
  plan.seeds = command.seeds;
  plan.held_out = command.held_out;
  plan.evaluations = command.evaluations;
  plan.physics = !command.filter_only;
  plan.controller = ControllerOf(command, ParseScenario(plan.scenario));
  for (const std::string& text : command.free) {
    plan.free.push_back(ParseFree(text, plan.controller));
    const SweepAxis& axis = plan.free.back();
    if (std::ranges::count(plan.free, axis.key, &SweepAxis::key) > 1) {
      throw UserError({.place = "--free", .key = axis.key, .problem = "is given twice"});
    }
    // A key that there is not, or a range beyond the key's, is found before anything runs.
    for (const double share : {0.5, 0.0, 1.0}) {
      ScenarioSource source = plan.scenario;
      source.overrides.push_back(axis.key + "=" + axis.ValueAt(share));
      ParseScenario(source);
    }
  }
  plan.minimise = OfOption("--minimise", [&] { return FindScore(command.minimise, ""); });
  for (const std::string& text : command.subject_to) {
    plan.constraints.push_back(OfOption("--subject-to", [&] { return ParseConstraint(text, ""); }));
  }
  CheckScores(plan);
  return plan;
}

/// Where the answer is to be used.
std::string IncludeText(const std::filesystem::path& file) {
  return fmt::format("in a scenario, controllers: {{tuned: !include {}}}", file.string());
}

OutputFiles FilesOf(const std::vector<std::string>& controllers, const TuneCommand& asked,
                    const OutputFolder& folder) {
  OutputPlan plan{.folder = folder.path(),
                  .command = "tune",
                  .results = {"tune.csv", "report.html"},
                  .force = asked.force};
  for (const std::string& name : controllers) plan.editable.push_back(name + ".yaml");
  plan.results.insert(plan.results.end(), plan.editable.begin(), plan.editable.end());
  return OutputFiles(std::move(plan));
}

void TuneOne(const TunePlan& plan, const TuneCommand& asked, OutputFolder& folder) {
  OutputFiles files = FilesOf({plan.controller}, asked, folder);
  const TuneResult result = [&] {
    Progress progress(fmt::format("{} settings", plan.evaluations));
    return Tune(plan, JobsOrCores(asked.jobs),
                [&](double done, double all) { return progress.Update(done, all); });
  }();
  const std::filesystem::path yaml = folder.path() / (plan.controller + ".yaml");
  files.Write([&](const std::filesystem::path& place) {
    WriteOutputFile(place / yaml.filename(), WithChecksum(ControllerYaml(result.controller)));
    WriteOutputFile(place / "tune.csv", TuneCsv(plan, result));
    WriteOutputFile(place / "report.html", TunePage(plan, result));
  });
  files.Commit();
  folder.Keep();
  PrintText(asked.json ? TuneJson(plan, result)
                       : TextOf(TuneText(plan, result, asked.verbose), StyleOf(asked.terminal)));
  FlushOutput();
  std::string sets;
  for (std::size_t a = 0; a < plan.free.size(); ++a) {
    sets += " --set " + ShellWord(plan.free[a].key + "=" + result.tried[result.chosen].values[a]);
  }
  Say("wrote {}: {}.yaml ({}, or{}), tune.csv, report.html\n", folder.path().string(),
      plan.controller, IncludeText(yaml), sets);
}

void TuneEveryKind(const TunePlan& plan, const TuneCommand& asked, OutputFolder& folder) {
  OutputFiles files = FilesOf(AllNames(controller::FilterKinds()), asked, folder);
  const std::vector<TunedKind> kinds = [&] {
    Progress progress("kinds of filters");
    return TuneAll(plan, JobsOrCores(asked.jobs),
                   [&](double done, double all) { return progress.Update(done, all); });
  }();
  files.Write([&](const std::filesystem::path& place) {
    for (const TunedKind& tuned : kinds) {
      if (!tuned.has_answer()) continue;
      WriteOutputFile(place / (tuned.kind + ".yaml"),
                      WithChecksum(ControllerYaml(tuned.result.controller)));
    }
    WriteOutputFile(place / "tune.csv", TuneAllCsv(kinds));
    WriteOutputFile(place / "report.html", TuneAllPage(plan, kinds));
  });
  files.Commit();
  folder.Keep();
  PrintText(asked.json ? TuneAllJson(plan, kinds)
                       : TextOf(TuneAllText(plan, kinds, asked.verbose), StyleOf(asked.terminal)));
  FlushOutput();
  if (!kinds.front().has_answer()) {
    Say("wrote {}: tune.csv, report.html\n", folder.path().string());
    throw RunError("no kind of filter has an answer: " + kinds.front().result.problem);
  }
  Say("wrote {}: a YAML file of each kind ({}), tune.csv, report.html\n", folder.path().string(),
      IncludeText(folder.path() / (VerdictOf(plan, kinds).best_or(kinds.front().kind) + ".yaml")));
}

void RunTuneCommand(const TuneCommand& asked) {
  if (asked.allow_programs) AllowPrograms();
  const TunePlan plan = PlanOf(asked);
  CheckProgramsOf(plan.scenario, {plan.controller});
  const std::string name = plan.scenario.file.stem().string();
  const std::string out = asked.out.empty() ? "out/" + name + ".tune" : asked.out;
  SetSignalFolder(out);
  OutputFolder folder(out);
  asked.all ? TuneEveryKind(plan, asked, folder) : TuneOne(plan, asked, folder);
}

}  // namespace

Command MakeTuneCommand() { return MakeCommand(RunTuneCommand); }

}  // namespace gauntlet::sim
