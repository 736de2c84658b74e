#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>
#include <functional>
#include <span>

#include "sim/base/channels.h"
#include "sim/base/data_folder.h"
#include "sim/base/error.h"
#include "sim/base/json.h"
#include "sim/base/nearest_name.h"
#include "sim/base/output_file.h"
#include "sim/cli/commands.h"
#include "sim/cli/shared_options.h"
#include "sim/cli/standard_streams.h"
#include "sim/hand/hand_model.h"
#include "sim/recordings/profile.h"
#include "sim/results/runs.h"
#include "sim/score/score.h"
#include "sim/settings/setting_rows.h"
#include "sim/show/pages/pages.h"
#include "sim/study/scenario/scenario.h"
#include "sim/study/scenario/scenario_reader.h"
#include "sim/trial/link/link_config.h"
#include "sim/trial/link/presets.h"

namespace gauntlet::sim {
namespace {

struct Entry;

struct Subject {
  std::string name;
  std::string summary;
  std::function<std::vector<Entry>()> entries;
};

const std::vector<Subject>& Subjects();

struct ListOptions {
  static constexpr auto kName = "list";
  static constexpr auto kPurpose = "List filters, metrics, keys, scenarios and more";
  static constexpr auto kGroup = Group::kOther;
  std::string what;  // empty: the lists themselves
  std::string page;
  bool json = false;

  Options Rows() {
    return {
        Option("what", &what, {.words = AllNames(Subjects())},
               "one of the lists; all are named if left out"),
        OutOption(page, "write a page of the runs, with a picture of each", "PAGE.html"),
        Option("--json", &json, {}, "print JSON"),
    };
  }

