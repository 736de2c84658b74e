#include <fmt/format.h>
#include <fmt/ranges.h>

#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "sim/base/error.h"
#include "sim/base/manifest.h"
#include "sim/base/output_file.h"
#include "sim/base/text.h"
#include "sim/cli/commands.h"
#include "sim/cli/progress.h"
#include "sim/cli/shared_options.h"
#include "sim/cli/standard_streams.h"
#include "sim/fit/chain_episodes.h"
#include "sim/fit/chain_log.h"
#include "sim/fit/identified_hand.h"
#include "sim/fit/validation.h"
#include "sim/show/pages/pages.h"

namespace gauntlet::sim {
namespace {

/// Common part of both commands.
struct LogOptions {
  std::string log;
  ChainLogOptions table;
  std::string hand;  // of a validation; empty: a joint and a servo for each part
  std::string out;   // empty: out/<log>.chain.yaml, or out/<log>.validation.html
  bool json = false;
  TerminalOptions terminal;

  /// All but the log, --out and --hand.
  Options Rows() {
    return {
        ArrayOptions(table.array),
        TopicPairOptions(table.command, table.state),
        Option("--map", &table.map, {.value = "FILE.csv", .offer = Offer::kFiles},
               "column map: columns with the channels command, angle and motor, their joint in the "
               "key joint [by names]"),
        UnitOption(table.unit, {"deg", "rad"},
                   "unit of the angles, if the names of the columns have none"),
        TimeUnitOption(table.time_unit, {"--map"}),
        Option("--rate", &table.rate_hz, {.value = "HZ", .range = {0.01, 100000.0}},
               "rate of even rows, in a log without a time"),
        Option("--json", &json, {}, "print JSON instead of the table"),
        terminal.Rows(),
    };
  }

  Option HandOption(std::vector<std::string> needs = {}) {
    return Option("--hand", &hand,
                  {.value = "HAND.xml", .offer = Offer::kFiles, .needs = std::move(needs)},
                  "the simulated hand, with joints of the log's names and one servo for all [a "
                  "joint and a servo for each part]");
  }
};

struct IdentifyOptions : LogOptions {
  static constexpr auto kName = "identify";
  static constexpr auto kPurpose = "Measure a hand's delay, lag and hysteresis";
  static constexpr auto kGroup = Group::kMeasure;
  std::string controller;  // empty: the first of a trace
  std::string from = "wearer";
  int episode = -1;  // of a log with several; below 0: none is chosen
  bool held = false;
  bool force = false;
  bool verbose = false;
  bool validate = false;

  Options Rows() {
    return {
        Argument("log", &log, Offer::kFiles,
                 "table with a time, NAME_command_deg and NAME_deg for each joint or motor, and "
                 "NAME_motor_deg for the angle of a joint's motor, if known; or an output folder "
                 "of run, or its trace.h5"),
        OutOption(out, "file to write [out/<log>.chain.yaml]; with --validate the page", "FILE"),
        Option("--from", &from,
               {.value = "SIGNAL", .choices = {"wearer", "target"}, .shows_default = true},
               "of an output folder: the chain from the wearer's angles (what a prediction has to "
               "compensate), or from the controller's targets"),
        Option("--controller", &controller, {.value = "NAME", .offer = Offer::kControllers},
               "of an output folder [the scenario's first]"),
        LogOptions::Rows(),
        Option("--held", &held, {},
               "each row's command held until the next row's [where the command steps at every "
               "n-th row only]"),
        Option("--episode", &episode, {.value = "N"},
               "take one episode of a log that has several [all]"),
        ForceOption(force),
        VerboseOption(verbose, "also print all values, confidence intervals and reasons"),
        Option(
            "--validate", &validate,
            {.excludes = {"--from", "--controller", "--held", "--episode", "--force", "--verbose"}},
            "compare the simulated hand with the log, in place of measuring the hand"),
        HandOption({"--validate"}),
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

--validate identifies the servo from some episodes of the log. The simulated hand then gets the
commands of the others, and its angles are compared with the measured ones: delay, error, error as
a share of the motion, and the speeds at which the error arises. A log without episodes is cut into
four stretches. The page is out/<log>.validation.html unless --out names another one.

The simulated servo is no model of a part, and the verdict says so, if
- the error is above 15 % of the motion,
- the error is above that of the command, shifted by the measured delay,
- the delay differs by more than 10 ms, and by more than between episodes,
- or the error is above 1.5 times the spread of repeated motions.
Contacts, loads and limits of the real motor's current are such cases.

Example:
  gauntlet run scenarios/probe_chain.yaml
  gauntlet identify out/probe_chain
  gauntlet identify out/probe_chain --from target --out out/my_hand.yaml
  gauntlet identify log.csv --unit deg --validate
)";
};

struct ValidateOptions : LogOptions {
  static constexpr auto kName = "validate";
  static constexpr auto kPurpose = "As identify --validate";
  static constexpr auto kGroup = Group::kOther;

