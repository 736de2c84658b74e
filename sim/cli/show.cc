#include <cstddef>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "sim/base/error.h"
#include "sim/cli/commands.h"
#include "sim/cli/shared_options.h"
#include "sim/cli/standard_streams.h"
#include "sim/results/answer_files.h"
#include "sim/results/runs.h"
#include "sim/show/pages/pages.h"

namespace gauntlet::sim {
namespace {

struct ShowOptions {
  static constexpr auto kName = "show";
  static constexpr auto kPurpose = "Print the answer of one output folder, or of many";
  static constexpr auto kGroup = Group::kStudy;
  std::string folder;
  bool verbose = false;

  Options Rows() {
    return {
        Argument("FOLDER", &folder, Offer::kFolders,
                 "output folder of run, compare, tune, sweep or robust, or one with such folders"),
        VerboseOption(verbose, "print the answer that the command has with --verbose"),
    };
  }

  static constexpr auto kNotes = R"(
Nothing is computed: the folder holds the answer in answer.txt and answer_verbose.txt.
For a folder of output folders, the answers are listed and runs.html there shows them.

Examples:
  gauntlet show out/door_opening --verbose
  gauntlet show out
)";
};

/// Errors: UserError for a page that no command wrote: a person's own of this name.
void RefuseForeignPage(const std::filesystem::path& page) {
  constexpr std::size_t kHead = 1024;
  std::string head(kHead, '\0');
  std::ifstream file(page, std::ios::binary);
  if (!file) return;
  file.read(head.data(), kHead);
  if (head.find("Gauntlet list runs") != head.npos) return;
  throw UserError({.place = page.string(),
                   .problem = "is a file that Gauntlet did not write, and stays; gauntlet list "
                              "runs --out PAGE.html names another"});
}

void ShowRuns(const std::vector<Run>& runs, const std::filesystem::path& folder) {
  const std::filesystem::path page = folder / "runs.html";
  RefuseForeignPage(page);
  WriteRunsPage(runs, page);
  for (const Run& run : runs) {
    Print("{}\n", run.folder.string());
    for (const std::string& line : LinesOf(run)) PrintIndented(line);
  }
  FlushOutput();
  Say("wrote {}\n", page.string());
}

void Show(const ShowOptions& options) {
  std::error_code ignored;
  if (!std::filesystem::exists(std::filesystem::path(options.folder) / kAnswerFile, ignored)) {
    const std::vector<Run> runs = FindRuns(options.folder);
    if (!runs.empty()) return ShowRuns(runs, options.folder);
  }
  const KeptAnswer answer = ReadAnswer(options.folder, options.verbose);
  WarnIfUnchecked(options.folder, answer.checked);
  PrintText(answer.text);
}

}  // namespace

Command MakeShowCommand() { return MakeCommand(Show); }

}  // namespace gauntlet::sim
