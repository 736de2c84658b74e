#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include "sim/base/error.h"
#include "sim/base/output_file.h"
#include "sim/base/shell_word.h"
#include "sim/base/text.h"
#include "sim/cli/commands.h"
#include "sim/cli/inspect_hand.h"
#include "sim/cli/joint_question.h"
#include "sim/cli/recording_scenario.h"
#include "sim/cli/shared_options.h"
#include "sim/cli/standard_streams.h"
#include "sim/recordings/inspect/inspection.h"
#include "sim/recordings/inspect/inspection_tables.h"
#include "sim/recordings/inspect/joint_answer.h"
#include "sim/recordings/inspect/starter_files.h"
#include "sim/results/table_text.h"
#include "sim/show/pages/pages.h"
#include "sim/show/video/drawing_library.h"
#include "sim/show/video/recording_picture.h"

namespace gauntlet::sim {
namespace {

struct InspectOptions {
  static constexpr auto kName = "inspect";
  static constexpr auto kPurpose = "Detect a file's format; write its map and scenario";
  static constexpr auto kGroup = Group::kEveryday;
  std::string file;
  std::string map;
  std::string scenario;
  std::string plot;
  std::string page;
  RecordingArguments recording;
  bool verbose = false;
  bool force = false;
  bool json = false;

  Options Rows() {
    return {
        Argument("file", &file, Offer::kFiles, "the recording; or a hand as MJCF (.xml)"),
        Option("--write-map", &map, {.value = "MAP.csv"},
               "write a column map, to be checked [beside the scenario]"),
        Option("--write-scenario", &scenario, {.value = "FILE.yaml", .offer = Offer::kFiles},
               "write a scenario that plays the recording, or moves the hand, with a few filters"),
        Option("--plot", &plot, {.value = "FILE.png", .offer = Offer::kFiles}, "draw its sensors"),
        OutOption(page, "write a page: health of the sensors, joints, a picture of each channel",
                  "PAGE.html"),
        recording.Rows(),
        Option("--map", &recording.inspection.map, {.value = "MAP.csv", .offer = Offer::kFiles},
               "a filled-in column map: its joints count, and the scenario uses it"),
        ForceOption(force),
        Option("--verbose", &verbose, {}, "print reasons and more statistics"),
        Option("--json", &json, {}, "print JSON instead of the table"),
    };
  }

