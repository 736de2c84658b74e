#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace gauntlet::sim {

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

/// Errors: UserError without sbatch.
void CheckSlurm();

/// Errors: UserError for a folder that sbatch cannot write a log into.
void CheckSlurmFolder(const std::filesystem::path& folder);

/// Shards that have not ended well, from 1.
std::vector<int> MissingShards(const SlurmArray& array);

/// Shards of earlier submissions that wait or run. Errors: RunError if Slurm does not answer.
std::vector<int> QueuedShards(const SlurmArray& array);

/// A script for sbatch that runs these shards. A task that fails is queued again by Slurm, up to
/// three times, and so is one whose node fails.
std::string SlurmScript(const SlurmArray& array, const std::vector<int>& shards);

/// Writes the script for these shards and hands it over. Returns the number of the job.
/// Errors: RunError with what sbatch says.
std::string SubmitShards(const SlurmArray& array, const std::vector<int>& shards);

}  // namespace gauntlet::sim
