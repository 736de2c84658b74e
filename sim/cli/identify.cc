#include <fmt/format.h>
#include <fmt/ranges.h>

#include <filesystem>
#include <optional>
#include <string>
#include <utility>

#include "sim/base/error.h"
#include "sim/base/manifest.h"
#include "sim/base/text.h"
#include "sim/cli/commands.h"
#include "sim/cli/progress.h"
#include "sim/cli/shared_options.h"
#include "sim/cli/standard_streams.h"
#include "sim/cli/terminal_option.h"
#include "sim/fit/chain_tables.h"
#include "sim/fit/hand_log.h"
#include "sim/fit/identified_hand.h"
#include "sim/show/pages/chain_page.h"

namespace gauntlet::sim {
namespace {

struct IdentifyOptions {
  static constexpr auto kName = "identify";
  static constexpr auto kPurpose = "Measure a hand's delay, lag and hysteresis";
  static constexpr auto kGroup = Group::kMeasure;
  std::string log;
  std::string array;       // of a file with several
  std::string map;         // column map
  std::string controller;  // empty: the first of a trace
  std::string from = "wearer";
  std::string unit;  // of columns whose names have none
  int episode = -1;  // of a log with several; below 0: none is chosen
  std::string out;   // empty: out/<log>.chain.yaml
  bool held = false;
  bool force = false;
  bool json = false;
  bool verbose = false;
  TerminalOptions terminal;

  Options Rows() {
    return {
        Argument("log", &log, Offer::kFiles,
                 "table with a time, NAME_command_deg and NAME_deg for each joint or motor, and "
                 "NAME_motor_deg for the angle of a joint's motor, if known; or an output folder "
                 "of run, or its trace.h5"),
        OutOption(out, "file to write [out/<log>.chain.yaml]", "FILE.yaml"),
        Option("--from", &from,
               {.value = "SIGNAL", .choices = {"wearer", "target"}, .shows_default = true},
               "of an output folder: the chain from the wearer's angles (what a prediction has to "
               "compensate), or from the controller's targets"),
        Option("--controller", &controller, {.value = "NAME", .offer = Offer::kControllers},
               "of an output folder [the scenario's first]"),
        ArrayOptions(array),
        Option("--map", &map, {.value = "FILE.csv", .offer = Offer::kFiles},
               "column map: columns with the channels command, angle and motor, their joint in the "
               "key joint [by names]"),
        Option("--held", &held, {},
               "each row's command held until the next row's [where the command steps at every "
               "n-th row only]"),
        Option("--unit", &unit, {.value = "UNIT", .choices = {"deg", "rad"}},
               "unit of the angles, if the names of the columns have none"),
        Option("--episode", &episode, {.value = "N"},
               "take one episode of a log that has several [all]"),
        ForceOption(force),
        Option("--json", &json, {}, "print JSON instead of the table"),
        VerboseOption(verbose, "also print all values, confidence intervals and reasons"),
        terminal.Rows(),
    };
  }