  Options Rows() {
    return {
        Argument("log", &log, Offer::kFiles,
                 "table or data set with commands and measured angles, as for identify"),
        OutOption(out, "page to write [out/<log>.validation.html]", "FILE.html"),
        HandOption(),
        LogOptions::Rows(),
    };
  }

  static constexpr auto kNotes = R"(
Compares the simulated hand with a real log: see gauntlet identify --help.

Example:
  gauntlet validate log.csv --unit deg
  gauntlet validate DATASET --unit rad --out out/my_hand.html
)";
};

namespace fs = std::filesystem;

/// `out/my_log.chain.yaml` of `my_log.csv`; a trace has the name of its folder.
fs::path DefaultOf(const LogOptions& options, const std::string& ending) {
  fs::path log = options.log;
  if (!log.has_filename()) log = log.parent_path();  // a folder with a slash behind it
  const bool is_trace = log.filename() == "trace.h5" && log.has_parent_path();
  const fs::path name = is_trace ? log.parent_path().filename() : log.stem();
  return fs::path("out") / (name.string() + ending);
}

fs::path TargetOf(const IdentifyOptions& options) {
  if (options.out.empty()) return DefaultOf(options, ".chain.yaml");
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

/// Runs `run` with the progress of a fit, in a bar.
auto WithProgress(const std::string& name, auto run) {
  Progress bar(name);
  bar.Update(0, 1);
  return run([&](int done, int all) { bar.Update(done, all); });
}

void ValidateHand(const LogOptions& options) {
  const fs::path page =
      options.out.empty() ? DefaultOf(options, ".validation.html") : fs::path(options.out);
  ChainEpisodes episodes = LoadChainEpisodes(options.log, options.table);
  RefuseInput(page);
  const Validation validation = WithProgress("gauntlet validate", [&](const auto& progress) {
    return Validate(std::move(episodes), options.hand, progress);
  });
  MakeDirectoryOf(page);
  WriteOutputFile(page, ValidationPage(validation));
  PrintText(options.json ? ValidationJson(validation)
                         : TextOf(ValidationText(validation), StyleOf(options.terminal)));
  FlushOutput();
  Say("wrote {}\n", page.string());
}

void RunValidate(const ValidateOptions& options) { ValidateHand(options); }

void RunIdentify(const IdentifyOptions& options) {
  if (options.validate) {
    if (fs::path(options.out).extension() == ".yaml") {
      throw UserError({.place = "--out " + options.out,
                       .problem = "is a YAML file's name, must be that of the page"});
    }
    return ValidateHand(options);
  }
  const fs::path target = TargetOf(options);
  const fs::path hand = BesideTarget(target, ".hand.yaml");
  const fs::path page = BesideTarget(target, ".html");
  HandLogOptions how{.controller = options.controller,
                     .from_wearer = options.from == "wearer",
                     .table = options.table};
  if (options.episode >= 0) how.table.episode = options.episode;
  ChainEpisodes episodes = LoadHandLog(options.log, how);
  OutputFiles files({.folder = target.parent_path(),
                     .command = "identify",
                     .manifest = BesideTarget(target, ".manifest.json").filename(),
                     .results = {target.filename(), hand.filename(), page.filename()},
                     .editable = {target.filename(), hand.filename()},
                     .force = options.force});
  for (ChainLog& episode : episodes.logs) episode.held = options.held;
  const IdentifiedHand found = WithProgress("gauntlet identify", [&](const auto& progress) {
    return IdentifyHand(std::move(episodes), progress);
  });
  const ChainResult& result = found.result;
  const IdentifiedChain& chain = found.chain;
  const std::string& servo = found.servo_yaml;
  const ChainLog& log = result.log();
  MakeDirectoryOf(target);
  files.Write([&](const fs::path& place) {
    WriteOutputFile(place / target.filename(), WithChecksum(found.chain_yaml));
    if (!servo.empty()) WriteOutputFile(place / hand.filename(), WithChecksum(servo));
    WriteOutputFile(place / page.filename(), ChainPage(result, chain, target.filename().string()));
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

Command MakeValidateCommand() { return MakeCommand(RunValidate); }

}  // namespace gauntlet::sim
