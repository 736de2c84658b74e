#include "sim/cli/recording_scenario.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <string_view>
#include <system_error>

#include "controller/number.h"
#include "sim/base/csv_line.h"
#include "sim/base/error.h"
#include "sim/base/output_file.h"
#include "sim/base/shell_word.h"
#include "sim/base/text.h"
#include "sim/cli/standard_streams.h"
#include "sim/recordings/inspect/starter_files.h"
#include "sim/tables/csv_reader.h"
#include "sim/tables/file_format.h"
#include "sim/tables/text_lines.h"
#include "sim/tables/time_columns.h"

namespace gauntlet::sim {
namespace {

namespace fs = std::filesystem;

/// The option that chooses the same array or topic again, with a blank before it.
std::string PartOption(const Inspection& inspection) {
  if (inspection.array.empty()) return "";
  return (inspection.topics.empty() ? " --array " : " --topic ") + ShellWord(inspection.array);
}

bool AnswersByMap(const Inspection& inspection) {
  return inspection.remedy == Remedy::kMap || inspection.remedy == Remedy::kPresetOrMap;
}

/// First and last column of `FIRST-LAST`.
std::pair<std::size_t, std::size_t> ColumnRange(const std::string& text) {
  const std::size_t dash = text.find('-');
  constexpr std::size_t kMost = 1000000;
  const auto first = controller::ParseWholeNumber(text.substr(0, dash), 1, kMost);
  const auto last = controller::ParseWholeNumber(
      text.substr(dash == std::string::npos ? text.size() : dash + 1), 1, kMost);
  if (!first || !last || *last < *first) {
    throw UserError(
        {.place = "--columns",
         .problem = fmt::format("'{}' must be FIRST-LAST, as 3-25", OneLine(text, 30))});
  }
  return {*first, *last};
}

}  // namespace

Options RecordingArguments::Rows() {
  return {
      Option("--rate", &inspection.rate_hz, {.value = "HZ", .range = {0.01, 100000.0}},
             "rows per second of a file without a time [50]"),
      ArrayOptions(inspection.array),
      UnitOption(inspection.joints.unit, {"deg", "rad", "counts", "share", "percent", "volts"},
                 "unit of the sensors [by the file]"),
      TimeUnitOption(inspection.time_unit),
      Option("--preset", &inspection.joints.preset, {.value = "NAME"},
             "profile of the device that wrote the file, as cyberglove22: gauntlet list profiles; "
             "or a column map with numbers of sensors [by the file]"),
      Option("--columns", &columns, {.value = "FIRST-LAST"},
             "the columns of the sensors, as 3-25 [found]"),
      Option("--hand", &inspection.joints.hand, {.choices = {"left", "right"}},
             "the hand to take from a file with both"),
  };
}

Options RecordingArguments::RowsBesideScenario() {
  return {Option("--map", &inspection.map, {.value = "MAP.csv", .offer = Offer::kFiles},
                 "column map, with a recording in place of the scenario; its scenario is written "
                 "as gauntlet inspect does"),
          Rows()};
}

InspectionOptions RecordingArguments::Asked() const {
  InspectionOptions asked = inspection;
  if (!columns.empty()) asked.columns = ColumnRange(columns);
  return asked;
}

std::string RecordingArguments::Given() const {
  const JointOptions& joints = inspection.joints;
  const std::pair<std::string_view, const std::string&> texts[] = {
      {"--map", inspection.map},   {"--topic", inspection.array},
      {"--unit", joints.unit},     {"--time-unit", inspection.time_unit},
      {"--preset", joints.preset}, {"--columns", columns},
      {"--hand", joints.hand}};
  for (const auto& [option, value] : texts) {
    if (!value.empty()) return fmt::format("{} {}", option, OneLine(value, 60));
  }
  return inspection.rate_hz > 0.0 ? fmt::format("--rate {:g}", inspection.rate_hz) : "";
}

std::string ScenarioOrOfRecording(const std::string& given, const RecordingArguments& recording,
                                  const fs::path& folder) {
  if (IsRecordingFile(given)) return ScenarioOfRecording(given, recording.Asked(), folder);
  if (const std::string option = recording.Given(); !option.empty()) {
    throw UserError({.place = option,
                     .problem = "needs a recording, not a scenario, which has it under "
                                "glove.motion"});
  }
  return given;
}

bool IsRecordingFile(const fs::path& file) {
  std::error_code missing;
  if (fs::is_directory(file, missing)) return !DataSetFiles(file).empty();
  if (!fs::is_regular_file(file, missing)) return false;
  const std::string ending = BareName(file.extension().string());
  if (IsWordOf("yaml yml", ending)) return false;
  if (IsWordOf("csv tsv txt dat json", ending)) return true;
  // Others by their text: a scenario begins with a key and one value, or nothing, behind it.
  constexpr std::size_t kHeadBytes = 4096;
  const std::string head = BytesOf(FileSource(file), kHeadBytes);
  if (FormatOfBytes(head) != FileFormat::kText) return true;
  for (const std::string_view line : SplitLines(head)) {
    if (Trimmed(line).empty() || line.front() == '#' || line == "---") continue;
    const std::string_view key = line.substr(0, line.find(':'));
    const std::string_view value = Trimmed(line.substr(std::min(key.size() + 1, line.size())));
    const bool is_quoted = value.starts_with('"') || value.starts_with('\'');
    return key.size() == line.size() || (value.find(':') != value.npos && !is_quoted) ||
           !std::ranges::all_of(key, [](unsigned char letter) {
             return std::isalnum(letter) != 0 || letter == '_';
           });
  }
  return true;
}

std::string SeenFrom(const fs::path& from, const fs::path& file) {
  // With links and `..` resolved: `a/../b` seen from elsewhere is another place.
  const fs::path folder = fs::weakly_canonical(fs::absolute(from).parent_path());
  return fs::weakly_canonical(fs::absolute(file)).lexically_proximate(folder).generic_string();
}

void WriteStarter(const std::string& target, const std::string& text, bool force) {
  MakeDirectoryOf(target);
  WriteEditableFile(target, text, force);
  Say("wrote {}\n", target);
}

void CheckQuestion(const Inspection& inspection, const std::string& map) {
  if (inspection.question.empty()) return;
  std::string way;
  const std::vector<std::string>& profiles = inspection.profiles_to_ask_for;
  const bool by_profile = inspection.remedy == Remedy::kPresetOrMap || !profiles.empty();
  if (inspection.remedy == Remedy::kIdentify) {
    const std::string log = ShellPath(inspection.file) + PartOption(inspection);
    way = fmt::format("; next: gauntlet audit {0}, then gauntlet identify {0}", log);
  } else if (AnswersByMap(inspection) || by_profile) {
    way = !profiles.empty()
              ? fmt::format("; --preset {} if it is one, or ", fmt::join(profiles, " or "))
          : by_profile && map.empty() && inspection.profile.empty()
              ? std::string("; --preset NAME, or ")
              : std::string("; ");
    way += map.empty() ? std::string("--write-map MAP.csv and fill it in")
                       : fmt::format("fill in {}, then --map {}", ShellPath(map), ShellPath(map));
  }
  throw UserError({.place = inspection.file, .problem = inspection.question + way});
}

std::string ScenarioOfRecording(const fs::path& recording, const InspectionOptions& options,
                                const fs::path& folder) {
  const std::string& map = options.map;
  const Inspection inspection = Inspect(recording, options);
  const fs::path scenario = folder / recording.stem().concat(".yaml");
  const fs::path starter = folder / recording.stem().concat(".map.csv");
  const bool is_assumed = inspection.HasAssumedJoint();
  if (!AnswersByMap(inspection)) CheckQuestion(inspection, map);
  if (map.empty() && (is_assumed || !inspection.question.empty())) {
    throw UserError(
        {.place = recording.string(),
         .problem = fmt::format(
             "{}; gauntlet inspect {}{} --write-map MAP.csv, check MAP.csv, then --map MAP.csv",
             !inspection.question.empty() ? inspection.question
             : inspection.profile.empty()
                 ? std::string("its joints are assumed by their names")
                 : fmt::format(
                       "its joints are assumed to be those of {0}; --preset {0} if they are",
                       inspection.profile),
             ShellPath(recording), PartOption(inspection))});
  }
  CheckQuestion(inspection, map);
  if (map.empty()) WriteStarter(starter.string(), StarterMap(inspection), false);
  WriteStarter(scenario.string(),
               StarterScenario(inspection, SeenFrom(scenario, recording),
                               SeenFrom(scenario, map.empty() ? starter : fs::path(map))),
               false);
  return scenario.string();
}

}  // namespace gauntlet::sim
