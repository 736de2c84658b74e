#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <set>
#include <utility>

#include "sim/base/text.h"
#include "sim/recordings/inspect/health.h"
#include "sim/recordings/inspect/inspection.h"
#include "sim/recordings/inspect/inspection_tables.h"
#include "sim/recordings/inspect/starter_files.h"
#include "sim/results/html_text.h"
#include "sim/show/pages/cells_page.h"
#include "sim/show/pages/channel_chart.h"
#include "sim/show/pages/pages.h"
#include "sim/show/pages/plain_page.h"

namespace gauntlet::sim {
namespace {

/// The sensors; without any, all columns of numbers but the time.
std::vector<std::size_t> ChannelsOf(const Inspection& inspection) {
  std::vector<std::size_t> channels = inspection.Sensors();
  if (!channels.empty()) return channels;
  for (std::size_t c = 0; c < inspection.columns.size(); ++c) {
    const InspectedColumn& column = inspection.columns[c];
    if (column.kind == CellKind::kNumber && !column.is_time && column.statistics.good_rows > 0) {
      channels.push_back(c);
    }
  }
  return channels;
}

/// A row per finding. The remedy is behind the last semicolon of its sentence.
std::string HealthTable(const Inspection& inspection, const std::vector<HealthFinding>& findings) {
  if (findings.empty()) return "<p class=\"note\">No sensor has a defect.</p>\n";
  const bool has_joints = std::ranges::any_of(findings, [&](const HealthFinding& finding) {
    return !inspection.columns[finding.column].channel.empty();
  });
  ResultTable table{.columns = {ForPeople("sensor"), ForPeople(has_joints ? "joint" : "").Words(),
                                ForPeople("finding").Words(), ForPeople("what to do").Words()}};
  for (const HealthFinding& finding : findings) {
    const InspectedColumn& column = inspection.columns[finding.column];
    const std::size_t cut =
        finding.key == "repeats" ? std::string::npos : finding.sentence.rfind("; ");
    const std::string name = OneLine(column.name, 40);
    table.rows.push_back(
        {ResultCell::Text(name.empty() ? fmt::format("column {}", finding.column + 1) : name),
         ResultCell::Text(column.channel), ResultCell::Text(finding.sentence.substr(0, cut)),
         ResultCell::Text(cut == std::string::npos ? "" : finding.sentence.substr(cut + 2))});
  }
  return HtmlOf(table);
}

std::vector<HeadNumber> NumbersOf(const Inspection& inspection,
                                  const std::vector<HealthFinding>& findings) {
  const std::vector<std::size_t> sensors = inspection.Sensors();
  if (sensors.empty()) return {};
  std::set<std::size_t> bad;
  for (const HealthFinding& finding : findings) bad.insert(finding.column);
  const std::size_t joints = inspection.MappedColumns().size();
  return {{.name = "sensors without a defect",
           .value = fmt::format("{} of {}", sensors.size() - std::min(bad.size(), sensors.size()),
                                sensors.size()),
           .judgement = bad.empty() ? Judgement::kBetter : Judgement::kWorse},
          {.name = "joints", .value = fmt::to_string(joints), .note = BasisText(inspection)},
          {.name = "length", .value = fmt::format("{:.4g} s", inspection.time.duration_s)}};
}

std::string JointsTable(const Inspection& inspection) {
  ResultTable table{
      .columns = {ForPeople("#"), ForPeople("column"), ForPeople("joint or quantity").Words(),
                  ForPeople("unit").Words(), ForPeople("assumed").Words(), ForPeople("lowest"),
                  ForPeople("highest"), ForPeople("noise")},
      .names = 2};
  const ResultTable columns = ColumnsTable(inspection, false);
  const auto place = [&columns](std::string_view key) {
    const auto found = std::ranges::find_if(columns.columns, [key](const ResultColumn& column) {
      return column.key == key || column.heading == key;
    });
    return static_cast<std::size_t>(found - columns.columns.begin());
  };
  for (std::size_t c = 0; c < inspection.columns.size(); ++c) {
    const InspectedColumn& column = inspection.columns[c];
    const ResultRow& row = columns.rows[c];
    std::string assumed = column.channel.empty() ? "" : AssumedOf(inspection, column);
    for (std::size_t at = 0; (at = assumed.find(' ', at)) != std::string::npos; at += 2) {
      assumed.replace(at, 1, ", ");
    }
    table.rows.push_back({row[place("#")], row[place("column")],
                          ResultCell::Text(column.channel.empty() || column.is_dead
                                               ? row[place("joint or quantity")].text
                                               : column.channel),
                          ResultCell::Text(column.is_sensor ? NameOf(inspection.unit) : ""),
                          ResultCell::Text(assumed), row[place("low")], row[place("high")],
                          row[place("noise")]});
  }
  return HtmlOf(table);
}

std::string Pictures(const Inspection& inspection, const std::vector<HealthFinding>& findings) {
  if (inspection.picture_time_s.size() < 2) return "";
  std::string charts;
  std::vector<DefectMarks> marks;
  for (const std::size_t c : ChannelsOf(inspection)) {
    charts += SvgOf(ChannelChart(inspection, findings, c));
    marks.push_back(FindDefects(inspection, findings, c));
  }
  return LegendOfMarks(marks) + "<div class=\"channels\">\n" + charts + "</div>\n";
}

}  // namespace

std::string InspectionPage(const Inspection& inspection) {
  const std::vector<HealthFinding> findings = HealthOf(inspection);
  const std::size_t kept = std::max<std::size_t>(1, inspection.picture_time_s.size());
  const std::string thinned =
      inspection.rows > kept ? fmt::format(" One in {} rows is drawn, so spikes are not marked.",
                                           inspection.rows / kept)
                             : std::string();
  const std::string unit =
      inspection.Sensors().empty() ? "" : fmt::format(", in {}", NameOf(inspection.unit));
  PageHead head{
      .kind = "Gauntlet inspect",
      .title = OneLine(std::filesystem::path(inspection.file).filename().string()),
      .question = "Are the sensors of this recording sound, and which joints do they measure?",
      .numbers = NumbersOf(inspection, findings)};
  SetAnswer(SummaryOf(inspection) + ".", head);
  if (!inspection.question.empty()) head.warnings = {"Open: " + inspection.question + "."};
  head.facts =
      fmt::format("{} rows of {} columns · {:.5g} s · joints: {}", inspection.rows,
                  inspection.layout.columns, inspection.time.duration_s, BasisText(inspection));
  if (const std::string noise = NoiseText(inspection); !noise.empty()) head.facts += " · " + noise;
  return PlainPage(
      {.head = std::move(head),
       .heading = "Health",
       .table = HealthTable(inspection, findings),
       .sections =
           PageSection("channels", "Channels over time",
                       fmt::format("Each picture is a channel over time in s{}.{}", unit, thinned),
                       Pictures(inspection, findings)) +
           PageSection("joints", "Joints",
                       "A column map confirms or corrects what is assumed: gauntlet inspect "
                       "--write-map MAP.csv.",
                       JointsTable(inspection))});
}

}  // namespace gauntlet::sim
