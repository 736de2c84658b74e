#include "sim/fit/chain_columns.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <string_view>

#include "sim/base/nearest_name.h"
#include "sim/base/signal.h"
#include "sim/base/text.h"
#include "sim/recordings/column_map.h"
#include "sim/recordings/time_guess.h"
#include "sim/tables/name_words.h"
#include "sim/tables/time_columns.h"

namespace gauntlet::sim {
namespace {

constexpr std::string_view kWearer = "true_angle_rad.";  // in the CSV of a trace
constexpr std::string_view kHand = "hand_angle_rad.";

constexpr std::string_view kCommandWords =
    "command commanded commands cmd ctrl target goal desired des setpoint set reference ref leader "
    "lead sent action actions demand soll";
constexpr std::string_view kAngleWords =
    "actual act measured meas feedback fb present observation observations observed obs state "
    "states encoder "
    "follower follow qpos read response ist";
constexpr std::string_view kPositionWords = "position positions pos angle";
constexpr std::string_view kOtherWords =
    "velocity vel speed current torque effort force load voltage pwm temperature temp acceleration "
    "acc accel power error err tension";
constexpr std::string_view kDegreeWords = "deg degree degrees";
constexpr std::string_view kRadianWords = "rad radian radians";

enum class ColumnRole { kCommand, kAngle, kBare, kOther };

struct ChainName {
  ColumnRole role = ColumnRole::kBare;
  std::string part;
  std::optional<double> scale;
  bool names_angle = false;
};

/// Words of a name: runs of letters and digits; a capital behind a small letter begins a word.
std::vector<std::string> RoleWordsOf(std::string_view name) {
  std::vector<std::string> words;
  bool inside = false;
  for (std::size_t i = 0; i < name.size(); ++i) {
    const auto letter = static_cast<unsigned char>(name[i]);
    const bool hump = inside && std::isupper(letter) != 0 &&
                      std::islower(static_cast<unsigned char>(name[i - 1])) != 0;
    const bool counts = std::isalnum(letter) != 0 || letter >= 0x80;
    if (counts && (!inside || hump)) words.emplace_back();
    if (counts) words.back() += name[i];
    inside = counts;
  }
  return words;
}

std::string Small(std::string word) {
  std::ranges::transform(word, word.begin(),
                         [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return word;
}

/// "des1" is "des" and "1".
void SplitNumbers(std::vector<std::string>& words) {
  for (std::size_t i = 0; i < words.size(); ++i) {
    const std::size_t digits = words[i].find_last_not_of("0123456789") + 1;
    if (digits == 0 || digits == words[i].size()) continue;
    const std::string word = Small(words[i].substr(0, digits));
    if (!IsWordOf(kCommandWords, word) && !IsWordOf(kAngleWords, word)) continue;
    words.insert(words.begin() + static_cast<std::ptrdiff_t>(i) + 1, words[i].substr(digits));
    words[i].resize(digits);
  }
}

/// The role of a column by the words of its name.
ChainName ReadWords(const std::string& name) {
  ChainName result;
  bool command = false;
  bool angle = false;
  bool other = false;
  std::vector<std::string> words = RoleWordsOf(name);
  SplitNumbers(words);
  for (std::size_t i = 0; i < words.size(); ++i) {
    const std::string word = Small(words[i]);
    const bool before_position =
        i + 1 < words.size() && IsWordOf(kPositionWords, Small(words[i + 1]));
    if (i + 1 == words.size() && IsWordOf(kDegreeWords, word)) {
      result.scale = 1.0;
    } else if (i + 1 == words.size() && IsWordOf(kRadianWords, word)) {
      result.scale = kDegPerRad;
    } else if (IsWordOf(kCommandWords, word)) {
      command = true;
    } else if (IsWordOf(kAngleWords, word) || (word == "current" && before_position)) {
      angle = true;
    } else if (IsWordOf(kPositionWords, word)) {
      angle = true;
      result.names_angle |= word == "angle";
    } else if (IsWordOf(kOtherWords, word)) {
      other = true;
    } else {
      result.part += (result.part.empty() ? "" : "_") + words[i];
    }
  }
  if (result.part.empty()) result.part = "joint";
  result.role = other                   ? ColumnRole::kOther
                : command               ? ColumnRole::kCommand
                : angle || result.scale ? ColumnRole::kAngle
                                        : ColumnRole::kBare;
  return result;
}

/// The role of a column. Names as in the documentation keep their part as it is written.
ChainName ReadName(const std::string& name) {
  for (const std::string_view before : {kWearer, kHand}) {
    if (!name.starts_with(before) || name.size() == before.size()) continue;
    return {before == kWearer ? ColumnRole::kCommand : ColumnRole::kAngle,
            name.substr(before.size()), kDegPerRad};
  }
  ChainName result = ReadWords(name);
  for (const std::string_view after : {"_command_deg", "_command_rad", "_deg", "_rad"}) {
    if (!name.ends_with(after) || name.size() == after.size()) continue;
    const std::string part = name.substr(0, name.size() - after.size());
    const ChainName rest = ReadWords(part);
    const bool plain = rest.role == ColumnRole::kBare && (rest.part != "joint" || part == "joint");
    if (plain || after.starts_with("_command")) result.part = part;
    if (plain || after.starts_with("_command")) break;
  }
  return result;
}

const PartColumn* FindPart(const std::vector<PartColumn>& columns, const std::string& part) {
  const auto found = std::ranges::find(columns, part, &PartColumn::part);
  return found == columns.end() ? nullptr : &*found;
}

void RejectRepeatedParts(const FoundTable& table, const std::vector<PartColumn>& columns,
                         const char* role) {
  const CsvReader& csv = table.reader;
  const std::vector<std::string>& names = table.layout.names;
  for (const PartColumn& column : columns) {
    const PartColumn* const first = FindPart(columns, column.part);
    if (first == &column) continue;
    csv.Fail(
        column.column + 1,
        fmt::format("{} and {} are both the {} of {}: remove one", csv.Quoted(names[first->column]),
                    csv.Quoted(names[column.column]), role, csv.Quoted(column.part)));
  }
}

/// Sorts the angles in the order of the commands. In a trace, a joint without a channel of its name
/// has no partner, and vice versa.
void PairParts(const FoundTable& table, const std::vector<PartColumn>& bare,
               ChainColumns& columns) {
  const CsvReader& csv = table.reader;
  RejectRepeatedParts(table, columns.commands, "command");
  RejectRepeatedParts(table, columns.angles, "angle");
  std::vector<PartColumn> commands;
  std::vector<PartColumn> angles;
  std::vector<const PartColumn*> alone;  // commands without an angle
  std::vector<std::string> names;
  for (const PartColumn& angle : columns.angles) names.push_back(angle.part);
  for (const PartColumn& command : columns.commands) {
    const PartColumn* angle = FindPart(columns.angles, command.part);
    if (angle == nullptr) angle = FindPart(bare, command.part);
    if (angle != nullptr) {
      commands.push_back(command);
      angles.push_back(*angle);
      const std::string motor_name = command.part + "_motor";
      const PartColumn* motor = FindPart(columns.angles, motor_name);
      // A part may have this name itself.
      if (motor != nullptr && FindPart(columns.commands, motor_name) == nullptr) {
        columns.motors.push_back({motor->column, command.part, motor->scale, motor->offset_deg});
      }
    } else if (!columns.is_trace) {
      alone.push_back(&command);
    }
  }
  // A data set may have commands that nothing measures, but not most of them.
  if (!alone.empty() && alone.size() >= commands.size()) {
    const PartColumn& command = *alone.front();
    csv.Fail(
        command.column + 1,
        fmt::format("{} has a command but no angle, add a column {}_deg{}, or pair the columns "
                    "by --map",
                    csv.Quoted(command.part), OneLine(command.part, 60),
                    Suggestion(command.part, names)));
  }
  if (commands.empty()) {
    csv.Fail(1,
             "there is no part with a command and an angle (columns as index_mcp_command_deg and "
             "index_mcp_deg)");
  }
  columns.commands = std::move(commands);
  columns.angles = std::move(angles);
}

/// A pair with one unit has that unit.
void ShareUnits(ChainColumns& columns) {
  for (std::size_t i = 0; i < columns.commands.size(); ++i) {
    std::optional<double>& command = columns.commands[i].scale;
    std::optional<double>& angle = columns.angles[i].scale;
    if (!command) command = angle;
    if (!angle) angle = command;
  }
}

void ListIgnored(const std::vector<std::string>& names, ChainColumns& columns) {
  if (columns.is_trace) return;  // its other signals
  std::vector<bool> used(names.size(), false);
  for (const TimeMapping& time : columns.time) used[time.column] = true;
  for (const EpisodeColumn& episode : columns.episodes) used[episode.column] = true;
  for (const auto* const list : {&columns.commands, &columns.angles, &columns.motors}) {
    for (const PartColumn& column : *list) used[column.column] = true;
  }
  for (std::size_t i = 0; i < used.size(); ++i) {
    if (!used[i] && !IsSampleNumber(names[i])) columns.ignored.push_back(names[i]);
  }
}

/// The columns of the parts by their names; those of `bare` have no word of a role.
void FindPartsByName(const TableLayout& layout, std::vector<PartColumn>& bare,
                     ChainColumns& columns) {
  const std::vector<std::string>& names = layout.names;
  for (std::size_t column = 0; column < names.size(); ++column) {
    const std::string& name = names[column];
    const bool is_time =
        TimeScaleS(name) ||
        std::ranges::find(columns.time, column, &TimeMapping::column) != columns.time.end();
    const bool is_episode = std::ranges::find(columns.episodes, column, &EpisodeColumn::column) !=
                            columns.episodes.end();
    if (is_time || is_episode || IsSampleNumber(name)) continue;
    if (KindOf(layout, column) == CellKind::kText) continue;
    const ChainName read = ReadName(name);
    columns.is_trace |= name.starts_with(kWearer);
    if (read.role == ColumnRole::kOther) continue;
    columns.names_angles |= read.names_angle && !read.scale;
    (read.role == ColumnRole::kCommand ? columns.commands
     : read.role == ColumnRole::kAngle ? columns.angles
                                       : bare)
        .push_back({column, read.part, read.scale});
  }
  if (columns.is_trace) {  // true_angle_rad.X has words of an angle, too
    std::erase_if(columns.angles,
                  [&](const PartColumn& angle) { return !names[angle.column].starts_with(kHand); });
  }
}

/// The columns of the parts by a column map.
void FindPartsByMap(const FoundTable& table, const std::string& map, ChainColumns& columns) {
  const LogMap roles = ReadLogMap(
      map,
      {.name = table.reader.name(), .header = table.layout.names, .count = table.layout.columns});
  if (!roles.time.empty()) columns.time = roles.time;
  for (const PartMapping& part : roles.parts) {
    const std::string name = part.part.empty() ? "joint" : part.part;
    if (part.role == "command") {
      columns.commands.push_back({part.column, name, part.scale, part.offset_deg});
    } else {
      columns.angles.push_back({part.column, part.role == "motor" ? name + "_motor" : name,
                                part.scale, part.offset_deg});
    }
  }
}

/// True for a column of texts or whole numbers that stay the same for many rows.
bool HoldsParts(const TableLayout& layout, std::size_t column) {
  constexpr double kOften = 0.1;  // of the rows: parts of fewer rows are no sessions
  double changes = 0.0;
  for (std::size_t row = 0; row < layout.rows.size(); ++row) {
    const std::string& cell = layout.rows[row][column];
    const double number = NumberIn(layout, cell);
    if (number != std::floor(number) && !std::isnan(number)) return false;
    changes += row > 0 && cell != layout.rows[row - 1][column] ? 1.0 : 0.0;
  }
  return changes <= kOften * static_cast<double>(layout.rows.size());
}

std::vector<EpisodeColumn> FindEpisodes(const TableLayout& layout) {
  std::vector<EpisodeColumn> parts;
  for (std::size_t column = 0; column < layout.names.size(); ++column) {
    const std::string& name = layout.names[column];
    const std::string bare_name = BareName(name);
    if (bare_name == "episode" || bare_name == "episodeindex") return {{column}};
    const bool is_part = NamesParts(name) && ReadName(name).role == ColumnRole::kBare;
    if (is_part && KindOf(layout, column) != CellKind::kTime && HoldsParts(layout, column)) {
      parts.push_back({column, KindOf(layout, column) == CellKind::kText});
    }
  }
  return parts;
}

}  // namespace

ChainColumns FindChainColumns(const FoundTable& table, const std::string& map, double rate_hz,
                              const std::string& time_unit) {
  const CsvReader& csv = table.reader;
  const std::vector<std::string>& names = table.layout.names;
  const bool has_names =
      std::ranges::any_of(names, [](const std::string& name) { return !name.empty(); });
  if (map.empty() && !has_names) csv.Fail(1, "the first line must name the columns, or --map");
  ChainColumns columns;
  if (rate_hz == 0.0) columns.time = TimeByName(csv.name(), table.layout, time_unit);
  columns.episodes = FindEpisodes(table.layout);
  std::vector<PartColumn> bare;
  if (map.empty()) {
    FindPartsByName(table.layout, bare, columns);
  } else {
    FindPartsByMap(table, map, columns);
  }
  if (rate_hz > 0.0) {
    columns.time.clear();
  } else if (columns.time.empty()) {
    csv.Fail(1, "there is no column of time (as t_s or time_ms); --rate HZ for even rows");
  }
  PairParts(table, bare, columns);
  ShareUnits(columns);
  ListIgnored(names, columns);
  return columns;
}

}  // namespace gauntlet::sim
