#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <iterator>
#include <optional>
#include <utility>
#include <vector>

#include "controller/number.h"
#include "sim/base/channels.h"
#include "sim/base/csv_line.h"
#include "sim/base/error.h"
#include "sim/base/text.h"
#include "sim/tables/csv_reader.h"
#include "sim/tables/missing.h"
#include "sim/tables/name_words.h"
#include "sim/tables/opensim_files.h"
#include "sim/tables/time_columns.h"

namespace gauntlet::sim {
namespace {

constexpr std::string_view kEither = "angle";  // deg or rad

struct StorageHeader {
  int lines = 0;
  std::optional<std::int64_t> rows = {};
  std::string angle_unit = {};
  bool has_vectors = false;
};

StorageHeader HeaderOf(const std::string& name, std::string_view text) {
  StorageHeader header;
  std::string_view sentence_unit;
  for (const std::string_view line : SplitLines(text)) {
    ++header.lines;
    const std::string_view trimmed = Trimmed(line);
    const std::size_t end = std::min(trimmed.find_first_of(" \t="), trimmed.size());
    const std::string key = BareName(trimmed.substr(0, end));
    const std::size_t begin = std::min(trimmed.find_first_not_of(" \t=", end), trimmed.size());
    const std::string_view value = trimmed.substr(begin);
    const auto fail = [&](std::string_view allowed) {
      throw UserError({.place = fmt::format("{}:{}", name, header.lines),
                       .problem = fmt::format("{} is '{}', must be {}", trimmed.substr(0, end),
                                              Shown(value), allowed)});
    };
    if (key == "endheader") break;
    if (IsWordOf("nrows nr datarows", key)) {
      header.rows = controller::ParseWholeNumber(value, 0, std::int64_t{1} << 40);
      if (!header.rows) fail("a whole number");
    }
    if (key == "datatype") header.has_vectors = BareName(value) != "double";
    if (BareName(trimmed).starts_with("anglesareindegrees")) sentence_unit = "deg";
    if (BareName(trimmed).starts_with("anglesareinradians")) sentence_unit = "rad";
    if (key != "indegrees") continue;
    const std::string answer = BareName(value);
    if (!IsWordOf("yes no y n true false", answer)) fail("yes or no");
    header.angle_unit = IsWordOf("yes y true", answer) ? "deg" : "rad";
  }
  if (header.angle_unit.empty())
    header.angle_unit = sentence_unit.empty() ? kEither : sentence_unit;
  return header;
}

/// True for a name of a channel, or one of words of joints alone (FFJ3, index_mcp): an angle.
bool NamesJoint(const std::string& name) {
  const std::vector<std::string> words = WordsOf(name);
  const auto is_part = [](const std::string& word) {
    return !FingerOf(word).empty() || !ArmPartOf(word).empty();
  };
  return std::ranges::count(KnownChannelNames(), name) > 0 ||
         (std::ranges::any_of(words, is_part) &&
          std::ranges::all_of(words, [&](const std::string& word) {
            return is_part(word) || IsSpread(word) || !JointOf(word).empty() ||
                   !SideOf(word).empty() || controller::ParseNumber(word).has_value();
          }));
}

/// A column whose cells have commas as a column for each of their numbers.
std::vector<TableColumn> PartsOf(const TableColumn& column) {
  constexpr std::string_view kAxes = "wxyz";
  const std::size_t count = SplitCells(column.texts.front(), ',').size();
  std::vector<TableColumn> parts(count);
  for (std::size_t i = 0; i < count; ++i) {
    parts[i].name = count == 3 || count == 4
                        ? fmt::format("{}_{}", column.name, kAxes[i + (count == 3 ? 1 : 0)])
                        : fmt::format("{}_{}", column.name, i + 1);
  }
  for (const std::string& cell : column.texts) {
    const std::vector<std::string_view> numbers = SplitCells(cell, ',');
    for (std::size_t i = 0; i < count; ++i) {
      const auto number =
          numbers.size() == count ? NumberOrMissing(Trimmed(numbers[i])) : std::nullopt;
      parts[i].numbers.push_back(number.value_or(kMissing));
    }
  }
  return parts;
}

}  // namespace

bool IsStorage(std::string_view head) {
  const std::vector<std::string_view> lines = SplitLines(head);
  return std::ranges::any_of(
      lines, [](std::string_view line) { return BareName(Trimmed(line)) == "endheader"; });
}

Table TableOfStorage(const std::string& name, std::string_view text) {
  const StorageHeader header = HeaderOf(name, text);
  Table table = TableOfText({name, TextSource(text), ProblemHandling::kRepair, {}, header.lines},
                            header.rows, text.ends_with('\n'));
  table.angle_unit = header.angle_unit;
  for (TableColumn& column : table.columns) {
    if (header.angle_unit != kEither && NamesJoint(column.name)) {
      column.name += "_" + header.angle_unit;
    }
  }
  if (!header.has_vectors) return table;
  for (const TableColumn& column : std::exchange(table.columns, {})) {
    const bool is_vector =
        !column.texts.empty() && column.texts.front().find(',') != std::string::npos;
    std::ranges::move(is_vector ? PartsOf(column) : std::vector{column},
                      std::back_inserter(table.columns));
  }
  return table;
}

}  // namespace gauntlet::sim
