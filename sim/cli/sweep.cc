#include <fmt/format.h>

#include <memory>

#include "sim/base/atomic_file.h"
#include "sim/base/data_folder.h"
#include "sim/base/error.h"
#include "sim/cli/cells_command.h"
#include "sim/cli/commands.h"
#include "sim/cli/out_option.h"
#include "sim/cli/standard_streams.h"
#include "sim/cli/usage_error.h"
#include "sim/report/cells_page.h"
#include "sim/report/sweep_table.h"

namespace gauntlet::sim {
namespace {

struct SweepCommand {
  std::string file;
  CellsCommand cells;
  std::vector<std::string> set;
  int seeds = 0;  // 0: as the file says
  std::int64_t max_cells = 10'000;
  bool filter_only = false;
  bool all_seeds = false;
  bool json = false;
};

void CheckSize(const SweepPlan& plan, const SweepCommand& command) {
  const std::int64_t cells = plan.cell_count();
  if (cells <= command.max_cells) return;
  throw UserError({.place = command.file,
                   .key = "axes",
                   .problem = fmt::format("make {} cells, more than --max-cells {}", cells,
                                          command.max_cells)});
}

void RunSweepCommand(const SweepCommand& command) {
  SweepOverrides overrides{.seeds = {},
                           .filter_only = command.filter_only,
                           .all_seeds = command.all_seeds,
                           .set = command.set};
  if (command.seeds > 0) overrides.seeds = command.seeds;
  const SweepPlan plan = LoadSweepPlan(OwnOrDataFile(command.file), overrides);
  CheckSize(plan, command);
  CellsFolder folder(plan, command.cells, "out/" + plan.file.name);
  folder.Run();
  const SweepSummary summary = folder.WriteCells();
  WriteFileAtomically(folder.path() / "report.html",
                      SweepPage(plan, folder.database(), folder.cells(), summary,
                                SweepTable(plan, summary, TerminalStyle::Unlimited())));
  if (command.json) {
    Print("{{\n{},\n \"cells\": ", SweepJsonHead(plan, summary));
    SummariseSweep(plan, folder.database(), folder.cells(), {},
                   [](std::string_view text) { PrintText(text); });
    PrintText("\n}\n");
  } else {
    PrintText(SweepTable(plan, summary, StyleOf(command.cells.terminal)));
  }
  FlushOutput();
  Say("wrote {}: report.html, cells.csv, study.db\n", folder.path().string());
  if (summary.results == 0) throw RunError("no cell has scores: " + summary.first_problem);
}

}  // namespace

void AddSweepCommand(CLI::App& app) {
  CLI::App* command = app.add_subcommand(
      "sweep", "Run a study file: many cells of settings, each over the same seeds");
  const auto options = std::make_shared<SweepCommand>();
  command
      ->add_option("study", options->file,
                   "study file (YAML): your own, or studies/NAME.yaml that Gauntlet brings along")
      ->required();
  AddOutOption(*command, options->cells.out, "output folder [out/<study>]", "DIR");
  command
      ->add_option("--set", options->set,
                   "change a value of the base scenario in all cells; may be repeated")
      ->type_name("key=value")
      ->take_all();
  command->add_option("--seeds", options->seeds, "number of seeds [as in the study file]")
      ->check(WholeNumber(1, 100000));
  command->add_option("--max-cells", options->max_cells, "more cells than this are refused [10000]")
      ->check(WholeNumber(1, 1'000'000'000));
  command->add_flag("--filter-only", options->filter_only,
                    "without a hand: score what the filters give");
  command->add_flag("--all-seeds", options->all_seeds,
                    "no early stop: also cells that cannot win any more get all seeds");
  AddCellsOptions(*command, options->cells);
  command->add_flag("--json", options->json, "print JSON instead of the table");
  command->footer(
      "\nExamples:\n  gauntlet sweep studies/kalman_q.yaml\n"
      "  gauntlet sweep studies/kalman_q.yaml --shard 1/2   # on one machine, 2/2 on another, "
      "then\n"
      "  gauntlet sweep studies/kalman_q.yaml --collect out/kalman_q.shard-*\n");
  command->callback([options] { RunSweepCommand(*options); });
}

}  // namespace gauntlet::sim
