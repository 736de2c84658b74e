#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <memory>

#include "sim/base/atomic_file.h"
#include "sim/base/data_folder.h"
#include "sim/base/error.h"
#include "sim/base/signal_storage.h"
#include "sim/cli/commands.h"
#include "sim/cli/interrupt.h"
#include "sim/cli/jobs_option.h"
#include "sim/cli/out_option.h"
#include "sim/cli/output_folder.h"
#include "sim/cli/progress.h"
#include "sim/cli/standard_streams.h"
#include "sim/cli/usage_error.h"
#include "sim/report/sweep_table.h"

namespace gauntlet::sim {
namespace {

struct SweepCommand {
  std::string file;
  std::string out;  // empty: out/<name>, of a shard out/<name>.shard-1-of-2
  std::vector<std::string> set;
  int jobs = 0;
  int seeds = 0;  // 0: as the file says
  std::int64_t max_cells = 10'000;
  bool filter_only = false;
  bool json = false;
  std::string shard;
  std::vector<std::string> collect;
};

struct Shard {
  int number = 1;
  int count = 1;
};

/// Errors: UserError for what is not i/n with 1 <= i <= n.
Shard ParseShard(const std::string& text) {
  if (text.empty()) return {};
  Shard shard;
  int length = 0;
  const bool read =
      std::sscanf(text.c_str(), "%9d/%9d%n", &shard.number, &shard.count, &length) == 2;
  if (!read || length != std::ssize(text) || shard.number < 1 || shard.number > shard.count) {
    throw UserError(
        {.place = "--shard", .key = text, .problem = "must be i/n with 1 <= i <= n, as 2/8"});
  }
  return shard;
}

std::string TimeText(double seconds) {
  if (seconds < 90.0) return fmt::format("{:.0f} s", std::max(1.0, seconds));
  if (seconds < 5400.0) return fmt::format("{:.0f} min", seconds / 60.0);
  return fmt::format("{:.1f} h", seconds / 3600.0);
}

void CheckSize(const SweepPlan& plan, const SweepCommand& command) {
  const std::int64_t cells = plan.cell_count();
  if (cells <= command.max_cells) return;
  throw UserError({.place = command.file,
                   .key = "axes",
                   .problem = fmt::format("make {} cells, more than --max-cells {}", cells,
                                          command.max_cells)});
}

/// Takes over the databases of shards; a folder stands for the study.db in it.
void CollectShards(const std::vector<std::string>& places, SweepDatabase& database) {
  for (const std::filesystem::path place : places) {
    const std::int64_t before = database.TrialCount();
    database.Collect(std::filesystem::is_directory(place) ? place / "study.db" : place);
    Say("collected {} trials from {}\n", database.TrialCount() - before, place.string());
  }
}

void RunCells(const SweepPlan& plan, const SweepCommand& command, const CellRange& cells,
              const std::filesystem::path& file, SweepDatabase& database) {
  const int jobs = JobsOrCores(command.jobs);
  SetWhatIsKept(fmt::format("finished trials are kept in {}: the same command goes on from there",
                            file.string()));
  Progress progress(fmt::format("{} cells", cells.end - cells.first));
  try {
    RunSweep(
        plan, database,
        {.jobs = jobs,
         .cells = cells,
         .forecast =
             [&](const SweepForecast& forecast) {
               Say("{} cells x {} seeds: {:.0f} trials to run, noise-free twins counted; about "
                   "{} with {} at a time\n",
                   cells.end - cells.first, plan.file.seeds, forecast.trials,
                   TimeText(forecast.seconds), jobs);
             },
         .progress = [&](double done, double all) { return progress.Update(done, all); },
         .remark = [](const std::string& line) { Say("gauntlet: {}\n", line); }});
  } catch (const Cancelled&) {
    database.Flush();
    throw Cancelled{fmt::format("{} trials are kept in {}: the same command goes on from there",
                                database.TrialCount(), file.string())};
  }
  if (const int damaged = database.DamagedCount(); damaged > 0) {
    Say("gauntlet: {}: {} damaged trial{}, computed again\n", file.string(), damaged,
        damaged == 1 ? "" : "s");
  }
}

void RunSweepCommand(const SweepCommand& command) {
  const Shard shard = ParseShard(command.shard);
  if (!command.shard.empty() && !command.collect.empty()) {
    throw UserError({.place = "--shard", .problem = "and --collect contradict each other"});
  }
  SweepOverrides overrides{.seeds = {}, .filter_only = command.filter_only, .set = command.set};
  if (command.seeds > 0) overrides.seeds = command.seeds;
  const SweepPlan plan = LoadSweepPlan(OwnOrDataFile(command.file), overrides);
  CheckSize(plan, command);
  const CellRange cells = ShardOf(plan, shard.number, shard.count);
  std::string out = command.out.empty() ? "out/" + plan.file.name : command.out;
  if (command.out.empty() && shard.count > 1) {
    out += fmt::format(".shard-{}-of-{}", shard.number, shard.count);
  }
  SetSignalFolder(out);
  const std::string sweep = HashOfSweep(plan);
  OutputFolder folder(out);
  const std::filesystem::path file = folder.path() / "study.db";
  SweepDatabase database(file, sweep, plan.metrics);
  if (const std::int64_t known = database.TrialCount(); known > 0) {
    Say("goes on from {}, which holds {} trial{}\n", file.string(), known, known == 1 ? "" : "s");
  }
  folder.Keep();
  CollectShards(command.collect, database);
  RunCells(plan, command, cells, file, database);

  AtomicFile table(folder.path() / "cells.csv");
  std::ofstream csv(table.temporary_path(), std::ios::binary);
  const auto write = [&csv](std::string_view text) { csv << text; };
  const SweepSummary summary = SummariseSweep(plan, database, cells, write, {});
  csv.close();
  if (!csv) throw RunError(table.target().string() + ": could not be written");
  table.Commit();
  if (command.json) {
    Print("{{\n{},\n \"cells\": ", SweepJsonHead(plan, summary));
    SummariseSweep(plan, database, cells, {}, [](std::string_view text) { PrintText(text); });
    PrintText("\n}\n");
  } else {
    PrintText(SweepTable(plan, summary));
  }
  FlushOutput();
  Say("wrote {}: cells.csv, study.db\n", folder.path().string());
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
  AddOutOption(*command, options->out, "output folder [out/<study>]", "DIR");
  command
      ->add_option("--set", options->set,
                   "change a value of the base scenario in all cells; may be repeated")
      ->type_name("key=value")
      ->take_all();
  AddJobsOption(*command, options->jobs);
  command->add_option("--seeds", options->seeds, "number of seeds [as in the study file]")
      ->check(WholeNumber(1, 100000));
  command->add_option("--max-cells", options->max_cells, "more cells than this are refused [10000]")
      ->check(WholeNumber(1, 1'000'000'000));
  command->add_flag("--filter-only", options->filter_only,
                    "without a hand: score what the filters give");
  command
      ->add_option("--shard", options->shard,
                   "run only part i of n equal parts, into a folder of its own")
      ->type_name("i/n");
  command
      ->add_option("--collect", options->collect,
                   "take over the trials in these folders of shards, then run what is missing")
      ->type_name("DIR")
      ->take_all();
  command->add_flag("--json", options->json, "print JSON instead of the table");
  command->footer(
      "\nExamples:\n  gauntlet sweep studies/kalman_q.yaml\n"
      "  gauntlet sweep studies/kalman_q.yaml --shard 1/2   # on one machine, 2/2 on another, "
      "then\n"
      "  gauntlet sweep studies/kalman_q.yaml --collect out/kalman_q.shard-*\n");
  command->callback([options] { RunSweepCommand(*options); });
}

}  // namespace gauntlet::sim
