#include "sim/show/video/recording_picture.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include "sim/base/chart_scale.h"
#include "sim/base/error.h"
#include "sim/base/text.h"
#include "sim/show/video/painter.h"

namespace gauntlet::sim {
namespace {

constexpr int kWidth = 1280;
constexpr double kMargin = 40.0;
constexpr double kHead = 116.0;
constexpr double kFoot = 56.0;
constexpr double kNameWidth = 232.0;
constexpr double kFactWidth = 190.0;
constexpr std::size_t kMostRows = 24;
constexpr double kLongest_s = 60.0;  // of a longer recording the beginning is drawn

struct Row {
  std::string name;
  std::string joint;
  std::string range;
  std::string remark;
  const std::vector<double>* values;
  double low, high;
};

std::string RemarkOf(const InspectedColumn& column) {
  constexpr double kMuch = 0.05;
  constexpr double kMostlyStill = 0.9;
  if (column.statistics.low == column.statistics.high) return "never moves";
  if (column.statistics.clipped_share > kMuch) {
    return fmt::format("{:.0f} % clipped", 100.0 * column.statistics.clipped_share);
  }
  if (column.statistics.still_share > kMostlyStill) {
    return fmt::format("{:.0f} % repeats", 100.0 * column.statistics.still_share);
  }
  return "";
}

std::vector<Row> RowsOf(const Inspection& inspection) {
  std::vector<Row> rows;
  for (const std::size_t c : inspection.Sensors()) {
    const InspectedColumn& column = inspection.columns[c];
    rows.push_back(
        {.name = column.name.empty() ? fmt::format("column {}", c + 1) : column.name,
         .joint = column.channel,
         .range = fmt::format("{:.4g} .. {:.4g}", column.statistics.low, column.statistics.high),
         .remark = RemarkOf(column),
         .values = &inspection.picture_values[c],
         .low = column.statistics.usual_low,
         .high = column.statistics.usual_high});
    if (rows.size() == kMostRows) break;
  }
  return rows;
}

void DrawCurve(Painter& painter, const Rect& area, const Row& row,
               const std::vector<double>& times_s, double end_s) {
  const double range = row.high > row.low ? row.high - row.low : 1.0;
  constexpr double kPad = 5.0;
  std::vector<Point> points;
  for (std::size_t i = 0; i < times_s.size() && times_s[i] <= end_s; ++i) {
    const double share = ((*row.values)[i] - row.low) / range;
    points.push_back({area.x + area.width * times_s[i] / end_s,
                      area.bottom() - kPad - (area.height - 2.0 * kPad) * share});
  }
  painter.Clip(area);
  painter.Polyline(points, palette::kHand.OnLight(), 1.3);
  painter.Unclip();
}

std::string Headline(const Inspection& inspection) {
  std::string text = fmt::format("{}, {} rows", NameOf(inspection.format), inspection.rows);
  if (inspection.has_time) {
    text +=
        fmt::format(", {:.4g} Hz, {:.4g} s", inspection.time.rate_hz, inspection.time.duration_s);
  } else {
    text += inspection.rate_is_known ? fmt::format(", {:.4g} Hz as given", inspection.time.rate_hz)
                                     : std::string(", no time: 50 Hz assumed");
  }
  text += fmt::format(", unit {}", NameOf(inspection.unit));
  if (inspection.bits > 0) text += fmt::format(" of {} bits", inspection.bits);
  if (inspection.time.gaps > 0) text += fmt::format(", {} gaps", inspection.time.gaps);
  return text;
}

}  // namespace

Image DrawRecording(const Inspection& inspection) {
  const std::vector<Row> rows = RowsOf(inspection);
  if (rows.empty() || inspection.picture_time_s.size() < 2) {
    throw UserError({.place = inspection.file,
                     .problem = "no column looks like a sensor of a hand, "
                                "so there is nothing to draw"});
  }
  const double row_height = rows.size() > 10 ? 40.0 : 56.0;
  const double table_height = row_height * static_cast<double>(rows.size());
  Image image(kWidth, static_cast<int>(kHead + table_height + kFoot));
  const std::unique_ptr<Painter> opened = OpenPainter(image);
  Painter& painter = *opened;
  painter.Fill({0.0, 0.0, kWidth, static_cast<double>(image.height_px)}, palette::kPage);
  const Rect card = {kMargin, kHead - 12.0, kWidth - 2.0 * kMargin, table_height + 24.0};
  painter.Fill(card, palette::kCard, 10.0);
  painter.Outline(card, palette::kCardEdge, 1.0, 10.0);
  const TextStyle title = {.size_px = 26.0, .bold = true};
  const TextStyle muted = {.size_px = 15.0, .color = palette::kMutedOnLight};
  const double width = card.width;
  const std::string file = OneLine(std::filesystem::path(inspection.file).filename().string());
  painter.Text(painter.Elide(file, width, title), {kMargin, 50.0}, title);
  painter.Text(painter.Elide(Headline(inspection), width, muted), {kMargin, 78.0}, muted);

  const double end_s = std::min(inspection.picture_time_s.back(), kLongest_s);
  const Rect plot = {kMargin + kNameWidth, kHead, width - kNameWidth - kFactWidth, table_height};
  const TextStyle tick = {
      .size_px = 13.0, .color = palette::kMutedOnLight, .align = Align::kCenter, .tabular = true};
  const Extent times = {.low = 0.0, .high = end_s};
  for (const double time_s : Ticks(times, TickStep(times, 8))) {
    const double x = plot.x + plot.width * time_s / end_s;
    painter.Line({x, plot.y}, {x, plot.bottom()}, palette::kGrid, 1.0);
    painter.Text(fmt::format("{:g} s", time_s), {x, card.bottom() + 24.0}, tick);
  }
  const TextStyle joint = {.size_px = 15.0, .bold = true};
  const TextStyle small = {.size_px = 13.0, .color = palette::kMutedOnLight};
  const TextStyle number = {.size_px = 13.0, .tabular = true};
  const TextStyle warning = {.size_px = 13.0, .color = palette::kWarning};
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const Row& row = rows[i];
    const double y = kHead + row_height * static_cast<double>(i);
    const double middle = y + 0.5 * row_height;
    if (i > 0) painter.Line({card.x, y}, {card.right(), y}, palette::kGrid, 1.0);
    const double text_width = kNameWidth - 32.0;
    painter.Text(painter.Elide(row.joint, text_width, joint), {card.x + 16.0, middle - 3.0}, joint);
    painter.Text(painter.Elide(row.name, text_width, small), {card.x + 16.0, middle + 14.0}, small);
    DrawCurve(painter, {plot.x, y + 1.0, plot.width, row_height - 2.0}, row,
              inspection.picture_time_s, end_s);
    const double fact_x = plot.right() + 18.0;
    painter.Text(row.range, {fact_x, row.remark.empty() ? middle + 5.0 : middle - 3.0}, number);
    painter.Text(row.remark, {fact_x, middle + 14.0}, warning);
  }
  return image;
}

}  // namespace gauntlet::sim
