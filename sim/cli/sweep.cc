#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <numeric>
#include <string>
#include <vector>

#include "sim/answers/sweep/sweep_tables.h"
#include "sim/base/data_folder.h"
#include "sim/base/error.h"
#include "sim/base/output_file.h"
#include "sim/base/shell_word.h"
#include "sim/base/text.h"
#include "sim/cli/cells_command.h"
#include "sim/cli/commands.h"
#include "sim/cli/shared_options.h"
#include "sim/cli/slurm.h"
#include "sim/cli/standard_streams.h"
#include "sim/results/answer_files.h"
#include "sim/results/runs.h"
#include "sim/show/pages/pages.h"
#include "sim/study/study.h"
#include "sim/trial/external/external_filters.h"

namespace gauntlet::sim {
namespace {

struct SweepCommand {
  static constexpr auto kName = "sweep";
  static constexpr auto kPurpose = "Run a study file: many settings of a scenario";
  static constexpr auto kGroup = Group::kStudy;
  std::string file;
  CellsCommand cells;
  std::vector<std::string> set;
  int seeds = 0;  // 0: as the file says
  std::int64_t max_cells = 10'000;
  bool filter_only = false;
  bool json = false;
  bool slurm = false;
  bool dry_run = false;
  bool retry = false;
  int tasks = 16;
  std::vector<std::string> sbatch;

