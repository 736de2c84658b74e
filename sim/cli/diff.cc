#include <functional>
#include <memory>

#include "sim/cli/commands.h"
#include "sim/cli/standard_streams.h"
#include "sim/cli/study_command.h"
#include "sim/cli/terminal_option.h"
#include "sim/report/difference_table.h"
#include "sim/study/study_difference.h"

namespace gauntlet::sim {

namespace {

constexpr int kDifferent = 1;

struct DiffOptions {
  std::string a;
  std::string b;
  bool all = false;
  bool json = false;
  TerminalOptions terminal;
};

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
    PrintText(TextOf(DifferenceText(a, b, difference, options.all), StyleOf(options.terminal)));
  }
  if (!difference.Same()) throw CLI::RuntimeError(kDifferent);
}

}  // namespace

void AddDiffCommand(CLI::App& app) {
  CLI::App* command = app.add_subcommand(
      "diff", "Tell which settings and scores of two output folders differ; exit code 1 if any do");
  const auto options = std::make_shared<DiffOptions>();
  command->add_option("A", options->a, "output folder of run or compare")->required();
  command->add_option("B", options->b, "another")->required();
  command->add_flag("--all", options->all, "also show the scores that are the same");
  command->add_flag("--json", options->json, "print JSON, with all scores");
  AddTableOptions(*command, options->terminal);
  command->footer(
      "\nSeeds that both have are compared, pair by pair; so a run can be held beside a "
      "comparison.\n"
      "Without any, all of A are compared with all of B. A score differs if the 95 % interval of "
      "its\n"
      "difference does not hold 0. With one seed there is no interval and every difference "
      "counts.\n"
      "Versions are shown and do not count.\n"
      "\nExample:\n  gauntlet diff out/baseline out/door_opening && echo nothing changed\n"
      "\nExit codes: 0 the same, 1 something differs, 2 a folder is missing or incomplete.");
  command->callback([options] { Diff(*options); });
}

}  // namespace gauntlet::sim