  static constexpr auto kNotes = R"(
Examples:
  gauntlet list filters
  gauntlet list runs --out out/runs.html
)";
};

/// One thing of a list: its name, a sentence, its settings, what else is known of it as JSON, and
/// the same as sentences.
struct Entry {
  std::string name;
  std::string summary;
  std::vector<SettingRow> settings;
  Json facts = Json::object();
  std::vector<std::string> details = {};
};

/// The kinds of one thing; the first setting of a kind is its name.
template <class Kinds>
std::vector<Entry> EntriesOf(const Kinds& kinds) {
  std::vector<Entry> entries;
  for (const auto& kind : kinds) {
    auto config = kind.defaults;
    std::vector<SettingRow> rows =
        ListSettings([&](controller::SettingsVisitor& visitor) { config.Visit(visitor); });
    std::erase_if(rows, [](const SettingRow& row) { return row.key == "kind"; });
    entries.push_back({std::string(kind.name), std::string(kind.summary), std::move(rows)});
  }
  return entries;
}

/// `channels` is a key of every filter, which the documentation describes once.
std::vector<Entry> FilterEntries() {
  std::vector<Entry> entries = EntriesOf(controller::AllFilterKinds());
  for (Entry& entry : entries) {
    std::erase_if(entry.settings, [](const SettingRow& row) { return row.key == "channels"; });
  }
  return entries;
}

/// Presets of a link, then the kinds of its parts.
std::vector<Entry> LinkEntries() {
  std::vector<Entry> entries;
  for (const LinkPreset& preset : LinkPresets()) {
    Entry& entry = entries.emplace_back();
    entry.name = fmt::format("preset: {}", preset.name);
    entry.summary = preset.summary;
    if (!preset.source.empty()) {
      entry.facts["source"] = preset.source;
      entry.details.push_back(fmt::format("source: {}", preset.source));
    }
  }
  const auto add = [&entries](const std::string& part, std::vector<Entry> kinds) {
    for (Entry& kind : kinds) {
      kind.name = fmt::format("{}: {}", part, kind.name);
      entries.push_back(std::move(kind));
    }
  };
  add("delay", EntriesOf(controller::AllKinds<DelayConfig>()));
  add("loss", EntriesOf(controller::AllKinds<LossConfig>()));
  add("receiver", EntriesOf(controller::AllKinds<ReceiverConfig>()));
  add("receiver.gap", EntriesOf(controller::AllKinds<GapConfig>()));
  add("watchdog", EntriesOf(controller::AllKinds<WatchdogConfig>()));
  return entries;
}

/// "smallest relevant difference: 0.5 or 10 % of the smaller value (why)"
std::string RelevantDifferenceText(const RelevantDifference& least) {
  std::vector<std::string> limits;
  if (least.absolute > 0.0) limits.push_back(fmt::format("{:g}", least.absolute));
  if (least.relative > 0.0) {
    limits.push_back(fmt::format("{:g} % of the smaller value", 100.0 * least.relative));
  }
  return fmt::format("smallest relevant difference: {} ({})", fmt::join(limits, " or "),
                     least.reason);
}

std::vector<Entry> MetricEntries() {
  std::vector<Entry> entries;
  for (const Metric& metric : Metrics()) {
    const RelevantDifference& least = metric.relevant_difference;
    entries.push_back(
        {.name = std::string(metric.key),
         .summary = std::string(metric.help),
         .settings = {},
         .facts = {{"definition", metric.definition},
                   {"relevant_difference",
                    {{"absolute", least.absolute},
                     {"relative", least.relative},
                     {"reason", least.reason}}}},
         .details = {fmt::format("= {}", metric.definition), RelevantDifferenceText(least)}});
  }
  return entries;
}

/// Which joints turn the spool of the motor that is called like the channel, as "spool turns: 1.2
/// index_mcp + .."; empty if there is no such motor.
std::string SpoolTurns(const controller::TendonTransmission& hand, std::string_view channel) {
  const auto motor = std::ranges::find(hand.motor_names, channel);
  if (motor == hand.motor_names.end()) return "";
  const std::size_t joints = hand.joint_names.size();
  const auto row =
      std::span(hand.coupling)
          .subspan(static_cast<std::size_t>(motor - hand.motor_names.begin()) * joints, joints);
  std::vector<std::string> turns;
  for (std::size_t j = 0; j < joints; ++j) {
    if (std::abs(row[j]) > 1e-6) {
      turns.push_back(fmt::format("{:.3f} {}", row[j], hand.joint_names[j]));
    }
  }
  return fmt::format("spool turns: {}", fmt::join(turns, " + "));
}

std::vector<Entry> Channels() {
  const HandModel hand{HandConfig{}};
  std::vector<Entry> entries;
  for (const Channel& channel : KnownChannels()) {
    Entry& entry = entries.emplace_back();
    entry.name = channel.name;
    entry.summary = fmt::format("{} to {} deg, {}", channel.min_deg, channel.max_deg, channel.help);
    const std::string turns = SpoolTurns(hand.transmission(), channel.name);
    if (!turns.empty()) entry.details.push_back(turns);
  }
  return entries;
}

/// From the working folder if the file lies below it, else from the root.
std::filesystem::path ShortestPath(const std::filesystem::path& file) {
  const std::filesystem::path relative = std::filesystem::proximate(file);
  return relative.native().starts_with("..") ? file : relative;
}

std::vector<Entry> Scenarios() {
  std::vector<std::filesystem::path> files;
  for (const auto& file : std::filesystem::directory_iterator(DataFolder("scenarios"))) {
    if (file.path().extension() == ".yaml") files.push_back(ShortestPath(file.path()));
  }
  std::sort(files.begin(), files.end());
  std::vector<Entry> entries;
  for (const auto& file : files) {
    entries.push_back({file.string(), LoadScenario(file, {}).question, {}});
  }
  return entries;
}

std::vector<Entry> ScenarioKeys() {
  Scenario scenario;
  return {{"scenario", "The keys of a scenario file; lists above tell those of each kind.",
           ListSettings([&](controller::SettingsVisitor& visitor) { scenario.Visit(visitor); })},
          {"controllers.<name>", "The keys of one controller.",
           ListSettings([](controller::SettingsVisitor& visitor) {
             NamedController named;
             named.Visit(visitor);
           })},
          {"joint_map.<joint>", "The keys of one joint of the hand.",
           ListSettings([](controller::SettingsVisitor& visitor) {
             controller::JointSource source;
             source.Visit(visitor);
           })}};
}

/// "names of columns, 22 columns, whole numbers, 0 to 255, text"
std::string FactsText(const ProfileMatch& match) {
  std::vector<std::string> facts;
  if (!match.names.empty()) {
    constexpr std::size_t kShown = 3;
    facts.push_back(fmt::format(
        "columns {}{}",
        fmt::join(std::span(match.names).first(std::min(kShown, match.names.size())), ", "),
        match.names.size() > kShown ? " .." : ""));
  }
  const auto range = [](const std::vector<double>& values) {
    return values.front() == values.back()
               ? fmt::format("{:g}", values.front())
               : fmt::format("{:g} to {:g}", values.front(), values.back());
  };
  if (!match.columns.empty()) facts.push_back(range(match.columns) + " columns");
  if (match.whole) facts.emplace_back("whole numbers");
  if (!match.values.empty()) facts.push_back("values " + range(match.values));
  if (!match.format.empty()) facts.push_back(fmt::format("{}", fmt::join(match.format, " or ")));
  return fmt::format("{}", fmt::join(facts, ", "));
}

std::vector<Entry> Profiles() {
  std::vector<Entry> entries;
  for (const Profile& profile : AllProfiles({})) {
    Entry& entry = entries.emplace_back();
    entry.name = profile.name;
    entry.summary = profile.device;
    entry.facts["known_by"] = FactsText(profile.match);
    entry.facts["source"] = profile.source;
    entry.details = {"known by: " + FactsText(profile.match),
                     fmt::format("source: {}", fmt::join(profile.source, ", "))};
  }
  return entries;
}

std::vector<Entry> RunEntries() {
  std::vector<Entry> entries;
  for (const Run& run : FindRuns("out")) {
    Entry& entry = entries.emplace_back();
    entry.name = run.folder.string();
    const std::vector<std::string> lines = LinesOf(run);
    entry.summary = lines.front();
    entry.details.assign(lines.begin() + 1, lines.end());
    entry.facts = {{"choices", run.choices},
                   {"answer", run.answer},
                   {"written", run.written},
                   {"bytes", run.bytes}};
  }
  return entries;
}

const std::vector<Subject>& Subjects() {
  static const std::vector<Subject> kSubjects = {
      {"filters", "what a controller can do with the noise", FilterEntries},
      {"predictions", "how a controller can look ahead",
       [] { return EntriesOf(controller::PredictionKinds()); }},
      {"motions", "what the wearer can do", [] { return EntriesOf(MotionKinds()); }},
      {"faults", "what can go wrong in the glove", [] { return EntriesOf(FaultKinds()); }},
      {"links", "what can happen between glove, computer and hand", LinkEntries},
      {"servos", "what can turn the hand's spools", [] { return EntriesOf(ServoKinds()); }},
      {"metrics", "what is measured", MetricEntries},
      {"channels", "joints of wearer and hand, and how cables couple them", Channels},
      {"profiles", "devices and programs whose files are known", Profiles},
      {"scenarios", "ready questions", Scenarios},
      {"keys", "every key of a scenario file", ScenarioKeys},
      {"runs", "output folders below out, the newest first, with their answers", RunEntries},
  };
  return kSubjects;
}

void PrintSubject(const Subject& subject) {
  for (const Entry& entry : subject.entries()) {
    Print("{}\n", entry.name);
    PrintIndented(entry.summary);
    for (const std::string& detail : entry.details) PrintIndented(detail);
    std::size_t width = 0;
    for (const SettingRow& row : entry.settings) width = std::max(width, row.key.size());
    for (const SettingRow& row : entry.settings) {
      const std::string value = row.required                ? "required"
                                : row.default_value.empty() ? "empty"
                                                            : row.default_value;
      const std::string range = row.range.empty() ? "" : fmt::format(" ({})", row.range);
      PrintIndented(fmt::format("{:<{}}  {}; {}{}", row.key, width, value, row.help, range));
    }
  }
}

Json JsonOf(const Subject& subject) {
  Json json = Json::array();
  for (const Entry& entry : subject.entries()) {
    Json settings = Json::array();
    for (const SettingRow& row : entry.settings) {
      settings.push_back({{"key", row.key},
                          {"default", row.default_value},
                          {"required", row.required},
                          {"range", row.range},
                          {"help", row.help}});
    }
    json.push_back({{"name", entry.name}, {"summary", entry.summary}, {"settings", settings}});
    json.back().update(entry.facts);
  }
  return json;
}

/// Errors: UserError, before anything is written.
void WritePageOf(const ListOptions& options) {
  const std::filesystem::path page = options.page;
  if (options.what != "runs" || page.extension() != ".html") {
    throw UserError({.place = "--out " + options.page,
                     .problem = options.what != "runs" ? "only list runs writes a page"
                                                       : "a page must end in .html"});
  }
  WriteRunsPage(FindRuns("out"), page);
}

void List(const ListOptions& options) {
  if (!options.page.empty()) WritePageOf(options);
  if (options.what.empty()) {
    if (options.json) {
      Json all;
      for (const Subject& subject : Subjects()) all[subject.name] = JsonOf(subject);
      Print("{}\n", all.dump(2));
      return;
    }
    for (const Subject& subject : Subjects()) {
      Print("gauntlet list {:<11} {}\n", subject.name, subject.summary);
    }
    return;
  }
  const Subject* subject = FindNamed(Subjects(), options.what);
  if (subject == nullptr) {
    throw UserError({.place = "list " + options.what,
                     .problem = "unknown list" + Suggestion(options.what, AllNames(Subjects()))});
  }
  if (options.json) {
    Print("{}\n", JsonOf(*subject).dump(2));
  } else {
    PrintSubject(*subject);
  }
  FlushOutput();
  if (!options.page.empty()) Say("wrote {}\n", options.page);
}

}  // namespace

Command MakeListCommand() { return MakeCommand(List); }

}  // namespace gauntlet::sim
