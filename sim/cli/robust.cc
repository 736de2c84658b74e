#include <fmt/format.h>

#include <memory>

#include "sim/base/error.h"
#include "sim/base/output_file.h"
#include "sim/cli/cells_command.h"
#include "sim/cli/commands.h"
#include "sim/cli/controllers_option.h"
#include "sim/cli/out_option.h"
#include "sim/cli/standard_streams.h"
#include "sim/cli/study_command.h"
#include "sim/cli/usage_error.h"
#include "sim/report/robust_page.h"
#include "sim/scenario/scenario_reader.h"
#include "sim/settings/yaml_tree.h"
#include "sim/study/robust_tables.h"

namespace gauntlet::sim {
namespace {

struct RobustCommand {
  std::string scenario;
  CellsCommand cells;
  std::vector<std::string> set;
  RobustOptions robust;
  bool json = false;
};

void RunRobustCommand(const RobustCommand& command) {
  const RobustPlan plan = MakeRobustPlan(
      {.file = command.scenario, .text = ReadYamlText(command.scenario), .overrides = command.set},
      command.robust);
  CellsFolder folder(plan.sweep, command.cells, "out/" + plan.sweep.file.name + ".robust",
                     {.folder = {},
                      .command = "robust",
                      .results = {"scenario.resolved.yaml", "cells.csv", "robust.csv",
                                  "tornado.csv", "report.html"}});
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
  });
  folder.files().Commit();
  const std::string written = "scenario.resolved.yaml, cells.csv, study.db, manifest.json";
  if (!result) {
    Say("wrote {}: {}; --collect takes all shards together and concludes\n", folder.path().string(),
        written);
    return;
  }
  PrintText(command.json ? RobustJson(plan, *result)
                         : TextOf(RobustText(plan, *result), StyleOf(command.cells.terminal)));
  FlushOutput();
  Say("wrote {}: report.html, robust.csv, tornado.csv, {}\n", folder.path().string(), written);
}

}  // namespace

void AddRobustCommand(CLI::App& app) {
  CLI::App* command = app.add_subcommand(
      "robust", "Tell whether the verdict of a scenario holds on other hands, links and gloves");
  const auto options = std::make_shared<RobustCommand>();
  command
      ->add_option("scenario", options->scenario,
                   "scenario file (YAML), or the name of a ready one (gauntlet list scenarios)")
      ->required()
      ->transform(ScenarioFile);
  AddControllersOption(*command, options->robust.controllers);
  AddOutOption(*command, options->cells.out, "output folder [out/<scenario>.robust]", "DIR");
  command->add_option("--set", options->set, "change a value of the scenario; may be repeated")
      ->type_name("key=value")
      ->take_all();
  command->add_option("--hands", options->robust.hands, "how many hands are drawn [32]")
      ->transform(WholeNumber(1, 100000));
  command
      ->add_option("--seeds", options->robust.seeds,
                   "seeds of each hand [8, or one for each repetition]")
      ->transform(WholeNumber(1, 100000));
  command
      ->add_option("--within", options->robust.within_percent,
                   "how far settings are off the scenario's, in percent [30]")
      ->transform(WholeNumber(1, 90));
  command->add_option("--design-seed", options->robust.design_seed, "draws other hands [1]")
      ->transform(WholeNumber(0, 2'147'480'000));
  AddCellsOptions(*command, options->cells);
  command->add_flag("--json", options->json, "print JSON instead of the table");
  command->footer(
      "\nFriction, stiffness, inertia, servo gain, delay, the glove on its wearer and noise vary\n"
      "together, and one at a time.\n"
      "\nExample:\n  gauntlet robust random_motion --controllers raw,tuned_kalman,prediction\n");
  command->callback([options] { RunRobustCommand(*options); });
}

}  // namespace gauntlet::sim
