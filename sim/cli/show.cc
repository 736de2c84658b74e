#include "sim/cli/commands.h"
#include "sim/cli/shared_options.h"
#include "sim/cli/standard_streams.h"
#include "sim/results/answer_files.h"

namespace gauntlet::sim {
namespace {

struct ShowOptions {
  static constexpr auto kName = "show";
  static constexpr auto kPurpose = "Print the answer of an output folder again";
  static constexpr auto kGroup = Group::kStudy;
  std::string folder;
  bool verbose = false;

  Options Rows() {
    return {
        Argument("FOLDER", &folder, Offer::kFolders,
                 "output folder of run, compare, tune, sweep or robust"),
        VerboseOption(verbose, "print the answer that the command has with --verbose"),
    };
  }

  static constexpr auto kNotes = R"(
Nothing is computed: the folder holds the answer in answer.txt and answer_verbose.txt.

Example:
  gauntlet show out/door_opening --verbose
)";
};

void Show(const ShowOptions& options) {
  const KeptAnswer answer = ReadAnswer(options.folder, options.verbose);
  WarnIfUnchecked(options.folder, answer.checked);
  PrintText(answer.text);
}

}  // namespace

Command MakeShowCommand() { return MakeCommand(Show); }

}  // namespace gauntlet::sim
