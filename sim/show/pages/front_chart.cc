#include "sim/show/pages/front_chart.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "sim/show/figure/panel.h"

namespace gauntlet::sim {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kDot = 4.5;  // radius
constexpr double kLegendWidth = 190.0;
constexpr double kLegendLine = 20.0;  // from one entry to the next
constexpr double kLineMark = 26.0;    // width
constexpr std::size_t kColours = 8;

/// Axes of jitter against delay.
Panel FrontPanel(const FigureBox& area, const Extent& delay, const Extent& jitter) {
  const double margin = std::max(0.05 * (delay.high - delay.low), 1.0);
  return {area,
          {{delay.low - margin, delay.high + margin}, "delay, ms", 6},
          {{std::min(jitter.low, 0.0), 1.05 * jitter.high}, "jitter, deg RMS", 5, true}};
}

/// Drawn part of the fronts: the answers, and as much space again. Everything if there are no
/// answers.
class PartInSight {
 public:
  explicit PartInSight(const std::vector<FrontSeries>& series) {
    Extent delay, jitter;
    for (const FrontSeries& one : series) {
      if (!one.answer) continue;
      delay.Include(one.answer->delay_ms);
      jitter.Include(one.answer->jitter_deg);
    }
    if (!std::isfinite(delay.low)) return;
    most_delay_ms_ = delay.high + std::max(delay.high - delay.low, 20.0);
    most_jitter_deg_ = 2.0 * jitter.high;
  }
  std::vector<FrontSeries::Place> Of(const FrontSeries& series) const {
    std::vector<FrontSeries::Place> places;
    std::ranges::copy_if(series.front, std::back_inserter(places), [&](const auto& place) {
      return place.delay_ms <= most_delay_ms_ && place.jitter_deg <= most_jitter_deg_;
    });
    return places;
  }

 private:
  double most_delay_ms_ = kInfinity;
  double most_jitter_deg_ = kInfinity;
};

/// Points that no other point beats in both scores, by delay. `order` is sorted by delay.
std::vector<FigurePoint> LowerLeftEdge(const std::vector<ChartPoint>& points,
                                       const std::vector<std::size_t>& order, const Panel& panel) {
  std::vector<FigurePoint> edge;
  double least = kInfinity;
  for (const std::size_t i : order) {
    if (points[i].jitter_deg >= least) continue;
    least = points[i].jitter_deg;
    edge.push_back(panel.At(points[i].delay_ms, least));
  }
  return edge;
}

void AddSeries(Figure& figure, const Panel& panel, const FrontSeries& series,
               const std::vector<FrontSeries::Place>& places, const std::string& css,
               FigurePoint legend) {
  const auto add = [&](const FrontSeries::Place& place, const char* kind, double radius) {
    const std::string all = fmt::format("{} {}", kind, css);
    Ink ink = place.point == kNoPoint ? Ink{all} : InkOfPoint(place.point, all);
    ink.said = series.name;
    figure.Dot(panel.At(place.delay_ms, place.jitter_deg), radius, ink);
  };
  std::vector<FigurePoint> way;
  for (const auto& place : places) way.push_back(panel.At(place.delay_ms, place.jitter_deg));
  figure.Path(way, {.css = css, .said = series.name});
  for (const FrontSeries::Place& place : places) add(place, "place", 2.5);
  if (series.answer) add(*series.answer, "answer", 6.0);
  figure.Line(legend, {legend.x + kLineMark, legend.y}, {css});
  if (series.answer) figure.Dot({legend.x + 0.5 * kLineMark, legend.y}, 5.0, {"answer " + css});
  figure.Text({legend.x + kLineMark + 8.0, legend.y + kFigureLayout.baseline}, Anchor::kStart,
              series.name);
}

}  // namespace

std::string FrontSvg(const std::vector<ChartPoint>& points) {
  Extent delay, jitter;
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!std::isfinite(points[i].delay_ms) || !std::isfinite(points[i].jitter_deg)) continue;
    order.push_back(i);
    delay.Include(points[i].delay_ms);
    jitter.Include(points[i].jitter_deg);
  }
  if (order.empty()) return "";
  Figure figure{460.0, 320.0, "front", "Jitter against delay"};
  const Panel panel = FrontPanel(figure.Inside(), delay, jitter);
  panel.AddAxes(figure);
  std::ranges::stable_sort(order, {}, [&](std::size_t i) {
    return std::pair(points[i].delay_ms, points[i].jitter_deg);
  });
  figure.Path(LowerLeftEdge(points, order, panel), {"front-line"});
  std::ranges::sort(order, std::greater<>());  // the best last, over the others
  for (const std::size_t i : order) {
    figure.Dot(panel.At(points[i].delay_ms, points[i].jitter_deg), kDot,
               InkOfPoint(i, points[i].css()));
  }
  return SvgOf(figure);
}

std::string FrontsSvg(const std::vector<FrontSeries>& series, double most_delay_ms,
                      double most_jitter_deg) {
  const double height = std::max(420.0, 40.0 + kLegendLine * static_cast<double>(series.size()));
  const PartInSight part(series);
  Extent delay, jitter;
  for (const FrontSeries& one : series) {
    for (const FrontSeries::Place& place : part.Of(one)) {
      delay.Include(place.delay_ms);
      jitter.Include(place.jitter_deg);
    }
  }
  if (!std::isfinite(delay.low)) return "";
  Figure figure{760.0, height, "fronts", "Jitter against delay of each kind of filter"};
  FigureBox area = figure.Inside();
  area.right -= kLegendWidth;
  const Panel panel = FrontPanel(area, delay, jitter);
  panel.AddAxes(figure);
  if (most_jitter_deg < jitter.high) {
    const double y = panel.Y(most_jitter_deg);
    figure.Line({area.left, y}, {area.right, y}, {"bound"});
  }
  if (most_delay_ms > delay.low && most_delay_ms < delay.high) {
    const double x = panel.X(most_delay_ms);
    figure.Line({x, area.top}, {x, area.bottom}, {"bound"});
  }
  for (std::size_t i = series.size(); i-- > 0;) {  // the best last, over the others
    AddSeries(figure, panel, series[i], part.Of(series[i]),
              fmt::format("series-{}{}", i % kColours, i < kColours ? "" : " dashed"),
              {area.right + 20.0, area.top + 10.0 + kLegendLine * static_cast<double>(i)});
  }
  return SvgOf(figure);
}

}  // namespace gauntlet::sim
