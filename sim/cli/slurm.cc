#include "sim/cli/slurm.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <array>
#include <cerrno>
#include <cstdio>
#include <sstream>
#include <system_error>

#include "sim/base/error.h"
#include "sim/base/limited_text.h"
#include "sim/base/output_file.h"
#include "sim/base/shell_word.h"
#include "sim/base/text.h"
#include "sim/cli/shared_options.h"

namespace gauntlet::sim {
namespace {

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

}  // namespace

std::vector<int> MissingShards(const SlurmArray& array) {
  std::vector<int> missing;
  for (int shard = 1; shard <= array.shards; ++shard) {
    if (ReadText(ShardFolder(array, shard) / "done") != array.hash + "\n") missing.push_back(shard);
  }
  return missing;
}

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

void CheckSlurm() {
  if (FindProgram("sbatch")) return;
  throw UserError({.place = "--slurm",
                   .problem = "there is no sbatch on PATH (Debian: slurm-client); --dry-run prints "
                              "the script, --shard i/n serves other schedulers"});
}

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

}  // namespace gauntlet::sim
