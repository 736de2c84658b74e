#include "sim/report/cells_chart.h"

#include <algorithm>
#include <cmath>

#include "controller/number.h"
#include "sim/base/chart_scale.h"
#include "sim/report/drawing.h"
#include "sim/results/html_text.h"
#include "sim/results/table_text.h"

namespace gauntlet::sim {

double ChartAxis::PlaceOf(double value) const {
  if (!(high > low)) return 0.5;
  const double place =
      log ? std::log(value / low) / std::log(high / low) : (value - low) / (high - low);
  return std::isfinite(place) ? std::clamp(place, 0.0, 1.0) : controller::kNaN;
}

double ChartAxis::PlaceOf(const std::string& value) const {
  if (!labels.empty()) {
    const auto found = std::ranges::find(labels, value);
    if (found == labels.end()) return controller::kNaN;
    const auto item = static_cast<double>(found - labels.begin());
    return labels.size() < 2 ? 0.5 : item / (static_cast<double>(labels.size()) - 1.0);
  }
  return PlaceOf(controller::ParseNumber(value).value_or(controller::kNaN));
}

std::string HeatMapSvg(const HeatMap& map) {
  constexpr double kLeft = 96.0, kTop = 30.0, kBottom = 56.0, kCellHeight = 30.0;
  const auto columns = static_cast<double>(map.x_labels.size());
  const auto rows = static_cast<double>(map.y_labels.size());
  const double cell_width = std::clamp(600.0 / columns, 26.0, 90.0);
  const double width = kLeft + columns * cell_width + 10.0;
  const double height = kTop + rows * kCellHeight + kBottom;
  Extent range;
  for (const double value : map.best) range.Take(value);
  Drawing drawing(width, height, "heat-map",
                  fmt::format("Best {} over {} and {}: {} to {}", map.score, map.x_name, map.y_name,
                              Short(range.low), Short(range.high)));
  drawing.Text(0.0, 16.0, "start", map.y_name, "name");
  // Labels stand on every n-th column where they would meet.
  const auto every = static_cast<std::size_t>(std::ceil(46.0 / cell_width));
  for (std::size_t y = 0; y < map.y_labels.size(); ++y) {
    // The largest value is on top, as in a chart.
    const double top = kTop + (rows - 1.0 - static_cast<double>(y)) * kCellHeight;
    drawing.Text(kLeft - 8.0, top + 20.0, "end", Shortened(map.y_labels[y], 12));
    for (std::size_t x = 0; x < map.x_labels.size(); ++x) {
      const std::size_t at = y * map.x_labels.size() + x;
      const double left = kLeft + static_cast<double>(x) * cell_width;
      const double value = map.best[at];
      if (std::isnan(value)) continue;
      const double bad = map.lower_is_better ? range.Share(value) : 1.0 - range.Share(value);
      const std::string point =
          map.points[at] == kNoPoint ? "" : fmt::format(" data-point=\"{}\"", map.points[at]);
      drawing.Add(
          "<g{} style=\"--share: {:.0f}%\"><title>{} {}, {} {}: {}</title><rect x=\"{:.1f}\" "
          "y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\" rx=\"3\"/>",
          point, 80.0 * bad, EscapeHtml(map.x_name), EscapeHtml(map.x_labels[x]),
          EscapeHtml(map.y_name), EscapeHtml(map.y_labels[y]), Short(value), left + 1.0, top + 1.0,
          cell_width - 2.0, kCellHeight - 2.0);
      if (cell_width >= 40.0) {
        drawing.Text(left + 0.5 * cell_width, top + 20.0, "middle", Short(value), "value");
      }
      drawing.Add("</g>");
    }
  }
  for (std::size_t x = 0; x < map.x_labels.size(); x += every) {
    drawing.Text(kLeft + (static_cast<double>(x) + 0.5) * cell_width,
                 kTop + rows * kCellHeight + 18.0, "middle", Shortened(map.x_labels[x], 12));
  }
  drawing.Text(kLeft + 0.5 * columns * cell_width, height - 8.0, "middle", map.x_name, "name");
  return drawing.Done();
}

std::string ParallelSvg(const std::vector<ChartAxis>& axes, const std::vector<ChartPoint>& points) {
  constexpr double kEach = 118.0, kTop = 44.0, kHeight = 300.0, kLeft = 56.0;
  const double width =
      2.0 * kLeft + kEach * (static_cast<double>(std::max<std::size_t>(axes.size(), 2)) - 1.0);
  Drawing drawing(
      width, kTop + kHeight + 34.0, "parallel",
      fmt::format("{} points as lines over {} settings and scores", points.size(), axes.size()));
  const auto y_of = [&](double place) { return kTop + (1.0 - place) * kHeight; };
  const auto x_of = [&](std::size_t axis) { return kLeft + kEach * static_cast<double>(axis); };
  // The best are drawn last, over the others.
  for (std::size_t i = points.size(); i-- > 0;) {
    const ChartPoint& point = points[i];
    std::string way;
    for (std::size_t a = 0; a < axes.size(); ++a) {
      if (std::isnan(point.places[a])) continue;
      way +=
          fmt::format("{}{:.0f} {:.1f}", way.empty() ? "M" : "L", x_of(a), y_of(point.places[a]));
    }
    const char* kind = point.faint ? "faint" : (point.good ? "good" : "");
    drawing.Add("<path data-point=\"{}\" class=\"{}\" d=\"{}\"/>", i, kind, way);
  }
  for (std::size_t a = 0; a < axes.size(); ++a) {
    const ChartAxis& axis = axes[a];
    drawing.Line(x_of(a), kTop, x_of(a), kTop + kHeight, "axis");
    drawing.Add(
        "<rect class=\"brush-place\" data-axis=\"{}\" x=\"{:.1f}\" y=\"{:.1f}\" "
        "width=\"36\" height=\"{:.1f}\"/>",
        a, x_of(a) - 18.0, kTop, kHeight);
    // Two lines, at a point or underscore where there is one.
    const std::size_t middle =
        axis.name.size() > 15 ? axis.name.find_first_of("._", 6) : axis.name.npos;
    const bool two = middle != std::string::npos && middle + 1 < axis.name.size();
    if (two)
      drawing.Text(x_of(a), 14.0, "middle", Shortened(axis.name.substr(0, middle + 1), 18), "name");
    drawing.Text(x_of(a), 30.0, "middle",
                 Shortened(two ? axis.name.substr(middle + 1) : axis.name, 18), "name");
    if (axis.labels.empty()) {
      drawing.Text(x_of(a), kTop + kHeight + 18.0, "middle", fmt::format("{:.3g}", axis.low));
      drawing.Text(x_of(a) + 5.0, kTop + 11.0, "start", fmt::format("{:.3g}", axis.high));
      continue;
    }
    const std::size_t every = (axis.labels.size() + 11) / 12;
    for (std::size_t i = 0; i < axis.labels.size(); i += every) {
      drawing.Text(x_of(a) + 5.0, y_of(axis.PlaceOf(axis.labels[i])) + (i == 0 ? -3.0 : 11.0),
                   "start", Shortened(axis.labels[i], 14));
    }
  }
  return drawing.Done();
}

}  // namespace gauntlet::sim