  Options Rows() {
    return {
        Argument("study", &file, Offer::kStudies,
                 "study file (YAML), or the name of a ready one in studies/"),
        OutOption(cells.out, "output folder [out/<study>]"),
        SetOption(set, "change a value of the base scenario; may be repeated"),
        Option("--seeds", &seeds, {.range = {1, 100000}}, "number of seeds [as in the study file]"),
        Option("--max-cells", &max_cells, {.range = {1, 1'000'000'000}},
               "limit of the number of settings [10000]"),
        Option("--filter-only", &filter_only, {}, "score the filter outputs, without the hand"),
        cells.Rows(),
        Option("--json", &json, {}, "print JSON instead of the answer"),
        Option("--slurm", &slurm, {}, "submit the shards to Slurm as a job array"),
        Option("--tasks", &tasks, {.range = {1, 1000}},
               "largest number of shards with --slurm [16]"),
        Option("--retry", &retry, {}, "with --slurm: submit only failed and missing shards"),
        Option("--dry-run", &dry_run, {}, "with --slurm: print the script only"),
        Option("--sbatch", &sbatch, {.value = "--OPTION"},
               "option for sbatch, like --sbatch=--partition=night; may be repeated"),
    };
  }

  static constexpr auto kNotes = R"(
Examples:
  gauntlet sweep studies/kalman_q.yaml
  gauntlet sweep studies/kalman_q.yaml --shard 1/2   # on one machine
  gauntlet sweep studies/kalman_q.yaml --shard 2/2   # on another; then
  gauntlet sweep studies/kalman_q.yaml --collect out/kalman_q.shard-*
  gauntlet sweep studies/kalman_q.yaml --slurm --sbatch=--time=1:00:00
)";
};

void CheckSize(const SweepPlan& plan, const SweepCommand& command) {
  const std::int64_t cells = plan.cell_count();
  if (cells <= command.max_cells) return;
  throw UserError({.place = command.file,
                   .key = "axes",
                   .problem = fmt::format("make {} settings, more than --max-cells {}", cells,
                                          command.max_cells)});
}

/// Errors: UserError for options that contradict each other.
void CheckSlurmOptions(const SweepCommand& command) {
  const auto fail = [](const std::string& option, const std::string& problem) {
    throw UserError({.place = option, .problem = problem});
  };
  if (!command.slurm) {
    if (command.dry_run) fail("--dry-run", "is of --slurm, which is not given");
    if (command.retry) fail("--retry", "is of --slurm, which is not given");
    if (!command.sbatch.empty()) fail("--sbatch", "is of --slurm, which is not given");
    return;
  }
  if (!command.cells.shard.empty()) fail("--slurm", "and --shard contradict each other");
  if (!command.cells.collect.empty()) fail("--slurm", "and --collect contradict each other");
  for (const std::string& option : command.sbatch) {
    if (option.starts_with("--") && option.find('\n') == std::string::npos) continue;
    fail("--sbatch " + Shown(option), "must be an option of sbatch, as --sbatch=--partition=night");
  }
}

/// The options that decide which cells there are and what is in them.
std::vector<std::string> OptionsOfCells(const SweepCommand& command) {
  std::vector<std::string> words;
  const auto add = [&words](const std::string& option, const std::string& value) {
    words.insert(words.end(), {option, value});
  };
  if (command.max_cells != SweepCommand().max_cells) {
    add("--max-cells", std::to_string(command.max_cells));
  }
  if (command.seeds > 0) add("--seeds", std::to_string(command.seeds));
  for (const std::string& set : command.set) add("--set", set);
  if (command.cells.allow_programs) words.emplace_back("--allow-programs");
  if (command.filter_only) words.emplace_back("--filter-only");
  return words;
}

SlurmArray ArrayOf(const SweepCommand& command, const SweepPlan& plan) {
  const std::string study =
      std::filesystem::absolute(ReadyFile(command.file, "studies", "study")).string();
  const std::string out = command.cells.out.empty() ? "out/" + plan.file.name : command.cells.out;
  SlurmArray array{
      .name = "gauntlet-" + plan.file.name,
      .command = {std::filesystem::read_symlink("/proc/self/exe").string(), "sweep", study},
      .folder = std::filesystem::absolute(out) / "slurm",
      .hash = HashOfSweep(plan),
      .options = command.sbatch};
  CheckSlurmFolder(std::filesystem::current_path());
  CheckSlurmFolder(array.folder);
  array.jobs = std::max(1, command.cells.jobs);
  array.shards = static_cast<int>(std::min<std::int64_t>(command.tasks, plan.cell_count()));
  array.command.insert(array.command.end(), {"--jobs", std::to_string(array.jobs)});
  std::ranges::move(OptionsOfCells(command), std::back_inserter(array.command));
  return array;
}

/// Takes the shards together; the shell finds their folders.
std::string CollectCommand(const SweepCommand& command, const SlurmArray& array) {
  std::string text = "gauntlet sweep " + ShellPath(command.file);
  if (!command.cells.out.empty()) text += " --out " + ShellPath(command.cells.out);
  for (const std::string& word : OptionsOfCells(command)) text.append(" ").append(ShellWord(word));
  return text + fmt::format(" --collect {}/shard-*-of-{}", ShellPath(array.folder), array.shards);
}

/// Hands the sweep to Slurm, or says what would be handed over.
void SubmitSweep(const SweepCommand& command, const SweepPlan& plan) {
  if (!command.dry_run) CheckSlurm();
  const SlurmArray array = ArrayOf(command, plan);
  const std::string collect = CollectCommand(command, array);
  std::vector<int> shards = MissingShards(array);
  if (!command.retry) {
    shards.resize(static_cast<std::size_t>(array.shards));
    std::iota(shards.begin(), shards.end(), 1);
  }
  if (command.dry_run) {
    PrintText(shards.empty() ? "" : SlurmScript(array, shards));
    return FlushOutput();
  }
  const std::vector<int> queued = QueuedShards(array);
  if (!queued.empty() && !command.retry) {
    throw UserError({.place = "--slurm",
                     .problem = fmt::format("{} tasks of this sweep are in Slurm's queue already; "
                                            "--retry adds what is missing beside them",
                                            queued.size())});
  }
  std::erase_if(shards, [&](int shard) { return std::ranges::count(queued, shard) > 0; });
  if (shards.empty()) {
    if (queued.empty()) return Say("nothing is missing; now: {}\n", collect);
    return Say("nothing is missing beside {} tasks in Slurm's queue; then: {}\n", queued.size(),
               collect);
  }
  const std::string job = SubmitShards(array, shards);
  Say("job {}: {} of {} shards; when they have ended: {}\n", job, shards.size(), array.shards,
      collect);
}

void RunSweepCommand(const SweepCommand& command) {
  if (command.cells.allow_programs) AllowPrograms();
  CheckSlurmOptions(command);
  SweepOverrides overrides{.seeds = {}, .filter_only = command.filter_only, .set = command.set};
  if (command.seeds > 0) overrides.seeds = command.seeds;
  const SweepPlan plan = LoadSweepPlan(ReadyFile(command.file, "studies", "study"), overrides);
  CheckSize(plan, command);
  CheckProgramsOf(plan.scenario, plan.file.controllers);
  if (command.slurm) return SubmitSweep(command, plan);
  CellsFolder folder(plan, command.cells, "out/" + plan.file.name,
                     {.folder = {},
                      .command = "sweep",
                      .choices = ChoicesText({.set = command.set}),
                      .results = {"report.html", "cells.csv", kAnswerFile, kVerboseAnswerFile}});
  folder.Run();
  SweepSummary summary;
  const Response response = ReadResponse(plan, folder.database(), folder.cells());
  folder.files().Write([&](const std::filesystem::path& place) {
    summary = folder.WriteCells(place);
    WriteOutputFile(place / "report.html",
                    SweepPage(plan, folder.database(), folder.cells(), summary, response));
    WriteAnswer(place, SweepText(plan, summary, response, false),
                SweepText(plan, summary, response, true));
  });
  folder.files().Commit();
  if (command.json) {
    WriteSweepJson(plan, folder.database(), folder.cells(), summary,
                   [](std::string_view text) { PrintText(text); });
  } else {
    PrintText(TextOf(SweepText(plan, summary, response, command.cells.verbose),
                     StyleOf(command.cells.terminal)));
  }
  FlushOutput();
  Say("wrote {}: report.html, cells.csv, study.db, manifest.json\n", folder.path().string());
  if (summary.results == 0) throw RunError("no setting has scores: " + summary.first_problem);
}

}  // namespace

Command MakeSweepCommand() { return MakeCommand(RunSweepCommand); }

}  // namespace gauntlet::sim
