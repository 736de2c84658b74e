#include "sim/fit/audit.h"

#include <fmt/format.h>

#include <filesystem>
#include <string>

#include "sim/base/output_file.h"
#include "sim/cli/commands.h"
#include "sim/cli/progress.h"
#include "sim/cli/shared_options.h"
#include "sim/cli/standard_streams.h"
#include "sim/show/pages/pages.h"

namespace gauntlet::sim {
namespace {

struct AuditOptions {
  static constexpr auto kName = "audit";
  static constexpr auto kPurpose = "Check commands, delays, offsets of a data set";
  static constexpr auto kGroup = Group::kMeasure;
  std::string log;
  ChainLogOptions table;
  int episode = -1;  // below 0: all
  std::string out;
  bool json = false;
  bool verbose = false;
  TerminalOptions terminal;

  Options Rows() {
    return {
        Argument("log", &log, Offer::kFiles,
                 "LeRobot folder or table with a command and a measured angle for each joint or "
                 "motor, as for identify"),
        OutOption(out, "page to write [none]", "FILE.html"),
        ArrayOptions(table.array),
        TopicPairOptions(table.command, table.state),
        Option("--map", &table.map, {.value = "FILE.csv", .offer = Offer::kFiles},
               "column map: columns with the channels command and angle, their joint in the key "
               "joint [by names]"),
        UnitOption(table.unit, {"deg", "rad"},
                   "unit of the angles, if the names of the columns have none"),
        TimeUnitOption(table.time_unit, {"--map"}),
        Option("--episode", &episode, {.value = "N"}, "audit one episode [all]"),
        Option("--rate", &table.rate_hz, {.value = "HZ", .range = {0.01, 100000.0}},
               "rate of even rows, in a log without a time"),
        Option("--json", &json, {}, "print JSON instead of the table, with all episodes"),
        VerboseOption(verbose, "also print all parts, all faults and ignored columns"),
        terminal.Rows(),
    };
  }

  static constexpr auto kNotes = R"(
For each part, audit reports:
- The kind of its commands: targets; copies of the angle in the same or another
  row, also in some of the rows; steps or speeds of the angle; the command of another part; unrelated.
  Only targets have a delay.
- The delay of the angle with a 95 % confidence interval, and whether it drifts
  or varies.
- The offset: median of the angle less the delayed command. Above 5 % of the
  motion it counts: a policy that learns from angles and acts by commands is
  wrong by as much.
- The gain, the error at rest and the residual (--verbose).
- Faults: episodes that are not as the others (still, opposite, ahead, copies),
  clipped commands, an angle that stops or stands still, jumps by a full turn,
  motion that the command does not explain.

Of the data set it reports angles that are older than their rows, repeated rows, gaps, two
senders, and missing values, rows and episodes. An episode above 20 s is cut into stretches of 10 s, episodes below 5 s are used together.
Bags of ROS have command and state in two topics: see --command and --state.
For lag, hysteresis and the servo of a single hand see gauntlet identify.

Example:
  gauntlet audit DATASET
  gauntlet audit DATASET --unit deg --out audit.html
  gauntlet audit bag.mcap --command /joint_commands --state /joint_states
  gauntlet audit log.csv --json
)";
};

void RunAudit(const AuditOptions& options) {
  const std::filesystem::path page = options.out;
  if (!page.empty()) RefuseInput(page);
  ChainLogOptions table = options.table;
  if (options.episode >= 0) table.episode = options.episode;
  Progress bar("gauntlet audit");
  const Audit audit = AuditLog(options.log, table, [&](double share) { bar.Update(share, 1.0); });
  if (!page.empty()) {
    MakeDirectoryOf(page);
    WriteOutputFile(page, AuditPage(audit));
  }
  PrintText(options.json ? AuditJson(audit)
                         : TextOf(AuditText(audit, options.verbose), StyleOf(options.terminal)));
  FlushOutput();
  if (!page.empty()) Say("wrote {}\n", page.string());
}

}  // namespace

Command MakeAuditCommand() { return MakeCommand(RunAudit); }

}  // namespace gauntlet::sim
