#include <fmt/format.h>

#include <cstdint>
#include <filesystem>
#include <string>
#include <system_error>
#include <vector>

#include "sim/base/error.h"
#include "sim/base/manifest.h"
#include "sim/base/output_folder.h"
#include "sim/cli/commands.h"
#include "sim/cli/shared_options.h"
#include "sim/cli/standard_streams.h"
#include "sim/results/runs.h"

namespace gauntlet::sim {
namespace {

namespace fs = std::filesystem;

struct CleanOptions {
  static constexpr auto kName = "clean";
  static constexpr auto kPurpose = "Remove output folders";
  static constexpr auto kGroup = Group::kOther;
  std::vector<std::string> folders;
  bool yes = false;

  Options Rows() {
    return {
        Option("folders", &folders, {.value = "FOLDER ...", .offer = Offer::kFolders},
               "output folders [all below out]"),
        Option("--yes", &yes, {}, "remove them; without it they are only listed"),
    };
  }

  static constexpr auto kNotes = R"(
Removes what Gauntlet wrote into an output folder, unless it was changed since.
Changed files, other files and exported controllers stay, and so does a folder
that holds one.

Examples:
  gauntlet clean
  gauntlet clean out/door_opening --yes
)";
};

struct Plan {
  fs::path folder;
  std::vector<fs::path> files;
  std::uintmax_t bytes = 0;
  std::size_t others = 0;  // files and folders that stay
};

Plan PlanFor(const fs::path& folder) {
  Plan plan{.folder = folder, .files = OwnFiles(folder)};
  for (const fs::path& file : plan.files) plan.bytes += fs::file_size(file);
  const auto entries = std::distance(fs::directory_iterator(folder), fs::directory_iterator());
  plan.others = static_cast<std::size_t>(entries) - plan.files.size();
  return plan;
}

void Remove(const Plan& plan) {
  {
    const OutputFolder lock(plan.folder);  // refuses a folder that another program writes
    for (const fs::path& file : OwnFiles(plan.folder)) fs::remove(file);
  }
  std::error_code not_empty;
  if (plan.others == 0) fs::remove(plan.folder, not_empty);
}

std::vector<fs::path> FoldersOf(const CleanOptions& options) {
  std::vector<fs::path> folders(options.folders.begin(), options.folders.end());
  if (!folders.empty()) return folders;
  for (const Run& run : FindRuns("out")) folders.push_back(run.folder);
  return folders;
}

void Clean(const CleanOptions& options) {
  std::vector<Plan> plans;
  for (const fs::path& folder : FoldersOf(options)) plans.push_back(PlanFor(folder));
  if (plans.empty()) return Print("No output folders below out.\n");
  std::uintmax_t bytes = 0;
  for (const Plan& plan : plans) {
    const std::string stay =
        plan.others == 0 ? "" : fmt::format("; {} of its entries stay", plan.others);
    Print("{}: {} files, {}{}\n", plan.folder.string(), plan.files.size(), SizeText(plan.bytes),
          stay);
    bytes += plan.bytes;
    if (options.yes) Remove(plan);
  }
  if (options.yes) return Print("Removed {}.\n", SizeText(bytes));
  Print("Nothing is removed. With --yes: {}.\n", SizeText(bytes));
}

}  // namespace

Command MakeCleanCommand() { return MakeCommand(Clean); }

}  // namespace gauntlet::sim
