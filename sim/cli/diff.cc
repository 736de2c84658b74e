#include <functional>

#include "sim/answers/compare/study_difference.h"
#include "sim/cli/commands.h"
#include "sim/cli/shared_options.h"
#include "sim/cli/standard_streams.h"
#include "sim/cli/study_command.h"
#include "sim/cli/terminal_option.h"
#include "sim/show/pages/difference_table.h"

namespace gauntlet::sim {
namespace {

struct DiffOptions {
  static constexpr auto kName = "diff";
  static constexpr auto kPurpose = "Compare settings and scores of two output folders";
  static constexpr auto kGroup = Group::kStudy;
  std::string a;
  std::string b;
  bool all = false;
  bool json = false;
  bool verbose = false;
  TerminalOptions terminal;

  Options Rows() {
    return {
        Argument("A", &a, Offer::kFolders, "output folder of run or compare"),
        Argument("B", &b, Offer::kFolders, "another"),
        Option("--all", &all, {}, "also show the scores that are the same"),
        Option("--json", &json, {}, "print JSON, with all scores"),
        VerboseOption(verbose, "also print all differences, versions, intervals and methods"),
        terminal.Rows(),
    };
  }

  static constexpr auto kNotes = R"(
Seeds that both have are compared, pair by pair; so a run can be compared with a comparison.
Without any, all of A are compared with all of B. A score differs if the 95 % interval of its
difference does not contain 0. With one seed there is no interval and every difference counts.
The largest differences come first, in multiples of the smallest relevant difference. Versions
do not count.

Example:
  gauntlet diff out/baseline out/door_opening && echo nothing changed

Exit codes: 0 the same, 1 something differs, 2 a folder is missing or incomplete.)";
};

constexpr int kDifferent = 1;

void Diff(const DiffOptions& options) {
  const StudyFolder a = ReadStudyFolder(options.a);
  const StudyFolder b = ReadStudyFolder(options.b);
  for (const StudyFolder& folder : {std::cref(a), std::cref(b)}) {
    WarnIfUnchecked(folder.name, folder.checked);
  }
  const StudyDifference difference = CompareStudies(a, b);
  if (options.json) {
    PrintText(StudyDifferenceJson(a, b, difference));
  } else {
    PrintText(
        TextOf(DifferenceText(a, b, difference, {.all = options.all, .verbose = options.verbose}),
               StyleOf(options.terminal)));
  }
  if (!difference.Same()) throw ExitCode{kDifferent};
}

}  // namespace

Command MakeDiffCommand() { return MakeCommand(Diff); }

}  // namespace gauntlet::sim
