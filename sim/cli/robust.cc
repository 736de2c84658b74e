#include "sim/answers/robust/robust_tables.h"
#include "sim/base/output_file.h"
#include "sim/cli/cells_command.h"
#include "sim/cli/commands.h"
#include "sim/cli/shared_options.h"
#include "sim/cli/standard_streams.h"
#include "sim/results/answer_files.h"
#include "sim/results/runs.h"
#include "sim/settings/yaml_tree.h"
#include "sim/show/pages/pages.h"
#include "sim/study/scenario/scenario_reader.h"
#include "sim/study/study.h"
#include "sim/trial/external/external_filters.h"

namespace gauntlet::sim {
namespace {

struct RobustCommand {
  static constexpr auto kName = "robust";
  static constexpr auto kPurpose = "Test the verdict on other hands, links and gloves";
  static constexpr auto kGroup = Group::kStudy;
  std::string scenario;
  CellsCommand cells;
  std::vector<std::string> set;
  RobustOptions robust;
  int within_percent = 30;
  bool json = false;

  Options Rows() {
    return {
        ScenarioArgument(scenario),
        ControllersOption(robust.controllers),
        OutOption(cells.out, "output folder [out/<scenario>.robust]"),
        SetOption(set, "change a value of the scenario; may be repeated"),
        Option("--hands", &robust.hands, {.range = {1, 100000}}, "number of sampled hands [32]"),
        Option("--seeds", &robust.seeds, {.range = {1, 100000}},
               "seeds of each hand [8, or one for each recording]"),
        Option("--within", &within_percent, {.range = {1, 90}},
               "largest deviation of the parameters, in percent [30]"),
        Option("--design-seed", &robust.design_seed, {.range = {0, 2'147'480'000}},
               "seed of the sampled hands [1]"),
        cells.Rows(),
        Option("--json", &json, {}, "print JSON instead of the answer"),
    };
  }

  static constexpr auto kNotes = R"(
Friction, stiffness, inertia, servo gain, delay, the glove on its wearer and noise vary
together, and one at a time.

Example:
  gauntlet robust random_motion --controllers raw,tuned_kalman,prediction
)";
};

void RunRobustCommand(const RobustCommand& command) {
  if (command.cells.allow_programs) AllowPrograms();
  RobustOptions options = command.robust;
  options.within_percent = command.within_percent;
  const ScenarioSource source{
      .file = command.scenario, .text = ReadYamlText(command.scenario), .overrides = command.set};
  const RobustPlan plan = MakeRobustPlan(source, options);
  CheckProgramsOf(source, options.controllers);  // not of the plan, whose text is another
  CellsFolder folder(
      plan.sweep, command.cells, "out/" + plan.sweep.file.name + ".robust",
      {.folder = {},
       .command = "robust",
       .choices = ChoicesText({.set = command.set, .controllers = options.controllers}),
       .results = {"scenario.resolved.yaml", "cells.csv", "robust.csv", "tornado.csv",
                   "report.html", kAnswerFile, kVerboseAnswerFile}});
  folder.Run();
  std::optional<RobustResult> result;
  if (!folder.is_shard()) result = ConcludeRobust(plan, folder.database());
  folder.files().Write([&](const std::filesystem::path& place) {
    WriteOutputFile(place / "scenario.resolved.yaml",
                    ScenarioToYaml(ParseScenario(plan.sweep.scenario), folder.path()));
    folder.WriteCells(place);
    if (!result) return;
    WriteOutputFile(place / "robust.csv", RobustCsv(*result));
    WriteOutputFile(place / "tornado.csv", TornadoCsv(plan, *result));
    WriteOutputFile(place / "report.html", RobustPage(plan, folder.database(), *result));
    WriteAnswer(place, RobustText(plan, *result, false), RobustText(plan, *result, true));
  });
  folder.files().Commit();
  const std::string written = "scenario.resolved.yaml, cells.csv, study.db, manifest.json";
  if (!result) {
    Say("wrote {}: {}; --collect takes all shards together and concludes\n", folder.path().string(),
        written);
    return;
  }
  PrintText(command.json ? RobustJson(plan, *result)
                         : TextOf(RobustText(plan, *result, command.cells.verbose),
                                  StyleOf(command.cells.terminal)));
  FlushOutput();
  Say("wrote {}: report.html, robust.csv, tornado.csv, {}\n", folder.path().string(), written);
}

}  // namespace

Command MakeRobustCommand() { return MakeCommand(RunRobustCommand); }

}  // namespace gauntlet::sim
