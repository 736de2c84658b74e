#include <fmt/format.h>
#include <fmt/ranges.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <iterator>
#include <numeric>
#include <sstream>
#include <string>
#include <system_error>
#include <vector>

#include "sim/answers/sweep/sweep_tables.h"
#include "sim/base/data_folder.h"
#include "sim/base/error.h"
#include "sim/base/limited_text.h"
#include "sim/base/output_file.h"
#include "sim/base/shell_word.h"
#include "sim/base/text.h"
#include "sim/cli/cells_command.h"
#include "sim/cli/commands.h"
#include "sim/cli/shared_options.h"
#include "sim/cli/standard_streams.h"
#include "sim/results/answer_files.h"
#include "sim/results/runs.h"
#include "sim/show/pages/pages.h"
#include "sim/study/study.h"
#include "sim/trial/external/external_filters.h"

namespace gauntlet::sim {
namespace {

/// A sweep as an array of jobs for Slurm: task i runs shard i of `shards`.
///
///     folder/sweep.sbatch        the script
///     folder/jobs.txt            the numbers that Slurm gave, one a line
///     folder/shard-2-of-8/       what a task writes; `done` holds `hash` when it has ended well
///     folder/shard-2-of-8.log    what it says
struct SlurmArray {
  std::string name;
  std::vector<std::string> command;  // the program and its arguments, but --shard and --out
  std::filesystem::path folder;      // absolute
  std::string hash;                  // of the sweep: what is done for another is not done
  int shards = 1;
  int jobs = 1;                      // processors of a task
  std::vector<std::string> options;  // more for sbatch, as --partition=night
};

namespace fs = std::filesystem;

constexpr int kMostRestarts = 3;

/// In the quotes of an option behind #SBATCH; % would stand for numbers of the job.
std::string Escaped(const std::string& text) {
  std::string escaped;
  for (const char c : text) {
    if (c == '"' || c == '\\') escaped += '\\';
    escaped += c == '%' ? "%%" : std::string(1, c);
  }
  return escaped;
}

/// Both outputs of a program, and its end.
struct Said {
  bool is_good = false;
  std::string text;

