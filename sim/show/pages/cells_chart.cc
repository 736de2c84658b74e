#include "sim/show/pages/cells_chart.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "controller/number.h"
#include "sim/results/table_text.h"
#include "sim/show/figure/figure.h"

namespace gauntlet::sim {
namespace {

constexpr double kHeatRow = 30.0;         // height of a cell
constexpr double kWidthOfValue = 40.0;    // least width of a cell that shows its value
constexpr double kHeatLabelSpace = 46.0;  // least distance of two labels below a heat map
constexpr FigureLayout kHeatLayout = {.left = 96.0, .top = 30.0, .right = 10.0, .bottom = 56.0};
constexpr double kAxisDistance = 118.0;  // between two parallel axes
constexpr FigureLayout kAxesLayout = {.left = 56.0, .top = 44.0, .right = 56.0, .bottom = 34.0};
constexpr double kAxisHeight = 300.0;
constexpr double kBrushWidth = 36.0;
constexpr std::size_t kMostAxisLabels = 12;

std::string ShareStyle(double share) {
  return fmt::format(" style=\"--share: {:.0f}%\"", 100.0 * share);
}

/// Share of the colour for a value; it jumps at the limit.
double ShareOfLimit(double times_limit) {
  constexpr double kBelow = 0.35, kAbove = 0.6;
  return times_limit <= 1.0 ? kBelow * times_limit
                            : kAbove + (1.0 - kAbove) * std::min(times_limit - 1.0, 1.0);
}

/// The colours from 0 to twice the limit, at the left, where they stay in sight on a narrow screen.
void AddScale(Figure& figure, const LimitScale& scale) {
  constexpr int kSteps = 12;
  constexpr double kStep = 25.0, kTop = 2.0, kBottom = 16.0, kText = 32.0;
  for (int i = 0; i < kSteps; ++i) {
    const double times_limit = 2.0 * (i + 0.5) / kSteps;
    figure.Box({i * kStep, kTop}, {(i + 1) * kStep, kBottom},
               {.css = "cell", .attributes = ShareStyle(ShareOfLimit(times_limit))});
  }
  const double middle = 0.5 * kSteps * kStep;
  figure.Line({middle, kTop}, {middle, kBottom + 3.0}, {"axis"});
  figure.Text({0.0, kText}, Anchor::kStart, scale.at_zero);
  figure.Text({middle, kText}, Anchor::kMiddle, scale.at_limit);
  figure.Text({2.0 * middle, kText}, Anchor::kEnd, scale.above);
}

/// The cell of one column and row, with its value if it is wide enough.
void AddHeatCell(Figure& figure, const HeatMap& map, const Extent& range, std::size_t x,
                 std::size_t y, const FigureBox& cell) {
  const std::size_t at = y * map.x_labels.size() + x;
  const double value = map.best[at];
  if (std::isnan(value)) return;
  const double bad = map.lower_is_better ? range.Share(value) : 1.0 - range.Share(value);
  const std::string share =
      ShareStyle(map.scale ? ShareOfLimit(map.scale->times_limit[at]) : 0.8 * bad);
  const std::size_t point = map.points[at];
  Ink ink = point == kNoPoint ? Ink{.css = "cell", .attributes = share}
                              : InkOfPoint(point, "cell", share);
  ink.said = fmt::format("{} {}, {} {}: {}", map.x_name, map.x_labels[x], map.y_name,
                         map.y_labels[y], Short(value));
  figure.Box({cell.left + 1.0, cell.top + 1.0}, {cell.right - 1.0, cell.bottom - 1.0}, ink, 3.0);
  if (cell.right - cell.left < kWidthOfValue) return;
  figure.Text({cell.centre().x, cell.centre().y + kFigureLayout.baseline}, Anchor::kMiddle,
              Short(value), {"value"});
}

/// The name of an axis in at most two lines, broken at a point or an underscore.
void AddAxisName(Figure& figure, const std::string& name, double x) {
  constexpr double kWidth = kAxisDistance - 6.0, kLongest = 15, kShortestPart = 6;
  const std::size_t end =
      name.size() > kLongest ? name.find_first_of("._", kShortestPart) : name.npos;
  const bool two = end != name.npos && end + 1 < name.size();
  if (two) {
    figure.Text({x, 14.0}, Anchor::kMiddle, FittedText(name.substr(0, end + 1), kWidth), {"name"});
  }
  figure.Text({x, 30.0}, Anchor::kMiddle, FittedText(two ? name.substr(end + 1) : name, kWidth),
              {"name"});
}

/// An axis from `low` up to `high`, with its name, labels and the place where a brush starts.
void AddAxis(Figure& figure, const ChartAxis& axis, std::size_t number, FigurePoint low,
             FigurePoint high) {
  figure.Line(low, high, {"axis"});
  figure.Box({low.x - 0.5 * kBrushWidth, low.y}, {high.x + 0.5 * kBrushWidth, high.y},
             {.css = "brush-place", .attributes = fmt::format(" data-axis=\"{}\"", number)});
  AddAxisName(figure, axis.name, low.x);
  if (axis.labels.empty()) {
    figure.Text({low.x, low.y + kFigureLayout.tick_drop}, Anchor::kMiddle,
                fmt::format("{:.3g}", axis.low));
    figure.Text({high.x + 5.0, high.y + 11.0}, Anchor::kStart, fmt::format("{:.3g}", axis.high));
    return;
  }
  const std::size_t every = (axis.labels.size() + kMostAxisLabels - 1) / kMostAxisLabels;
  for (std::size_t i = 0; i < axis.labels.size(); i += every) {
    const double y = low.y + axis.PlaceOf(axis.labels[i]) * (high.y - low.y);
    figure.Text({low.x + 5.0, y + (i == 0 ? -3.0 : 11.0)}, Anchor::kStart,
                FittedText(axis.labels[i], kAxisDistance - 10.0));
  }
}

}  // namespace

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

double HeatMap::FilledShare() const {
  const auto filled = std::ranges::count_if(best, [](double value) { return !std::isnan(value); });
  return static_cast<double>(filled) / static_cast<double>(std::max<std::size_t>(best.size(), 1));
}

std::string ScatterSvg(const std::vector<ChartAxis>& axes, std::size_t x, std::size_t y,
                       const std::vector<ChartPoint>& points, const std::vector<double>& shares) {
  constexpr std::size_t kMostLabels = 6;
  Figure figure{460.0, 330.0, "heat-map scatter",
                fmt::format("Settings tried, over {} and {}", axes[x].name, axes[y].name)};
  FigureLayout layout = kHeatLayout;
  layout.right = 24.0;
  const FigureBox area = figure.Inside(layout);
  const auto place = [](double share, double low, double high) {
    constexpr double kMargin = 0.04;
    return low + (kMargin + (1.0 - 2.0 * kMargin) * share) * (high - low);
  };
  const auto each_label = [&](const ChartAxis& axis, const auto& add) {
    std::vector<std::string> labels = axis.labels;
    if (labels.empty()) {
      const double middle =
          axis.log ? std::sqrt(axis.low * axis.high) : 0.5 * (axis.low + axis.high);
      for (const double value : {axis.low, middle, axis.high}) {
        labels.push_back(fmt::format("{:.3g}", value));
      }
    }
    const std::size_t every = (labels.size() + kMostLabels - 1) / kMostLabels;
    for (std::size_t i = 0; i < labels.size(); i += every) {
      add(labels.size() < 2 ? 0.5 : static_cast<double>(i) / static_cast<double>(labels.size() - 1),
          labels[i]);
    }
  };
  figure.Text({0.0, layout.top - 14.0}, Anchor::kStart, axes[y].name, {"name"});
  figure.Line({area.left, area.bottom}, {area.right, area.bottom}, {"axis"});
  figure.Line({area.left, area.top}, {area.left, area.bottom}, {"axis"});
  each_label(axes[x], [&](double share, const std::string& label) {
    figure.Text({place(share, area.left, area.right), area.bottom + kHeatLayout.tick_drop},
                Anchor::kMiddle, label);
  });
  each_label(axes[y], [&](double share, const std::string& label) {
    figure.Text({area.left - kHeatLayout.tick_gap,
                 place(share, area.bottom, area.top) + kHeatLayout.baseline},
                Anchor::kEnd, FittedText(label, area.left - 2.0 * kHeatLayout.tick_gap));
  });
  for (std::size_t i = points.size(); i-- > 0;) {  // the best last, over the others
    const double across = points[i].places[x], up = points[i].places[y];
    if (std::isnan(across) || std::isnan(up) || std::isnan(shares[i])) continue;
    figure.Dot({place(across, area.left, area.right), place(up, area.bottom, area.top)}, 6.0,
               InkOfPoint(i, std::string("cell") + (points[i].faint ? " faint" : ""),
                          ShareStyle(0.1 + 0.8 * shares[i])));
  }
  figure.Text({area.centre().x, figure.height_px - 8.0}, Anchor::kMiddle, axes[x].name, {"name"});
  return SvgOf(figure);
}

std::string HeatMapSvg(const HeatMap& map) {
  const auto columns = static_cast<double>(map.x_labels.size());
  const auto rows = static_cast<double>(map.y_labels.size());
  const double cell_width = std::clamp(600.0 / columns, 26.0, 90.0);
  Extent range;
  for (const double value : map.best) range.Include(value);
  FigureLayout layout = kHeatLayout;
  constexpr double kLegend = 40.0, kLegendWidth = 310.0, kLongerNames = 24.0;
  if (map.scale) {
    layout.top += kLegend;
    layout.left += kLongerNames;
  }
  const double width_px = layout.left + columns * cell_width + layout.right;
  Figure figure{map.scale ? std::max(width_px, kLegendWidth) : width_px,
                layout.top + rows * kHeatRow + layout.bottom, "heat-map",
                fmt::format("{}{} over {} and {}: {} to {}", map.scale ? "" : "Best ", map.score,
                            map.x_name, map.y_name, Short(range.low), Short(range.high))};
  const FigureBox area = figure.Inside(layout);
  if (map.scale) AddScale(figure, *map.scale);
  figure.Text({0.0, layout.top - 14.0}, Anchor::kStart, map.y_name, {"name"});
  for (std::size_t y = 0; y < map.y_labels.size(); ++y) {
    const double bottom = area.bottom - static_cast<double>(y) * kHeatRow;
    figure.Text({area.left - kHeatLayout.tick_gap, bottom - 0.5 * kHeatRow + kHeatLayout.baseline},
                Anchor::kEnd, FittedText(map.y_labels[y], area.left - 2.0 * kHeatLayout.tick_gap));
    for (std::size_t x = 0; x < map.x_labels.size(); ++x) {
      const double left = area.left + static_cast<double>(x) * cell_width;
      AddHeatCell(figure, map, range, x, y, {left, bottom - kHeatRow, left + cell_width, bottom});
    }
  }
  const auto every = static_cast<std::size_t>(std::ceil(kHeatLabelSpace / cell_width));
  for (std::size_t x = 0; x < map.x_labels.size(); x += every) {
    figure.Text({area.left + (static_cast<double>(x) + 0.5) * cell_width,
                 area.bottom + kHeatLayout.tick_drop},
                Anchor::kMiddle,
                FittedText(map.x_labels[x], static_cast<double>(every) * cell_width));
  }
  figure.Text({area.centre().x, figure.height_px - 8.0}, Anchor::kMiddle, map.x_name, {"name"});
  return SvgOf(figure);
}

std::string ParallelSvg(const std::vector<ChartAxis>& axes, const std::vector<ChartPoint>& points) {
  const auto distances = static_cast<double>(std::max<std::size_t>(axes.size(), 2)) - 1.0;
  Figure figure{
      kAxesLayout.left + kAxisDistance * distances + kAxesLayout.right,
      kAxesLayout.top + kAxisHeight + kAxesLayout.bottom, "parallel",
      fmt::format("{} points as lines over {} settings and scores", points.size(), axes.size())};
  const FigureBox area = figure.Inside(kAxesLayout);
  const auto x_of = [&](std::size_t axis) {
    return area.left + kAxisDistance * static_cast<double>(axis);
  };
  for (std::size_t i = points.size(); i-- > 0;) {  // the best last, over the others
    std::vector<FigurePoint> way;
    for (std::size_t a = 0; a < axes.size(); ++a) {
      const double place = points[i].places[a];
      if (!std::isnan(place)) way.push_back({x_of(a), area.bottom - place * kAxisHeight});
    }
    figure.Path(way, InkOfPoint(i, points[i].css()));
  }
  for (std::size_t a = 0; a < axes.size(); ++a) {
    AddAxis(figure, axes[a], a, {x_of(a), area.bottom}, {x_of(a), area.top});
  }
  return SvgOf(figure);
}

}  // namespace gauntlet::sim
