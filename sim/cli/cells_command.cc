#include "sim/cli/cells_command.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>

#include "controller/number.h"
#include "sim/answers/sweep/sweep_tables.h"
#include "sim/base/error.h"
#include "sim/base/output_file.h"
#include "sim/base/signal_storage.h"
#include "sim/base/text.h"
#include "sim/base/threads.h"
#include "sim/cli/interrupt.h"
#include "sim/cli/progress.h"
#include "sim/cli/standard_streams.h"
#include "sim/results/table_text.h"
#include "sim/study/trial_table/trial_table.h"

namespace gauntlet::sim {
namespace {

struct Shard {
  int number = 1;
  int count = 1;
};

/// Errors: UserError for what is not i/n with 1 <= i <= n.
Shard ParseShard(const std::string& text) {
  if (text.empty()) return {};
  constexpr int kMostShards = 1'000'000'000;
  const std::size_t slash = std::min(text.find('/'), text.size());
  const auto part = std::string_view(text).substr(0, slash);
  const auto whole = std::string_view(text).substr(std::min(slash + 1, text.size()));
  const auto count = controller::ParseWholeNumber(whole, 1, kMostShards);
  const auto number = controller::ParseWholeNumber(part, 1, count.value_or(0));
  if (!number) {
    throw UserError({.place = "--shard",
                     .key = Shown(text),
                     .problem = "must be i/n with 1 <= i <= n, as 2/8"});
  }
  return {.number = static_cast<int>(*number), .count = static_cast<int>(*count)};
}

/// Errors: UserError for options that contradict each other.
CellRange CellsOf(const SweepPlan& plan, const CellsCommand& command) {
  const Shard shard = ParseShard(command.shard);
  if (!command.shard.empty() && !command.collect.empty()) {
    throw UserError({.place = "--shard", .problem = "and --collect contradict each other"});
  }
  return ShardOf(plan, shard.number, shard.count);
}

std::string FolderOf(const CellsCommand& command, const std::string& out) {
  const Shard shard = ParseShard(command.shard);
  std::string folder = command.out.empty() ? out : command.out;
  if (command.out.empty() && shard.count > 1) {
    folder += fmt::format(".shard-{}-of-{}", shard.number, shard.count);
  }
  return folder;
}

/// Builds the base scenario before there is a folder: what is wrong with it leaves none. Long
/// signals find their place beside the folder.
std::string HashBefore(const SweepPlan& plan, const std::string& folder) {
  SetSignalFolder(folder);
  return HashOfSweep(plan);
}

OutputPlan In(const std::filesystem::path& folder, OutputPlan files) {
  files.folder = folder;
  return files;
}

/// Takes over the databases of shards; a folder stands for the study.db in it.
void CollectShards(const std::vector<std::string>& places, SweepDatabase& database) {
  for (const std::filesystem::path place : places) {
    const std::int64_t before = database.TrialCount();
    database.Collect(std::filesystem::is_directory(place) ? place / "study.db" : place);
    Say("collected {} trials from {}\n", database.TrialCount() - before, place.string());
  }
}

}  // namespace

CellsFolder::CellsFolder(const SweepPlan& plan, const CellsCommand& command, const std::string& out,
                         OutputPlan files)
    : plan_(plan),
      command_(command),
      cells_(CellsOf(plan, command)),
      hash_(HashBefore(plan, FolderOf(command, out))),
      folder_(FolderOf(command, out)),
      files_(In(path(), std::move(files))),
      database_(KeepsTrials(path() / "study.db"), hash_, plan.metrics) {
  const std::filesystem::path file = path() / "study.db";
  if (const std::int64_t known = database_.TrialCount(); known > 0) {
    Say("continues from {} with {}\n", file.string(), Counted(known, "trial"));
  }
  CollectShards(command.collect, database_);
}

void CellsFolder::Run() {
  const int jobs = JobsOrCores(command_.jobs);
  const std::filesystem::path file = path() / "study.db";
  Progress progress(fmt::format("{} settings", cells_.end - cells_.first));
  try {
    RunSweep(plan_, database_,
             {.jobs = jobs,
              .cells = cells_,
              .forecast =
                  [&](const SweepForecast& forecast) {
                    Say("{} settings x {} seeds: {:.0f} trials to run, with noise-free reference "
                        "runs; about {} with {} at a time\n",
                        cells_.end - cells_.first, plan_.file.seeds, forecast.trials,
                        TimeText(forecast.seconds), jobs);
                  },
              .progress = [&](double done, double all) { return progress.Update(done, all); },
              .remark = [](const std::string& line) { Say("gauntlet: {}\n", line); }});
  } catch (const Cancelled&) {
    database_.Flush();
    const std::int64_t known = database_.TrialCount();
    throw Cancelled{
        fmt::format("{} trial{} {}", known, known == 1 ? " is" : "s are", KeptIn(file))};
  }
  if (const int damaged = database_.DamagedCount(); damaged > 0) {
    Say("gauntlet: {}: {}, computed again\n", file.string(), Counted(damaged, "damaged trial"));
  }
}

SweepSummary CellsFolder::WriteCells(const std::filesystem::path& place) {
  OutputFile table(place / "cells.csv");
  std::ofstream csv(table.temporary_path(), std::ios::binary);
  SweepSummary summary =
      WriteCellsCsv(plan_, database_, cells_, [&csv](std::string_view text) { csv << text; });
  csv.close();
  if (!csv) throw RunError(table.target().string() + ": could not be written");
  table.Commit();
  return summary;
}

}  // namespace gauntlet::sim