  std::string FirstLine() const { return Shown(text.substr(0, text.find('\n'))); }
};

/// Runs a program of Slurm, found along PATH. Errors: std::system_error without a process.
Said Ask(const std::vector<std::string>& command) {
  std::string line;
  for (const std::string& word : command) line += ShellWord(word) + " ";
  std::FILE* const output = popen((line + "2>&1").c_str(), "re");
  if (output == nullptr) throw std::system_error(errno, std::generic_category(), command.front());
  Said said;
  std::array<char, 4096> part{};
  while (const std::size_t got = std::fread(part.data(), 1, part.size(), output)) {
    said.text.append(part.data(), got);
  }
  said.is_good = pclose(output) == 0;
  return said;
}

/// A file of a submission; empty without one.
std::string ReadText(const fs::path& file) {
  return LimitedTextIfAny(file, kMostEditableBytes).value_or("");
}

/// Folders of the shards, 1 to `shards`.
fs::path ShardFolder(const SlurmArray& array, int shard) {
  return array.folder / fmt::format("shard-{}-of-{}", shard, array.shards);
}

/// Those that have not ended well, from 1.
std::vector<int> MissingShards(const SlurmArray& array) {
  std::vector<int> missing;
  for (int shard = 1; shard <= array.shards; ++shard) {
    if (ReadText(ShardFolder(array, shard) / "done") != array.hash + "\n") missing.push_back(shard);
  }
  return missing;
}

/// Errors: UserError for a folder that sbatch cannot write a log into.
void CheckSlurmFolder(const fs::path& folder) {
  std::string problem = TextProblem(folder.native());
  // A backslash would keep sbatch from putting numbers in the place of %a.
  if (folder.native().find_first_of("\n\t\\") != std::string::npos) {
    problem = "has an end of a line, a tabulator or a backslash";
  }
  if (problem.empty()) return;
  throw UserError(
      {.place = "--slurm",
       .problem = fmt::format("the path {} {}, which sbatch does not take; give another "
                              "--out or working folder",
                              Shown(folder.native()), problem)});
}

/// A script for sbatch that runs these shards. A task that fails is queued again by Slurm, up to
/// three times, and so is one whose node fails.
std::string SlurmScript(const SlurmArray& array, const std::vector<int>& shards) {
  std::string options;
  for (const std::string& option : array.options) options += "#SBATCH " + option + "\n";
  std::vector<std::string> words;
  for (const std::string& word : array.command) words.push_back(ShellWord(word));
  const std::string folder = array.folder.string();
  return fmt::format(
      "#!/bin/bash\n"
      "#SBATCH --job-name=\"{0}\"\n"
      "#SBATCH --array={1}\n"
      "#SBATCH --cpus-per-task={2}\n"
      "#SBATCH --requeue\n"
      "#SBATCH --open-mode=append\n"
      "#SBATCH --output=\"{3}/shard-%a-of-{6}.log\"\n"
      "{4}"
      "# Each task runs one shard. One that failed goes on from its study.db when it is run "
      "again.\n"
      "shard=$SLURM_ARRAY_TASK_ID\n"
      "folder={5}/shard-$shard-of-{6}\n"
      "{7} --shard \"$shard/{6}\" --out \"$folder\"\n"
      "code=$?\n"
      "if ((code == 0)); then\n"
      "  echo {8} >\"$folder/done\"\n"
      "elif ((code != 2 && ${{SLURM_RESTART_COUNT:-0}} < {9})); then\n"
      "  scontrol requeue \"${{SLURM_ARRAY_JOB_ID}}_$shard\"\n"
      "fi\n"
      "exit $code\n",
      Escaped(array.name), fmt::join(shards, ","), array.jobs, Escaped(folder), options,
      ShellPath(folder), array.shards, fmt::join(words, " "), array.hash, kMostRestarts);
}

/// Errors: UserError without sbatch.
void CheckSlurm() {
  const char* path = std::getenv("PATH");
  std::istringstream folders(path == nullptr ? "" : path);
  for (std::string folder; std::getline(folders, folder, ':');) {
    if (access((fs::path(folder) / "sbatch").c_str(), X_OK) == 0) return;
  }
  throw UserError({.place = "--slurm",
                   .problem = "there is no sbatch on PATH (Debian: slurm-client); --dry-run prints "
                              "the script, --shard i/n serves other schedulers"});
}

/// Shards of earlier submissions that wait or run. Errors: RunError if Slurm does not answer.
std::vector<int> QueuedShards(const SlurmArray& array) {
  std::vector<int> queued;
  std::istringstream jobs(ReadText(array.folder / "jobs.txt"));
  for (std::string job; std::getline(jobs, job);) {
    const Said said = Ask({"squeue", "--noheader", "--array", "--format=%K", "--jobs=" + job});
    if (said.text.find("Invalid job id") != std::string::npos) continue;  // long gone
    if (!said.is_good) throw RunError("squeue: " + said.FirstLine());
    std::istringstream tasks(said.text);
    for (int task = 0; tasks >> task;) queued.push_back(task);
  }
  return queued;
}

/// Writes the script for these shards and hands it over. Returns the number of the job.
/// Errors: RunError with what sbatch says.
std::string SubmitShards(const SlurmArray& array, const std::vector<int>& shards) {
  if (std::error_code none; fs::is_symlink(array.folder, none)) {
    throw UserError({.place = array.folder.string(), .problem = "is a link, must be a folder"});
  }
  MakeDirectory(array.folder);
  const fs::path script = array.folder / "sweep.sbatch";
  WriteOutputFile(script, SlurmScript(array, shards));
  const Said said = Ask({"sbatch", "--parsable", script.string()});
  if (!said.is_good) throw RunError("sbatch: " + said.FirstLine());
  std::string job = said.text.substr(0, said.text.find_first_of(";\n"));
  WriteOutputFile(array.folder / "jobs.txt", ReadText(array.folder / "jobs.txt") + job + "\n");
  return job;
}

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
