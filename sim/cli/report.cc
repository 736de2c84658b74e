
#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include "sim/answers/compare/study_difference.h"
#include "sim/base/error.h"
#include "sim/base/json.h"
#include "sim/base/output_file.h"
#include "sim/cli/commands.h"
#include "sim/cli/shared_options.h"
#include "sim/cli/standard_streams.h"
#include "sim/show/pages/difference_table.h"
#include "sim/show/pages/pages.h"

namespace gauntlet::sim {
namespace {

/// Common part of both commands.
struct DifferenceOptions {
  bool all = false;
  bool json = false;
  bool verbose = false;
  TerminalOptions terminal;

  Options Rows() {
    return {
        Option("--all", &all, {}, "also show the scores that are the same"),
        Option("--json", &json, {}, "print JSON, with all scores"),
        VerboseOption(verbose, "also print all differences, versions, intervals and methods"),
        terminal.Rows(),
    };
  }
};

struct ReportOptions : DifferenceOptions {
  static constexpr auto kName = "report";
  static constexpr auto kPurpose = "Compare output folders and write a page of them";
  static constexpr auto kGroup = Group::kStudy;
  std::vector<std::string> folders;
  std::string out = "folders.html";

  Options Rows() {
    return {
        Option("folders", &folders,
               {.value = "A B ...", .offer = Offer::kFolders, .required = true},
               "two or more output folders of run or compare"),
        OutOption(out, "page", "FILE"),
        DifferenceOptions::Rows(),
    };
  }

  static constexpr auto kNotes = R"(
Every folder is compared with the first one. The page has the settings that differ, and the scores
of all controllers side by side. --json prints a list with one entry for each folder but the first.

Seeds that both have are compared, pair by pair; so a run can be compared with a comparison.
Without any, all of A are compared with all of B. A score differs if the 95 % interval of its
difference does not contain 0. With one seed there is no interval and every difference counts.
The largest differences come first, in multiples of the smallest relevant difference. Versions
do not count.

Example:
  gauntlet report out/door_opening out/slow_servos out/fast_servos
)";
};

/// Two folders without a page; the exit code is the answer.
struct DiffOptions : DifferenceOptions {
  static constexpr auto kName = "diff";
  static constexpr auto kPurpose = "As report without a page, of two folders";
  static constexpr auto kGroup = Group::kOther;
  std::string a;
  std::string b;

  Options Rows() {
    return {
        Argument("A", &a, Offer::kFolders, "output folder of run or compare"),
        Argument("B", &b, Offer::kFolders, "another"),
        DifferenceOptions::Rows(),
    };
  }

  static constexpr auto kNotes = R"(
As report without a page: see gauntlet report --help. --json prints one object.

Example:
  gauntlet diff out/baseline out/door_opening && echo nothing changed

Exit codes: 0 the same, 1 something differs, 2 a folder is missing or incomplete.)";
};

constexpr int kDifferent = 1;

std::vector<StudyFolder> ReadFolders(const std::vector<std::string>& names) {
  std::vector<StudyFolder> folders;
  for (const std::string& name : names) folders.push_back(ReadStudyFolder(name));
  for (const StudyFolder& folder : folders) WarnIfUnchecked(folder.name, folder.checked);
  return folders;
}

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

std::string TextOfDifference(const StudyFolder& a, const StudyFolder& b,
                             const StudyDifference& difference, const DifferenceOptions& options) {
  return TextOf(DifferenceText(a, b, difference, {.all = options.all, .verbose = options.verbose}),
                StyleOf(options.terminal));
}

void Report(const ReportOptions& options) {
  if (options.folders.size() < 2) {
    throw UserError(
        {.place = "report " + options.folders.front(),
         .problem = "is one folder, needs two or more; gauntlet show prints its answer"});
  }
  std::vector<StudyFolder> folders = ReadFolders(options.folders);
  std::string text;
  Json json = Json::array();
  for (std::size_t i = 1; i < folders.size(); ++i) {
    const StudyDifference difference = CompareStudies(folders[0], folders[i]);
    if (options.json) json.push_back(StudyDifferenceJson(folders[0], folders[i], difference));
    if (i > 1) text += "\n";
    text += TextOfDifference(folders[0], folders[i], difference, options);
  }
  ShortenNames(folders);
  WriteOutputFile(options.out, FoldersPage(std::move(folders)));
  PrintText(options.json ? json.dump(2) + "\n" : text);
  FlushOutput();
  Say("wrote {}\n", options.out);
}

void Diff(const DiffOptions& options) {
  const std::vector<StudyFolder> folders = ReadFolders({options.a, options.b});
  const StudyDifference difference = CompareStudies(folders[0], folders[1]);
  PrintText(options.json ? StudyDifferenceJson(folders[0], folders[1], difference).dump(2) + "\n"
                         : TextOfDifference(folders[0], folders[1], difference, options));
  if (!difference.Same()) throw ExitCode{kDifferent};
}

}  // namespace

Command MakeReportCommand() { return MakeCommand(Report); }

Command MakeDiffCommand() { return MakeCommand(Diff); }

}  // namespace gauntlet::sim
