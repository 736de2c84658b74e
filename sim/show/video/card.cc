#include "sim/show/video/card.h"

#include <algorithm>
#include <vector>

namespace gauntlet::sim {
namespace {

constexpr double kCardMargin = 96.0;  // in pixels at 1280 x 720, as all below
constexpr double kNameWidth = 250.0;
constexpr double kMaxRowHeight = 92.0;

/// The text in lines of at most this width, broken between words.
std::vector<std::string> Lines(Painter& painter, const std::string& text, double width,
                               const TextStyle& style) {
  std::vector<std::string> lines(1);
  std::size_t start = 0;
  while (start < text.size()) {
    const std::size_t end = std::min(text.find(' ', start), text.size());
    const std::string word = text.substr(start, end - start);
    const std::string longer = lines.back().empty() ? word : lines.back() + " " + word;
    if (lines.back().empty() || painter.TextWidth(longer, style) <= width) {
      lines.back() = longer;
    } else {
      lines.push_back(word);
    }
    start = end + 1;
  }
  return lines;
}

/// From the first baseline on; the baseline of what would come next.
double DrawLines(Painter& painter, const std::string& text, Point at, double width,
                 const TextStyle& style) {
  for (const std::string& line : Lines(painter, text, width, style)) {
    painter.Text(painter.Elide(line, width, style), at, style);
    at.y += 1.35 * style.size_px;
  }
  return at.y;
}

Color ColorOf(ScoreBoardCell::Tone tone) {
  constexpr Color kColors[] = {palette::kInkOnLight, palette::kBetter, palette::kWarning};
  return kColors[static_cast<std::size_t>(tone)];
}

}  // namespace

void DrawTitleCard(Painter& painter, const Rect& frame, double unit, const std::string& title,
                   const std::string& question) {
  painter.Fill(frame, palette::kPage);
  const double margin = kCardMargin * unit, width = frame.width - 2.0 * margin;
  const TextStyle name = {.size_px = 22.0 * unit, .color = palette::kMutedOnLight};
  const TextStyle asked = {.size_px = 38.0 * unit, .bold = true};
  const double lines = static_cast<double>(Lines(painter, question, width, asked).size());
  const double top = 0.5 * (frame.height - 1.35 * lines * asked.size_px) + asked.size_px;
  painter.Text(painter.Elide(title, width, name), {margin, top - 1.6 * asked.size_px}, name);
  DrawLines(painter, question, {margin, top}, width, asked);
}

void DrawScoreBoard(Painter& painter, const Rect& frame, double unit, const std::string& title,
                    const ScoreBoard& verdict) {
  painter.Fill(frame, palette::kPage);
  const double margin = kCardMargin * unit, width = frame.width - 2.0 * margin;
  const TextStyle heading = {.size_px = 22.0 * unit, .color = palette::kMutedOnLight};
  const TextStyle column = {.size_px = 14.0 * unit, .color = palette::kMutedOnLight};
  const TextStyle name = {.size_px = 22.0 * unit, .bold = true};
  painter.Text(painter.Elide(title, width, heading), {margin, 64.0 * unit}, heading);
  double y = 64.0 * unit;
  if (!verdict.answer.empty()) {
    y = DrawLines(painter, verdict.answer, {margin, 104.0 * unit}, width,
                  {.size_px = 22.0 * unit, .bold = true});
  }

  const double first = margin + kNameWidth * unit;
  const double column_width =
      (width - kNameWidth * unit) / static_cast<double>(verdict.columns.size());
  const double top = y + 56.0 * unit, bottom = frame.height - 92.0 * unit;
  const double row_height =
      std::min(kMaxRowHeight * unit, (bottom - top) / static_cast<double>(verdict.rows.size()));
  for (std::size_t i = 0; i < verdict.columns.size(); ++i) {
    painter.Text(verdict.columns[i],
                 {first + static_cast<double>(i) * column_width, top - 14.0 * unit}, column);
  }
  y = top;
  for (const ScoreBoardRow& row : verdict.rows) {
    painter.Line({margin, y}, {margin + width, y}, palette::kCardEdge, unit);
    const double baseline = y + 0.5 * row_height + 2.0 * unit;
    painter.Dot({margin + 7.0 * unit, baseline - 7.0 * unit}, 7.0 * unit,
                ColourOfSeries(row.series));
    painter.Text(painter.Elide(row.controller, (kNameWidth - 38.0) * unit, name),
                 {margin + 22.0 * unit, baseline}, name);
    for (std::size_t i = 0; i < row.cells.size(); ++i) {
      const ScoreBoardCell& cell = row.cells[i];
      const Color color = ColorOf(cell.tone);
      const double x = first + static_cast<double>(i) * column_width;
      painter.Text(cell.value, {x, baseline},
                   {.size_px = std::min(28.0 * unit, 0.42 * row_height),
                    .color = color,
                    .bold = true,
                    .tabular = true});
      painter.Text(
          painter.Elide(cell.detail, column_width - 8.0 * unit, column),
          {x, baseline + std::min(20.0 * unit, 0.34 * row_height)},
          {.size_px = std::min(14.0 * unit, 0.24 * row_height), .color = color, .tabular = true});
    }
    y += row_height;
  }
  painter.Line({margin, y}, {margin + width, y}, palette::kCardEdge, unit);
  DrawLines(painter, verdict.remark, {margin, y + 30.0 * unit}, width, column);
}

}  // namespace gauntlet::sim
