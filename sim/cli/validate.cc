#include <filesystem>
#include <string>

#include "sim/base/manifest.h"
#include "sim/base/output_file.h"
#include "sim/cli/commands.h"
#include "sim/cli/progress.h"
#include "sim/cli/shared_options.h"
#include "sim/cli/standard_streams.h"
#include "sim/cli/terminal_option.h"
#include "sim/fit/validation.h"
#include "sim/show/pages/validation_page.h"

namespace gauntlet::sim {
namespace {

struct ValidateOptions {
  static constexpr auto kName = "validate";
  static constexpr auto kPurpose = "Compare the simulated hand with a real log";
  static constexpr auto kGroup = Group::kMeasure;
  std::string log;
  std::string array;
  std::string map;
  std::string unit;
  std::string hand;
  std::string out;  // empty: out/<log>.validation.html
  bool json = false;
  TerminalOptions terminal;

  Options Rows() {
    return {
        Argument("log", &log, Offer::kFiles,
                 "table or data set with commands and measured angles, as for identify"),
        OutOption(out, "page to write [out/<log>.validation.html]", "FILE.html"),
        Option("--hand", &hand, {.value = "HAND.xml", .offer = Offer::kFiles},
               "the simulated hand, with joints of the log's names and one servo for all [a joint "
               "and a servo for each part]"),
        ArrayOptions(array),
        Option("--map", &map, {.value = "FILE.csv", .offer = Offer::kFiles},
               "column map, as for identify"),
        Option("--unit", &unit, {.value = "UNIT", .choices = {"deg", "rad"}},
               "unit of the angles, if the names of the columns have none"),
        Option("--json", &json, {}, "print JSON instead of the table"),
        terminal.Rows(),
    };
  }

  static constexpr auto kNotes = R"(
The servo is identified from some episodes of the log. The simulated hand then
gets the commands of the others, and its angles are compared with the measured
ones: delay, error, error as a share of the motion, and the speeds at which the
error arises. A log without episodes is cut into four stretches.

The simulated servo is no model of a part, and the verdict says so, if
- the error is above 15 % of the motion,
- the error is above that of the command, shifted by the measured delay,
- the delay differs by more than 10 ms, and by more than between episodes,
- or the error is above 1.5 times the spread of repeated motions.
Contacts, loads and limits of the real motor's current are such cases.

Example:
  gauntlet validate log.csv --unit deg
  gauntlet validate DATASET --unit rad --out out/my_hand.html
)";
};

namespace fs = std::filesystem;

fs::path PageOf(const ValidateOptions& options) {
  if (!options.out.empty()) return options.out;
  fs::path log = options.log;
  if (!log.has_filename()) log = log.parent_path();
  return fs::path("out") / (log.stem().string() + ".validation.html");
}

void RunValidate(const ValidateOptions& options) {
  const fs::path page = PageOf(options);
  ChainEpisodes episodes = LoadChainEpisodes(
      options.log, {.array = options.array, .map = options.map, .unit = options.unit});
  RefuseInput(page);
  Validation validation;
  {
    Progress bar("gauntlet validate");
    bar.Update(0, 1);
    validation = Validate(std::move(episodes), options.hand,
                          [&](int done, int all) { bar.Update(done, all); });
  }
  MakeDirectoryOf(page);
  WriteOutputFile(page, ValidationPage(validation));
  PrintText(options.json ? ValidationJson(validation)
                         : TextOf(ValidationText(validation), StyleOf(options.terminal)));
  FlushOutput();
  Say("wrote {}\n", page.string());
}

}  // namespace

Command MakeValidateCommand() { return MakeCommand(RunValidate); }

}  // namespace gauntlet::sim
