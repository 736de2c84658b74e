#include "sim/cli/recording_scenario.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <string_view>
#include <system_error>

#include "sim/base/csv_line.h"
#include "sim/base/error.h"
#include "sim/base/output_file.h"
#include "sim/base/shell_word.h"
#include "sim/cli/standard_streams.h"
#include "sim/recordings/inspect/starter_files.h"
#include "sim/tables/csv_reader.h"
#include "sim/tables/file_format.h"
#include "sim/tables/source_bytes.h"
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

}  // namespace

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
    way = fmt::format("; next: gauntlet identify {}{}", ShellPath(inspection.file),
                      PartOption(inspection));
  } else if (AnswersByMap(inspection) || by_profile) {
    way = !profiles.empty()
              ? fmt::format("; --preset {} if it is one, or ", fmt::join(profiles, " or "))
          : by_profile ? std::string(map.empty() ? "; --preset NAME, or " : "; ")
                       : std::string("; ");
    way += map.empty() ? std::string("--write-map MAP.csv and fill it in")
                       : fmt::format("fill in {}, then --map {}", ShellPath(map), ShellPath(map));
  }
  throw UserError({.place = inspection.file, .problem = inspection.question + way});
}

std::string ScenarioOfRecording(const fs::path& recording, const std::string& map,
                                const std::string& array, const fs::path& folder) {
  InspectionOptions options;
  options.array = array;
  options.map = map;
  const Inspection inspection = Inspect(recording, options);
  const fs::path scenario = folder / recording.stem().concat(".yaml");
  const fs::path starter = folder / recording.stem().concat(".map.csv");
  const bool is_assumed = std::ranges::any_of(inspection.MappedColumns(), [&](std::size_t c) {
    return inspection.columns[c].basis == JointBasis::kAssumed;
  });
  if (!AnswersByMap(inspection)) CheckQuestion(inspection, map);
  if (map.empty() && (is_assumed || !inspection.question.empty())) {
    throw UserError(
        {.place = recording.string(),
         .problem = fmt::format(
             "{}; gauntlet inspect {}{} --write-map MAP.csv, check MAP.csv, then --map MAP.csv",
             inspection.question.empty() ? "its joints are assumed by their order"
                                         : inspection.question,
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