  static constexpr auto kNotes = R"(
The format is found from the bytes. Of a text above 1 GB the beginning is read. Noise is the
standard deviation from the curvature between three rows; still is the share of values equal to
the row before, clipped the share of the lowest and highest value. A dead sensor has one value
in 99 % of the rows, or in 95 % and a narrow range. If the joints are unknown, the command asks
and returns 2. At a terminal it waits for the answer and writes it as a column map.

Example:
  gauntlet inspect my_glove.csv --write-scenario my_glove.yaml --plot my_glove.png
  gauntlet compare my_glove.yaml
  gauntlet inspect my_hand.xml --write-scenario my_hand.yaml
)";
};

namespace fs = std::filesystem;

std::string HeaderText(const TableLayout& layout) {
  std::string text;
  if (layout.skipped_lines > 0) text = fmt::format("{} lines before it, ", layout.skipped_lines);
  return text + (layout.has_header ? "names in its first line" : "no line of names");
}

/// Which of a file's arrays are the table, and why.
void PrintArrays(const Inspection& inspection) {
  if (inspection.arrays.size() < 2) return;
  std::vector<ListedArray> taken;
  std::vector<ListedArray> left_out;
  for (const ListedArray& array : inspection.arrays) {
    (array.is_taken ? taken : left_out).push_back(array);
  }
  constexpr std::size_t kWidth = 80;
  const std::string text =
      fmt::format("arrays  {}: {}", TextOf(taken),
                  inspection.array.empty() ? "of this number of rows, which holds the most values"
                                           : "what --array names, and its time");
  Print("{}\n", Wrapped(text, kWidth));
  if (left_out.empty()) return;
  Print("{}\n", Wrapped(fmt::format("not {}; --array NAME takes them", TextOf(left_out)), kWidth));
}

/// The first topics, those with signals before the others.
void PrintTopicsTable(std::vector<ListedTopic> topics) {
  constexpr std::size_t kMost = 50;
  const std::size_t more = topics.size() - std::min(topics.size(), kMost);
  if (more > 0) {
    std::stable_partition(topics.begin(), topics.end(),
                          [](const ListedTopic& topic) { return topic.has_signals; });
  }
  topics.resize(topics.size() - more);
  Print("{}", TextOf(TopicsTable(topics), StyleOf({})));
  if (more > 0) Print("and {} more, in --json\n", more);
}

/// The topics of a file of messages, and whose times are used.
void PrintTopics(const Inspection& inspection) {
  const auto taken = std::ranges::find_if(inspection.topics, &ListedTopic::is_taken);
  if (taken == inspection.topics.end()) return;
  Print("topic   {}{}\n", OneLine(taken->name, 70),
        inspection.array.empty() ? ", the only one with signals" : "");
  Print("stamps  {}\n", taken->has_stamps
                            ? "times in the headers of the messages"
                            : "times of the recorder; not every message has one of its own");
  if (inspection.topics.size() < 2) return;
  Print("\n");
  PrintTopicsTable(inspection.topics);
}

std::string Times(std::size_t count) {
  return count == 1 ? "once" : fmt::format("{} times", count);
}

/// Missing values of the joints; gaps, restarts and repeats of the time.
void PrintDefects(const Inspection& inspection) {
  const std::vector<std::size_t> joints = inspection.MappedColumns();
  double values = 0.0;
  for (const std::size_t c : joints) {
    values += static_cast<double>(inspection.columns[c].statistics.good_rows);
  }
  const auto all = static_cast<double>(joints.size() * inspection.rows);
  constexpr double kWorthALine = 0.005;
  if (all > 0.0 && values < (1.0 - kWorthALine) * all) {
    Print(
        "missing {:.0f} % of the joints' values; a joint does not count where its own is missing\n",
        100.0 * (1.0 - values / all));
  }
  const TimeStatistics& time = inspection.time;
  if (inspection.has_time && time.missing > 0) {
    Print("time    missing in {} rows, which do not count\n", time.missing);
  }
  if (time.gaps > 0) Print("gaps    {}, the longest {:.4g} s\n", time.gaps, time.longest_gap_s);
  if (time.restarts > 0) Print("time    goes back {}\n", Times(time.restarts));
  if (time.repeats > 0) Print("time    repeats {}\n", Times(time.repeats));
}

void PrintTime(const Inspection& inspection) {
  const TimeStatistics& time = inspection.time;
  if (!inspection.has_time) {
    Print("time    none: {}\n", inspection.time_why);
    Print("rate    {:.5g} Hz, {}\n", time.rate_hz,
          inspection.rate_is_known ? "as given" : "assumed; --rate HZ gives it");
    return;
  }
  Print("time    {}\n", inspection.time_why);
  Print("rate    {:.5g} Hz, nine in ten rows after {:.3g} to {:.3g} ms; {:.5g} s\n", time.rate_hz,
        time.short_ms, time.long_ms, time.duration_s);
}

/// Format, time, unit and repairs, with reasons.
void PrintDetails(const Inspection& inspection) {
  const TableLayout& layout = inspection.layout;
  Print("format  {}, {} between entries{}; {}\n", NameOf(inspection.format),
        SeparatorText(layout.separator), layout.decimal_comma ? ", decimal comma" : "",
        HeaderText(layout));
  PrintArrays(inspection);
  PrintTopics(inspection);
  PrintTime(inspection);
  PrintDefects(inspection);
  if (inspection.unit != RawUnit::kUnknown) {
    const std::string bits =
        inspection.bits > 0 ? fmt::format(" of {} bits", inspection.bits) : std::string();
    Print("unit    {}{}: {}\n", NameOf(inspection.unit), bits, inspection.unit_why);
  }
  for (const auto& [kind, count] : inspection.problems) {
    Print("repair  {}: {} times\n", kind, count);
  }
}

void PrintInspection(const Inspection& inspection, bool is_verbose) {
  if (inspection.layout.columns == 0) {  // which topic is the table has to be chosen first
    PrintTopicsTable(inspection.topics);
    return;
  }
  Print("{}\n", SummaryOf(inspection));
  if (const std::string health = HealthText(inspection); !health.empty()) Print("{}", health);
  Print("file    {}\n", OneLine(inspection.file, 70));
  Print("size    {} rows of {} columns, {:.5g} s{}\n", inspection.rows, inspection.layout.columns,
        inspection.time.duration_s,
        inspection.is_whole ? ""
                            : fmt::format("; the first {} of {} MB, not the rest",
                                          kMostInspectedBytes >> 20, inspection.file_bytes >> 20));
  Print("joints  {}\n", BasisText(inspection));
  for (const std::string& remark : inspection.remarks) {
    Print("{}\n", Wrapped("note    " + remark, 80));
  }
  for (std::size_t c = 0; c < inspection.columns.size(); ++c) {
    if (!inspection.columns[c].is_turning) continue;
    Print("turns   column {} jumps by 360 deg; the jumps are undone\n", c + 1);
  }
  if (!is_verbose) {
    PrintArrays(inspection);
    PrintTopics(inspection);
    PrintDefects(inspection);
  } else {
    PrintDetails(inspection);
  }
  Print("\n{}", TextOf(ColumnsTable(inspection, is_verbose), StyleOf({})));
  if (const std::string noise = NoiseText(inspection); !noise.empty()) Print("\n{}\n", noise);
}

/// Errors: UserError, before anything is written, for a target that must stay.
void CheckTargets(const std::string& map, const InspectOptions& options) {
  const std::vector<std::string> targets = {map, options.scenario, options.plot, options.page};
  for (const std::string& target : targets) {
    if (target.empty()) continue;
    RefuseInput(target);
    if (std::ranges::count(targets, target) > 1) {
      throw UserError({.place = target, .problem = "is the name of two outputs"});
    }
  }
  if (!options.page.empty() && fs::path(options.page).extension() != ".html") {
    throw UserError({.place = "--out " + options.page, .problem = "a page must end in .html"});
  }
  if (options.force) return;
  for (const std::string& target : {map, options.scenario}) RefuseEdited(target);
}

/// The command that compares filters on the recording; with assumed joints behind a check of them.
std::string NextCommand(const Inspection& inspection, const std::string& given_map,
                        const std::string& written_map) {
  const std::string file = ShellPath(inspection.file);
  const std::string& map = given_map.empty() ? written_map : given_map;
  if (!map.empty()) return fmt::format("gauntlet compare {} --map {}", file, ShellPath(map));
  const bool is_assumed = inspection.HasAssumedJoint();
  const bool is_plain = inspection.has_time && inspection.array.empty();
  if (!is_assumed && is_plain) return fmt::format("gauntlet compare {}", file);
  const std::string scenario =
      ShellPath(fs::path(inspection.file).filename().replace_extension(".yaml").string());
  return fmt::format("gauntlet inspect {} --write-scenario {}\n      gauntlet compare {}", file,
                     scenario, scenario);
}

/// The column map beside a recording, or beside the folder of a data set.
std::string MapBeside(const std::string& recording) {
  fs::path file = recording;
  if (!file.has_filename()) file = file.parent_path();
  return file.replace_extension(".map.csv").string();
}

/// Asks at a terminal for joints that are unknown, and writes the answer to `map`, or beside the
/// recording if it is empty. Returns the map; empty without an answer.
std::string AnsweredMap(const Inspection& inspection, const InspectionOptions& asked,
                        const std::string& map, const InspectOptions& options) {
  if (options.json || ColumnsToName(inspection).empty() || !CanAsk()) return "";
  std::string target = map.empty() ? MapBeside(options.file) : map;
  try {
    CheckTargets(target, options);
  } catch (const UserError& error) {  // the answer would be lost
    Say("{}, --map {} uses it\n", error.what(), ShellPath(target));
    return "";
  }
  const std::string answer = AskForMap(inspection, asked);
  if (answer.empty()) return "";
  WriteStarter(target, answer, options.force);
  return target;
}

void RunInspect(const InspectOptions& options) {
  if (IsHandFile(options.file)) {
    InspectHand(options.file, options.scenario, options.force);
    return;
  }
  std::string map = options.map;
  InspectionOptions asked = options.recording.Asked();
  const std::string& given_map = asked.map;
  if (map.empty() && given_map.empty() && !options.scenario.empty()) {
    map = fs::path(options.scenario).replace_extension(".map.csv").string();
  }
  Inspection inspection = Inspect(options.file, asked);
  CheckTargets(map, options);
  if (const std::string answered = AnsweredMap(inspection, asked, map, options);
      !answered.empty()) {
    asked.map = answered;
    map.clear();  // it is written
    inspection = Inspect(options.file, asked);
  }
  if (options.json) {
    PrintText(InspectionJson(inspection));
  } else {
    PrintInspection(inspection, options.verbose);
  }
  FlushOutput();
  if (!map.empty() && !inspection.Sensors().empty()) {
    WriteStarter(map, StarterMap(inspection), options.force);
  }
  if (!options.page.empty() && inspection.layout.columns > 0) {
    MakeDirectoryOf(options.page);
    WriteOutputFile(options.page, InspectionPage(inspection));
    Say("wrote {}\n", options.page);
  }
  CheckQuestion(inspection, map);
  if (options.scenario.empty() && !options.json) {
    Print("\nNext: {}\n", NextCommand(inspection, given_map, map));
  }
  if (!options.scenario.empty()) {
    WriteStarter(options.scenario,
                 StarterScenario(inspection, SeenFrom(options.scenario, options.file),
                                 SeenFrom(options.scenario, given_map.empty() ? map : given_map)),
                 options.force);
    if (!options.json) Print("\nNext: gauntlet compare {}\n", ShellPath(options.scenario));
  }
  if (!options.plot.empty()) {
    WritePng(DrawRecording(inspection), options.plot);
    Say("wrote {}\n", options.plot);
  }
}

}  // namespace

Command MakeInspectCommand() { return MakeCommand(RunInspect); }

}  // namespace gauntlet::sim
