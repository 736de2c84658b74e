#include "sim/recordings/inspect/inspection_tables.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>
#include <utility>

#include "sim/base/json.h"
#include "sim/base/text.h"
#include "sim/recordings/inspect/health.h"
#include "sim/results/table_text.h"

namespace gauntlet::sim {

namespace {

bool IsMapped(const InspectedColumn& column) { return !column.channel.empty() && !column.is_dead; }

std::string_view NameOf(JointBasis basis) {
  constexpr std::array<std::string_view, 4> kNames = {"name", "profile", "map", "assumed"};
  return kNames[static_cast<std::size_t>(basis)];
}

/// The joint, or the quantity of a column without one.
std::string MeaningOf(const InspectedColumn& column) {
  if (column.is_time) return "time, " + (column.time_unit.empty() ? "not used" : column.time_unit);
  if (column.is_dead) return "dead" + (column.channel.empty() ? "" : " (" + column.channel + ")");
  if (IsMapped(column)) {
    return column.channel + (column.basis == JointBasis::kAssumed ? " (assumed)" : "");
  }
  return column.is_sensor ? "no joint" : std::string(NameOf(column.quantity));
}

ResultRow RowOf(const InspectedColumn& column, std::size_t number) {
  const auto shown = [](double value, std::string text) {
    return ResultCell({value}, std::move(text));
  };
  const ColumnStatistics& is = column.statistics;
  const bool is_time = column.is_time;
  ResultRow row = {ResultCell::Text(fmt::to_string(number)),
                   ResultCell::Text(OneLine(column.name, 20)),
                   ResultCell(OneLine(column.name)),
                   ResultCell::IfAny(column.time_unit),
                   ResultCell::IfAny(IsMapped(column) ? column.channel : ""),
                   ResultCell::Text(MeaningOf(column))};
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
  row.emplace_back(std::string(NameOf(column.quantity)));
  row.push_back(column.is_dead ? ResultCell(true) : ResultCell());
  row.push_back(IsMapped(column) ? ResultCell(std::string(NameOf(column.basis))) : ResultCell());
  return row;
}

}  // namespace

std::string BasisText(const Inspection& inspection) {
  std::string text;
  constexpr std::pair<JointBasis, std::string_view> kTexts[] = {
      {JointBasis::kName, "by name"},
      {JointBasis::kProfile, "by profile"},
      {JointBasis::kMap, "by map"},
      {JointBasis::kAssumed, "assumed"}};
  for (const auto& [basis, name] : kTexts) {
    std::size_t joints = 0;
    for (const std::size_t c : inspection.MappedColumns()) {
      joints += inspection.columns[c].basis == basis ? 1 : 0;
    }
    if (joints == 0) continue;
    text += fmt::format("{}{} {}", text.empty() ? "" : ", ", joints, name);
  }
  if (!inspection.profile.empty()) text += ", " + inspection.profile;
  return text.empty() ? "none" : text;
}

std::string SummaryOf(const Inspection& inspection) {
  const std::vector<std::size_t> sensors = inspection.Sensors();
  std::string text =
      sensors.empty() ? "no sensor of a hand" : Counted(std::ssize(sensors), "sensor");
  text += fmt::format(", {:.4g} Hz{}", inspection.time.rate_hz,
                      inspection.rate_is_assumed ? " (assumed)" : "");
  if (sensors.empty()) return text;
  text += fmt::format(", {}{}", NameOf(inspection.unit),
                      inspection.unit_is_assumed ? " (assumed)" : "");
  const auto named = [&](const char* key) {
    std::string names;
    std::size_t count = 0;
    for (const HealthFinding& finding : HealthOf(inspection)) {
      if (finding.key != key) continue;
      const InspectedColumn& column = inspection.columns[finding.column];
      const std::string name = column.channel.empty() ? OneLine(column.name, 20) : column.channel;
      names += (names.empty() ? "" : ", ") +
               (name.empty() ? fmt::format("column {}", finding.column + 1) : name);
      ++count;
    }
    return std::pair(count, names);
  };
  const auto [dead, dead_names] = named("dead");
  if (dead > 0) text += fmt::format(": {} dead ({})", dead, dead_names);
  if (const auto [still, names] = named("no_movement"); still > 0) {
    text += fmt::format("{} {} {} not move ({})", dead > 0 ? "," : ":", still,
                        still == 1 ? "does" : "do", names);
  }
  return text;
}

/// Name of a column as a person finds it: its own, else its number.
std::string ShownName(const Inspection& inspection, std::size_t column) {
  const std::string name = OneLine(inspection.columns[column].name, 20);
  return name.empty() ? fmt::format("column {}", column + 1) : name;
}

std::string HealthText(const Inspection& inspection) {
  const std::vector<HealthFinding> findings = HealthOf(inspection);
  std::size_t width = 0;
  for (const HealthFinding& finding : findings) {
    width = std::max(width, ShownName(inspection, finding.column).size());
  }
  std::string text;
  for (const HealthFinding& finding : findings) {
    text +=
        fmt::format("{:<{}}  {}\n", ShownName(inspection, finding.column), width, finding.sentence);
  }
  return text;
}

std::string NoiseText(const Inspection& inspection) {
  double least_deg = std::numeric_limits<double>::infinity(), most_deg = 0.0;
  double least = least_deg, most = 0.0;
  for (const std::size_t c : inspection.MappedColumns()) {
    const InspectedColumn& column = inspection.columns[c];
    const double noise_deg = column.statistics.noise * DegPerUnitOf(inspection, column);
    least = std::min(least, column.statistics.noise);
    most = std::max(most, column.statistics.noise);
    least_deg = std::min(least_deg, noise_deg);
    most_deg = std::max(most_deg, noise_deg);
  }
  if (most == 0.0) return "";
  const auto range = [](double low, double high) {
    const std::string from = fmt::format("{:.2g}", low), to = fmt::format("{:.2g}", high);
    return from == to ? to : from + " to " + to;
  };
  std::string text = fmt::format("noise {} {}", range(least, most), NameOf(inspection.unit));
  if (inspection.unit != RawUnit::kDegrees) {
    text += fmt::format(", {} deg of the joints", range(least_deg, most_deg));
  }
  return text;
}

ResultTable ColumnsTable(const Inspection& inspection, bool is_verbose) {
  const auto if_verbose = [is_verbose](const char* key, const char* heading) {
    return is_verbose ? ResultColumn(key, heading) : OnlyInJson(key);
  };
  ResultTable table{.columns = {ForPeople("#"),
                                ForPeople("column"),
                                OnlyInJson("name"),
                                OnlyInJson("time_unit"),
                                OnlyInJson("channel"),
                                ForPeople("joint or quantity").Words(),
                                {"low", "lowest"},
                                {"high", "highest"},
                                if_verbose("step", "step"),
                                {"noise", "noise"},
                                if_verbose("still_share", "still"),
                                if_verbose("clipped_share", "clipped"),
                                OnlyInJson("longest_still_rows"),
                                if_verbose("why", "reason").Words(),
                                OnlyInJson("quantity"),
                                OnlyInJson("is_dead"),
                                OnlyInJson("joint_by")},
                    .rows = {},
                    .names = 2};
  for (const InspectedColumn& column : inspection.columns) {
    table.rows.push_back(RowOf(column, table.rows.size() + 1));
  }
  return table;
}

ResultTable TopicsTable(const std::vector<ListedTopic>& topics) {
  ResultTable table{.columns = {{"name", "topic"},
                                ResultColumn("type", "type of messages").Words(),
                                {"messages", "messages"},
                                {"rate_hz", "rate [Hz]"},
                                ForPeople("use").Words(),
                                OnlyInJson("problem"),
                                OnlyInJson("is_taken"),
                                OnlyInJson("has_stamps"),
                                OnlyInJson("is_cut")},
                    .rows = {}};
  for (const ListedTopic& topic : topics) {
    const auto if_taken = [&](bool value) {
      return topic.is_taken ? ResultCell(value) : ResultCell();
    };
    const std::string use = !topic.problem.empty() ? "not read"
                            : topic.is_taken       ? "this table"
                            : topic.has_signals    ? ""
                                                   : "no signals";
    table.rows.push_back(
        {ResultCell({OneLine(topic.name)}, OneLine(topic.name, 40)),
         ResultCell({OneLine(topic.type)}, OneLine(topic.type, 40)),
         ResultCell({static_cast<std::int64_t>(topic.messages)}, fmt::to_string(topic.messages)),
         topic.rate_hz > 0.0 ? ResultCell({topic.rate_hz}, fmt::format("{:.4g}", topic.rate_hz))
                             : ResultCell(),
         ResultCell::Text(use), ResultCell::IfAny(topic.problem), ResultCell(topic.is_taken),
         if_taken(topic.has_stamps), if_taken(topic.is_cut)});
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
  ResultTable health{.columns = {OnlyInJson("column"), OnlyInJson("finding"), OnlyInJson("value"),
                                 OnlyInJson("sentence")}};
  for (const HealthFinding& finding : HealthOf(inspection)) {
    health.rows.push_back({ResultCell(static_cast<std::int64_t>(finding.column + 1)),
                           ResultCell(finding.key), ResultCell(ResultValue{finding.value}),
                           ResultCell(finding.sentence)});
  }
  const Json json = {{"file", OneLine(inspection.file)},
                     {"format", NameOf(inspection.format)},
                     {"arrays", JsonOf(arrays)},
                     {"topics", JsonOf(TopicsTable(inspection.topics))},
                     {"separator", SeparatorText(layout.separator)},
                     {"decimal_comma", layout.decimal_comma},
                     {"skipped_lines", layout.skipped_lines},
                     {"rows", inspection.rows},
                     {"is_whole", inspection.is_whole && !inspection.is_cut},
                     {"is_cut", inspection.is_cut},
                     {"has_time", inspection.has_time},
                     {"rate_hz", inspection.time.rate_hz},
                     {"rate_is_known", inspection.rate_is_known},
                     {"rate_is_assumed", inspection.rate_is_assumed},
                     {"duration_s", inspection.time.duration_s},
                     {"gaps", inspection.time.gaps},
                     {"restarts", inspection.time.restarts},
                     {"unit", NameOf(inspection.unit)},
                     {"unit_is_assumed", inspection.unit_is_assumed},
                     {"bits", inspection.bits},
                     {"profile", inspection.profile},
                     {"profiles_to_ask_for", inspection.profiles_to_ask_for},
                     {"summary", SummaryOf(inspection)},
                     {"question", inspection.question},
                     {"repairs", inspection.problems},
                     {"remarks", inspection.remarks},
                     {"health", JsonOf(health)},
                     {"columns", JsonOf(ColumnsTable(inspection, false))}};
  return json.dump(2) + "\n";
}

std::string SeparatorText(char separator) {
  if (separator == '\t') return "tab";
  if (separator == ' ') return "blanks";
  return separator == ';' ? "semicolon" : "comma";
}

}  // namespace gauntlet::sim
