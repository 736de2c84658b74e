#include <fmt/format.h>

#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include "sim/answers/compare/study_folder.h"
#include "sim/base/error.h"
#include "sim/base/output_file.h"
#include "sim/cli/commands.h"
#include "sim/cli/shared_options.h"
#include "sim/cli/standard_streams.h"
#include "sim/cli/study_command.h"
#include "sim/show/pages/folders_page.h"

namespace gauntlet::sim {
namespace {

struct ReportOptions {
  static constexpr auto kName = "report";
  static constexpr auto kPurpose = "Write one page of several output folders";
  static constexpr auto kGroup = Group::kStudy;
  std::vector<std::string> folders;
  std::string out = "folders.html";

  Options Rows() {
    return {
        Option("folders", &folders,
               {.value = "A B ...", .offer = Offer::kFolders, .required = true},
               "two or more output folders of run or compare"),
        OutOption(out, "page", "FILE"),
    };
  }

  static constexpr auto kNotes = R"(
The page has the settings that differ, and the scores of all controllers side by side. Scores are
compared with those of the first folder, as gauntlet diff does.

Example:
  gauntlet report out/door_opening out/slow_servos out/fast_servos
)";
};

/// Names without the folders above, where these tell them apart.
void ShortenNames(std::vector<StudyFolder>& folders) {
  const auto short_name = [](const StudyFolder& folder) {
    const std::filesystem::path path = std::filesystem::path(folder.name).lexically_normal();
    return (path.has_filename() ? path : path.parent_path()).filename().string();
  };
  std::set<std::string> names;
  for (const StudyFolder& folder : folders) names.insert(short_name(folder));
  if (names.size() != folders.size()) return;
  for (StudyFolder& folder : folders) folder.name = short_name(folder);
}

void Report(const ReportOptions& options) {
  if (options.folders.size() < 2) {
    throw UserError(
        {.place = "report " + options.folders.front(),
         .problem = "is one folder, needs two or more; gauntlet show prints its answer"});
  }
  std::vector<StudyFolder> folders;
  for (const std::string& folder : options.folders) {
    folders.push_back(ReadStudyFolder(folder));
    WarnIfUnchecked(folder, folders.back().checked);
  }
  ShortenNames(folders);
  WriteOutputFile(options.out, FoldersPage(folders));
  Say("wrote {}\n", options.out);
}

}  // namespace

Command MakeReportCommand() { return MakeCommand(Report); }

}  // namespace gauntlet::sim
