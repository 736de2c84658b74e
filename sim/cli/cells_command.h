#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "sim/answers/sweep/sweep_result.h"
#include "sim/base/manifest.h"
#include "sim/base/output_folder.h"
#include "sim/cli/shared_options.h"

namespace gauntlet::sim {

/// Common part of `sweep` and `robust`: cells that are run into a folder with its study.db, in
/// shards or at once.
struct CellsCommand {
  std::string out;  // empty: see CellsFolder
  int jobs = 0;     // 0: one per core
  std::string shard;
  std::vector<std::string> collect;
  bool allow_programs = false;
  bool verbose = false;
  TerminalOptions terminal;

  /// --jobs, --allow-programs, --shard, --collect, --verbose, --color and --wide.
  Options Rows() {
    return {
        JobsOption(jobs),
        AllowProgramsOption(allow_programs),
        Option("--shard", &shard, {.value = "i/n"}, "run only part i of n, into its own folder"),
        Option("--collect", &collect, {.value = "DIR", .offer = Offer::kFolders},
               "collect the results of these shard folders, then run missing ones"),
        VerboseOption(verbose),
        terminal.Rows(),
    };
  }
};

/// The folder of a sweep, locked, with its database and what shards have brought.
class CellsFolder {
 public:
  /// `out`: where no --out is given; that of a shard says which one it is. `files`: what the
  /// command writes there, without the folder.
  /// Errors: UserError, SettingError; RunError.
  CellsFolder(const SweepPlan& plan, const CellsCommand& command, const std::string& out,
              OutputPlan files);

  /// Runs what the database lacks, with forecast and progress. Errors: RunError, Cancelled.
  void Run();
  /// Writes cells.csv into a folder of files().
  SweepSummary WriteCells(const std::filesystem::path& place);
  OutputFiles& files() { return files_; }

  const std::filesystem::path& path() const { return folder_.path(); }
  const CellRange& cells() const { return cells_; }
  bool is_shard() const { return cells_.end - cells_.first < plan_.cell_count(); }
  SweepDatabase& database() { return database_; }

 private:
  const SweepPlan& plan_;
  const CellsCommand& command_;
  CellRange cells_;
  std::string hash_;
  OutputFolder folder_;
  OutputFiles files_;
  SweepDatabase database_;
};

}  // namespace gauntlet::sim