  static constexpr auto kNotes = R"(
The delay is the time shift with the best match of command and angle. The other values
belong to a model: dead time, play, a lag of second order, gain and offset. The model gets
more parts where they predict held-out parts of the log better: friction with stretch (Dahl),
a third pole or a zero, a speed limit, a load, lost motion. A value that the log does not
determine is withheld; a remark has the reason. A log of 10 s or more with motion at several
speeds determines most values.

Other usual names of columns are read, too: target/actual, goal_position/present_position, cmd/pos,
action.X/observation.state.X. Other columns are ignored with a remark. Use --unit if neither the
names nor the values determine the unit.

Commands between rows:
- A smooth command is interpolated as a smooth curve, at 50 Hz or more.
- A command that steps at every n-th row (n of 2 or more) steps there. Use
  --held if it steps at every row, as in a log of the program that sends it.
- A log of another program contains command frames up to a row late. Their
  times are found if their period is even and 4 % or more above that of the
  rows, with jitter below an eighth of a row.
- Any other command is interpolated by straight lines. Its dead time can be
  wrong by half a row: log at 200 Hz or more.

FILE.html shows the measured angle and that of the model. FILE.hand.yaml is the servo with which
the simulated hand answers commands alike. A log from the wearer (--from wearer) gives no servo:
its chain is more than the hand.

Example:
  gauntlet run scenarios/probe_chain.yaml
  gauntlet identify out/probe_chain
  gauntlet identify out/probe_chain --from target --out out/my_hand.yaml
)";
};

namespace fs = std::filesystem;

fs::path TargetOf(const IdentifyOptions& options) {
  if (options.out.empty()) {
    fs::path log = options.log;
    if (!log.has_filename()) log = log.parent_path();  // a folder with a slash behind it
    const std::string stem = log.filename() == "trace.h5" && log.has_parent_path()
                                 ? log.parent_path().filename().string()
                                 : log.stem().string();
    return fs::path("out") / (stem + ".chain.yaml");
  }
  if (fs::path(options.out).extension() == ".html") {
    throw UserError({.place = "--out " + options.out,
                     .problem = "is the page's name, must be that of a YAML file beside it"});
  }
  return options.out;
}

/// `my_hand.html` of `my_hand.chain.yaml`.
fs::path BesideTarget(fs::path target, const std::string& ending) {
  target.replace_extension();
  if (target.extension() == ".chain") target.replace_extension();
  return target += ending;
}

void RunIdentify(const IdentifyOptions& options) {
  const fs::path target = TargetOf(options);
  const fs::path hand = BesideTarget(target, ".hand.yaml");
  const fs::path page = BesideTarget(target, ".html");
  ChainEpisodes episodes = LoadHandLog(
      options.log,
      {.controller = options.controller,
       .from_wearer = options.from == "wearer",
       .table = {.array = options.array,
                 .map = options.map,
                 .unit = options.unit,
                 .episode = options.episode < 0 ? std::nullopt : std::optional(options.episode)}});
  OutputFiles files({.folder = target.parent_path(),
                     .command = "identify",
                     .manifest = BesideTarget(target, ".manifest.json").filename(),
                     .results = {target.filename(), hand.filename(), page.filename()},
                     .editable = {target.filename(), hand.filename()},
                     .force = options.force});
  for (ChainLog& episode : episodes.logs) episode.held = options.held;
  const IdentifiedHand found = [&] {
    Progress bar("gauntlet identify");
    bar.Update(0, 1);
    return IdentifyHand(std::move(episodes), [&](int done, int all) { bar.Update(done, all); });
  }();
  const ChainResult& result = found.result;
  const IdentifiedChain& chain = found.chain;
  const std::string& servo = found.servo_yaml;
  const ChainLog& log = result.log();
  MakeDirectoryOf(target);
  files.Write([&](const fs::path& place) {
    WriteOutputFile(place / target.filename(), WithChecksum(found.chain_yaml));
    if (!servo.empty()) WriteOutputFile(place / hand.filename(), WithChecksum(servo));
    WriteOutputFile(place / page.filename(), ChainPage(result));
  });
  files.Commit();
  const std::string name = target.string();
  PrintText(options.json ? ChainJson(result, VerdictOf(result, chain, name))
                         : TextOf(ChainAnswer(result, chain, name, options.verbose),
                                  StyleOf(options.terminal)));
  FlushOutput();
  if (!log.columns_ignored.empty()) {
    Say("gauntlet: {}: ignored columns that are no command, angle or motor: {}\n", log.name,
        OneLine(fmt::format("{}", fmt::join(log.columns_ignored, ", ")), 200));
  }
  if (log.values_missing > 0) {
    Say("gauntlet: {}: {} missing values, straight lines go over them\n", log.name,
        log.values_missing);
  }
  Say("wrote {}{} and {}\n", target.string(), servo.empty() ? "" : ", " + hand.string(),
      page.string());
}

}  // namespace

Command MakeIdentifyCommand() { return MakeCommand(RunIdentify); }

}  // namespace gauntlet::sim
