#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "controller/number.h"
#include "sim/base/csv_line.h"
#include "sim/base/error.h"
#include "sim/base/text.h"
#include "sim/tables/csv_reader.h"
#include "sim/tables/opensim_files.h"
#include "sim/tables/text_lines.h"
#include "sim/tables/time_columns.h"

namespace gauntlet::sim {
namespace {

/// The cells that are not empty.
std::vector<std::string_view> FilledCells(std::string_view line) {
  std::vector<std::string_view> cells = SplitCells(line, '\t');
  for (std::string_view& cell : cells) cell = Trimmed(cell);
  std::erase(cells, "");
  return cells;
}

bool NamesMarkers(std::string_view line) {
  const std::vector<std::string_view> cells = FilledCells(line);
  return cells.size() > 2 && BareName(cells[0]) == "frame" && BareName(cells[1]) == "time";
}

/// The value in the line below the key; empty if there is none.
std::string_view FactOf(const std::vector<std::string_view>& lines, std::string_view key) {
  for (std::size_t i = 0; i + 1 < lines.size(); ++i) {
    const std::vector<std::string_view> keys = FilledCells(lines[i]);
    const std::vector<std::string_view> values = FilledCells(lines[i + 1]);
    const auto place = static_cast<std::size_t>(std::ranges::find(keys, key) - keys.begin());
    if (place < keys.size() && keys.size() == values.size()) return values[place];
  }
  return "";
}

}  // namespace

bool IsTrc(std::string_view head) {
  return WithoutByteOrderMark(head).starts_with("PathFileType") &&
         std::ranges::any_of(SplitLines(head), NamesMarkers);
}

TrcHeader ReadTrcHeader(const std::string& name, std::string_view text) {
  std::vector<std::string_view> lines = SplitLines(text);
  const auto names = std::ranges::find_if(lines, NamesMarkers);
  const std::vector<std::string_view> cells = FilledCells(*names);
  const std::string_view components = names + 1 < lines.end() ? names[1] : "";
  TrcHeader header{.markers = {cells.begin() + 2, cells.end()}};
  const auto line = static_cast<std::size_t>(names - lines.begin()) + 1;
  if (FilledCells(components).size() != 3 * header.markers.size()) {
    throw UserError(
        {.place = fmt::format("{}:{}", name, line),
         .problem = fmt::format("has {} names of markers above {} components, must have 3 for each",
                                header.markers.size(), FilledCells(components).size())});
  }
  header.bytes = static_cast<std::size_t>(components.data() + components.size() - text.data());
  lines.erase(names, lines.end());
  header.unit = FactOf(lines, "Units");
  header.rows = controller::ParseWholeNumber(FactOf(lines, "NumFrames"), 0, std::int64_t{1} << 40);
  header.names = std::string(line, '\n') + fmt::format("{}\t{}", cells[0], cells[1]);
  const std::string unit = IsWordOf("m cm mm", header.unit) ? "_" + header.unit : "";
  for (const std::string& marker : header.markers) {
    for (const char axis : {'x', 'y', 'z'}) {
      header.names += fmt::format("\t{}_{}{}", marker, axis, unit);
    }
  }
  return header;
}

Table TableOfTrc(const std::string& name, std::string_view text) {
  const TrcHeader header = ReadTrcHeader(name, text);
  Table table = TableOfText({name, WithHead(header.names, TextSource(text.substr(header.bytes))),
                             ProblemHandling::kRepair},
                            header.rows, text.ends_with('\n'));
  table.remarks.push_back(fmt::format("{} markers [{}]: {}", header.markers.size(),
                                      header.unit.empty() ? "unknown unit" : Shown(header.unit),
                                      fmt::join(header.markers, ", ")));
  return table;
}

}  // namespace gauntlet::sim
