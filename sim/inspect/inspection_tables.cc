#include "sim/inspect/inspection_tables.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "sim/base/text.h"

namespace gauntlet::sim {

namespace {

ResultRow RowOf(const InspectedColumn& column, std::size_t number) {
  const auto text_if_any = [](const std::string& text) {
    return text.empty() ? ResultCell() : ResultCell(text);
  };
  const auto shown = [](double value, std::string text) {
    return ResultCell({value}, std::move(text));
  };
  const ColumnStatistics& is = column.statistics;
  const bool is_time = !column.time_unit.empty();
  ResultRow row = {ResultCell::Text(fmt::to_string(number)),
                   ResultCell::Text(OneLine(column.name, 20)),
                   ResultCell(OneLine(column.name)),
                   text_if_any(column.time_unit),
                   text_if_any(column.channel),
                   ResultCell::Text(is_time                  ? "time, " + column.time_unit
                                    : column.channel.empty() ? "-"
                                                             : column.channel)};
  if (column.kind == CellKind::kNumber && is.good_rows > 0) {
    row.insert(row.end(),
               {shown(is.low, fmt::format("{:.5g}", is.low)),
                shown(is.high, fmt::format("{:.5g}", is.high)),
                shown(is.step, fmt::format("{:.3g}", is.step)),
                shown(is.noise, fmt::format("{:.3g}", is.noise)),
                shown(is.still_share, fmt::format("{:.0f} %", 100.0 * is.still_share)),
                shown(is.clipped_share, fmt::format("{:.0f} %", 100.0 * is.clipped_share)),
                ResultCell(static_cast<std::int64_t>(is.longest_still_rows))});
  } else {
    row.resize(row.size() + 7);
  }
  row.push_back({{OneLine(column.why)}, is_time ? "" : OneLine(column.why)});
  return row;
}

}  // namespace

ResultTable ColumnsTable(const Inspection& inspection) {
  ResultTable table{.columns = {ForPeople("#"),
                                ForPeople("column"),
                                OnlyInJson("name"),
                                OnlyInJson("time_unit"),
                                OnlyInJson("channel"),
                                ForPeople("taken for").Words(),
                                {"low", "lowest"},
                                {"high", "highest"},
                                {"step", "step"},
                                {"noise", "noise"},
                                {"still_share", "still"},
                                {"clipped_share", "clipped"},
                                OnlyInJson("longest_still_rows"),
                                ResultColumn("why", "why").Words()},
                    .rows = {},
                    .names = 2};
  for (const InspectedColumn& column : inspection.columns) {
    table.rows.push_back(RowOf(column, table.rows.size() + 1));
  }
  return table;
}

std::string InspectionJson(const Inspection& inspection) {
  const TableLayout& layout = inspection.layout;
  ResultTable arrays{.columns = {OnlyInJson("name"), OnlyInJson("rows"), OnlyInJson("columns"),
                                 OnlyInJson("is_taken")}};
  for (const ListedArray& array : inspection.arrays) {
    arrays.rows.push_back(
        {ResultCell(array.name), ResultCell(static_cast<std::int64_t>(array.rows)),
         ResultCell(static_cast<std::int64_t>(array.columns)), ResultCell(array.is_taken)});
  }
  const nlohmann::ordered_json json = {{"file", OneLine(inspection.file)},
                                       {"format", NameOf(inspection.format)},
                                       {"arrays", JsonOf(arrays)},
                                       {"separator", SeparatorText(layout.separator)},
                                       {"decimal_comma", layout.decimal_comma},
                                       {"skipped_lines", layout.skipped_lines},
                                       {"rows", inspection.rows},
                                       {"is_whole", inspection.is_whole},
                                       {"has_time", inspection.has_time},
                                       {"rate_hz", inspection.time.rate_hz},
                                       {"rate_is_known", inspection.rate_is_known},
                                       {"duration_s", inspection.time.duration_s},
                                       {"gaps", inspection.time.gaps},
                                       {"restarts", inspection.time.restarts},
                                       {"unit", NameOf(inspection.unit)},
                                       {"bits", inspection.bits},
                                       {"repairs", inspection.problems},
                                       {"columns", JsonOf(ColumnsTable(inspection))}};
  return json.dump(2) + "\n";
}

std::string SeparatorText(char separator) {
  if (separator == '\t') return "tab";
  if (separator == ' ') return "blanks";
  return separator == ';' ? "semicolon" : "comma";
}

}  // namespace gauntlet::sim
