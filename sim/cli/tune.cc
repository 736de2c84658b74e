#include <fmt/format.h>

#include <algorithm>
#include <memory>

#include "sim/base/atomic_file.h"
#include "sim/base/error.h"
#include "sim/base/nearest_name.h"
#include "sim/base/signal_storage.h"
#include "sim/cli/commands.h"
#include "sim/cli/jobs_option.h"
#include "sim/cli/out_option.h"
#include "sim/cli/output_folder.h"
#include "sim/cli/progress.h"
#include "sim/cli/standard_streams.h"
#include "sim/cli/study_command.h"
#include "sim/cli/usage_error.h"
#include "sim/report/cells_page.h"
#include "sim/report/tune_table.h"
#include "sim/settings/yaml_tree.h"

namespace gauntlet::sim {
namespace {

struct TuneCommand {
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
  bool filter_only = false;
  bool json = false;
  TerminalOptions terminal;
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

TunePlan PlanOf(const TuneCommand& command) {
  TunePlan plan;
  plan.scenario = {
      .file = command.scenario, .text = ReadYamlText(command.scenario), .overrides = command.set};
  plan.controller = command.controller;
  plan.seeds = command.seeds;
  plan.held_out = command.held_out;
  plan.evaluations = command.evaluations;
  plan.physics = !command.filter_only;
  const Scenario scenario = ParseScenario(plan.scenario);
  std::vector<std::string> known;
  for (const NamedController& named : scenario.controllers) known.push_back(named.name);
  if (std::ranges::find(known, command.controller) == known.end()) {
    throw UserError({.place = "--controller " + command.controller,
                     .problem = "unknown controller" + Suggestion(command.controller, known)});
  }
  for (const std::string& text : command.free) {
    plan.free.push_back(ParseFree(text, command.controller));
    const SweepAxis& axis = plan.free.back();
    if (std::ranges::count(plan.free, axis.key, &SweepAxis::key) > 1) {
      throw UserError({.place = "--free", .key = axis.key, .problem = "is given twice"});
    }
    ScenarioSource source = plan.scenario;
    source.overrides.push_back(axis.key + "=" + axis.ValueAt(0.5));
    ParseScenario(source);  // a key that there is not is found before anything runs
  }
  plan.minimise = OfOption("--minimise", [&] { return FindScore(command.minimise, ""); });
  for (const std::string& text : command.subject_to) {
    plan.constraints.push_back(OfOption("--subject-to", [&] { return ParseConstraint(text, ""); }));
  }
  CheckScores(plan);
  return plan;
}

void RunTuneCommand(const TuneCommand& asked) {
  const TunePlan plan = PlanOf(asked);
  const std::string name = plan.scenario.file.stem().string();
  const std::string out = asked.out.empty() ? "out/" + name + ".tune" : asked.out;
  SetSignalFolder(out);
  OutputFolder folder(out);
  const int jobs = JobsOrCores(asked.jobs);
  const TuneResult result = [&] {
    Progress progress(fmt::format("{} settings", plan.evaluations));
    return Tune(plan, jobs, [&](double done, double all) { return progress.Update(done, all); });
  }();
  const std::string settings = ControllerYaml(result.controller);
  WriteFileAtomically(folder.path() / (plan.controller + ".yaml"), settings);
  WriteFileAtomically(folder.path() / "tune.csv", TuneCsv(plan, result));
  WriteFileAtomically(folder.path() / "report.html",
                      TunePage(plan, result, TuneTable(plan, result, TerminalStyle::Unlimited())));
  folder.Keep();
  PrintText(asked.json ? TuneJson(plan, result) : TuneTable(plan, result, StyleOf(asked.terminal)));
  FlushOutput();
  std::string sets;
  for (std::size_t a = 0; a < plan.free.size(); ++a) {
    sets += fmt::format(" --set {}={}", plan.free[a].key, result.tried[result.chosen].values[a]);
  }
  Say("wrote {0}: {1}.yaml (for controllers: of a scenario, or{2}), tune.csv, report.html\n",
      folder.path().string(), plan.controller, sets);
}

}  // namespace

void AddTuneCommand(CLI::App& app) {
  CLI::App* command = app.add_subcommand(
      "tune",
      "Find the best values of a controller's settings, judged on seeds that it has not seen");
  const auto options = std::make_shared<TuneCommand>();
  command
      ->add_option("scenario", options->scenario,
                   "scenario file (YAML), or the name of a ready one (gauntlet list scenarios)")
      ->required()
      ->transform(ScenarioFile);
  command->add_option("--controller", options->controller, "which one of the scenario")->required();
  command
      ->add_option(
          "--free", options->free,
          "a setting of the controller and its range; :log and :whole may stand behind; may "
          "be repeated")
      ->type_name("KEY=LOW:HIGH")
      ->required()
      ->take_all();
  command->add_option("--minimise", options->minimise,
                      "score to make small, or large where that is better [tracking_rmse_deg]");
  command
      ->add_option("--subject-to", options->subject_to,
                   "bound of a score, as in --subject-to \"jitter_rms_deg<=0.2\"; may be repeated")
      ->type_name("SCORE<=X")
      ->take_all();
  command->add_option("--set", options->set, "change a value of the scenario; may be repeated")
      ->type_name("key=value")
      ->take_all();
  command->add_option("--evaluations", options->evaluations, "settings to try at most [100]")
      ->check(WholeNumber(1, 100000));
  command->add_option("--seeds", options->seeds, "seeds that each is tried on [8]")
      ->check(WholeNumber(1, 10000));
  command->add_option("--held-out", options->held_out, "seeds behind those, for the verdict [8]")
      ->check(WholeNumber(1, 10000));
  AddJobsOption(*command, options->jobs);
  command->add_flag("--filter-only", options->filter_only,
                    "without a hand: score what the filters give");
  AddOutOption(*command, options->out, "output folder [out/<scenario>.tune]", "DIR");
  command->add_flag("--json", options->json, "print JSON instead of the table");
  AddTableOptions(*command, options->terminal);
  command->footer(
      "\nExample:\n  gauntlet tune scenarios/random_motion.yaml --controller tuned_kalman \\\n"
      "    --free filter.q=1e-6:10:log --minimise delay_ms --subject-to "
      "\"jitter_rms_deg<=0.2\"\n");
  command->callback([options] { RunTuneCommand(*options); });
}

}  // namespace gauntlet::sim
