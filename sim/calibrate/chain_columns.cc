#include "sim/calibrate/chain_columns.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <string_view>

#include "sim/base/nearest_name.h"
#include "sim/base/signal.h"
#include "sim/base/text.h"
#include "sim/recordings/time_columns.h"

namespace gauntlet::sim {
namespace {

constexpr std::string_view kWearer = "true_angle_rad.";  // in the CSV of a trace
constexpr std::string_view kHand = "hand_angle_rad.";

constexpr std::string_view kCommandWords =
    "command commanded cmd target goal desired des setpoint action demand";
constexpr std::string_view kAngleWords =
    "actual act measured meas feedback fb present observation observed obs state encoder response";
constexpr std::string_view kPositionWords = "position pos angle";
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
std::vector<std::string> WordsOf(std::string_view name) {
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

/// The role of a column by the words of its name.
ChainName ReadWords(const std::string& name) {
  ChainName result;
  bool command = false;
  bool angle = false;
  bool other = false;
  const std::vector<std::string> words = WordsOf(name);
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

void RejectRepeatedParts(const CsvReader& csv, const std::vector<PartColumn>& columns,
                         const char* role) {
  for (const PartColumn& column : columns) {
    const PartColumn* const first = FindPart(columns, column.part);
    if (first == &column) continue;
    csv.Fail(column.column + 1,
             fmt::format("{} and {} are both the {} of {}: remove one",
                         csv.Quoted(csv.header()[first->column]),
                         csv.Quoted(csv.header()[column.column]), role, csv.Quoted(column.part)));
  }
}

/// Sorts the angles in the order of the commands. In a trace, a joint without a channel of its name
/// has no partner, and vice versa.
void PairParts(const CsvReader& csv, const std::vector<PartColumn>& bare, ChainColumns& columns) {
  RejectRepeatedParts(csv, columns.commands, "command");
  RejectRepeatedParts(csv, columns.angles, "angle");
  std::vector<PartColumn> commands;
  std::vector<PartColumn> angles;
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
        columns.motors.push_back({motor->column, command.part, motor->scale});
      }
    } else if (!columns.is_trace) {
      csv.Fail(command.column + 1,
               fmt::format("{} has a command but no angle, add a column {}_deg{}",
                           csv.Quoted(command.part), OneLine(command.part, 60),
                           Suggestion(command.part, names)));
    }
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

void ListIgnored(const CsvReader& csv, ChainColumns& columns) {
  if (columns.is_trace) return;  // its other signals
  std::vector<bool> used(csv.column_count(), false);
  used[columns.time] = true;
  if (columns.episode) used[*columns.episode] = true;
  for (const auto* const list : {&columns.commands, &columns.angles, &columns.motors}) {
    for (const PartColumn& column : *list) used[column.column] = true;
  }
  for (std::size_t i = 0; i < used.size(); ++i) {
    if (!used[i] && !IsSampleNumber(csv.header()[i])) columns.ignored.push_back(csv.header()[i]);
  }
}

}  // namespace

ChainColumns FindChainColumns(const CsvReader& csv) {
  if (csv.header().empty()) csv.Fail(1, "the first line must name the columns");
  ChainColumns columns;
  std::optional<std::size_t> time;
  std::vector<PartColumn> bare;
  for (std::size_t column = 0; column < csv.column_count(); ++column) {
    const std::string& name = csv.header()[column];
    const std::string bare_name = BareName(name);
    if (const auto scale_s = TimeScaleS(name)) {
      time = column;
      columns.time_scale_s = *scale_s;
      continue;
    }
    if (bare_name == "episode" || bare_name == "episodeindex") columns.episode = column;
    if (columns.episode == column || IsSampleNumber(name)) continue;
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
    std::erase_if(columns.angles, [&](const PartColumn& angle) {
      return !csv.header()[angle.column].starts_with(kHand);
    });
  }
  if (!time) csv.Fail(1, "there is no column of time (as t_s or time_ms)");
  columns.time = *time;
  PairParts(csv, bare, columns);
  ShareUnits(columns);
  ListIgnored(csv, columns);
  return columns;
}

}  // namespace gauntlet::sim
