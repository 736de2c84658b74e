#include "sim/show/pages/front_chart.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numeric>
#include <string_view>
#include <tuple>

#include "sim/results/table_text.h"
#include "sim/show/figure/palette.h"
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

constexpr double kPointRadius = 6.0;   // radius
constexpr double kNameLetters = 13.0;  // of the names

struct FrontPoint {
  std::size_t series;
  std::string name;
  double delay_ms;
  double jitter_deg;
};

std::vector<FrontPoint> PointsOf(const Summary& summary) {
  const std::size_t delay = MetricIndex("delay_ms"), jitter = MetricIndex("jitter_rms_deg");
  const auto series = SeriesOf(summary.answer.order, summary.baseline);
  std::vector<FrontPoint> points;
  for (std::size_t c = 0; c < summary.controllers.size(); ++c) {
    const auto& [name, scores] =
        std::tie(summary.controllers[c].name, summary.controllers[c].summary);
    if (!std::isfinite(scores[delay].mean) || !std::isfinite(scores[jitter].mean)) continue;
    points.push_back({series[c], name, scores[delay].mean, scores[jitter].mean});
  }
  return points;
}

/// Place of a name beside its point.
struct NameChoice {
  FigurePoint offset;
  Anchor anchor;
};
constexpr NameChoice kNameChoices[] = {{{12, 4}, Anchor::kStart},   {{-12, 4}, Anchor::kEnd},
                                       {{12, -12}, Anchor::kStart}, {{-12, -12}, Anchor::kEnd},
                                       {{12, 20}, Anchor::kStart},  {{-12, 20}, Anchor::kEnd},
                                       {{0, -16}, Anchor::kMiddle}, {{0, 26}, Anchor::kMiddle}};

/// Adds names where they cover no other name and no point: the first free of eight places.
void AddNames(Figure& figure, const FigureBox& area, const std::vector<FrontPoint>& points,
              const std::vector<FigurePoint>& places) {
  constexpr double kReach = kPointRadius + 1.0;
  std::vector<FigureBox> taken;
  for (const auto& [x, y] : places) {
    taken.push_back({x - kReach, y - kReach, x + kReach, y + kReach});
  }
  std::vector<std::size_t> longest_first(points.size());  // it has the fewest free places
  std::iota(longest_first.begin(), longest_first.end(), std::size_t{0});
  std::ranges::stable_sort(longest_first, std::ranges::greater(),
                           [&](std::size_t i) { return points[i].name.size(); });
  for (const std::size_t i : longest_first) {
    const double width = TextWidth(points[i].name, kNameLetters);
    const auto box_of = [&](const NameChoice& choice) {
      const double left =
          places[i].x + choice.offset.x - 0.5 * width * static_cast<int>(choice.anchor);
      const double baseline = places[i].y + choice.offset.y;
      return FigureBox{left, baseline - 12.0, left + width, baseline + 4.0};
    };
    const auto faults =
        [&](const NameChoice& choice) {  // outside counts more than over another name
          const FigureBox box = box_of(choice);
          const bool outside = box.left < area.left || box.right > area.right + kPointRadius ||
                               box.top < 0.0 || box.bottom > area.bottom;
          const bool covered =
              std::ranges::any_of(taken, [&](const FigureBox& other) { return box.Meets(other); });
          return 2 * outside + covered;
        };
    const NameChoice& choice = *std::ranges::min_element(kNameChoices, {}, faults);
    taken.push_back(box_of(choice));
    figure.Text({places[i].x + choice.offset.x, places[i].y + choice.offset.y}, choice.anchor,
                points[i].name, {"label"});
  }
}

std::string SaidOf(const std::vector<FrontPoint>& points) {
  std::string said = "Jitter against delay.";
  for (const FrontPoint& point : points) {
    said += fmt::format(" {}: {} ms, {} deg;", point.name, Short(point.delay_ms),
                        Short(point.jitter_deg));
  }
  return said;
}

/// The rules of assets/page.css for this figure.
constexpr const char* kFileStyle = R"(svg{background:var(--ground)}
text{fill:var(--muted);font:12.5px system-ui,"DejaVu Sans",sans-serif}
.grid{stroke:var(--line)}.axis{stroke:var(--muted)}
.point{fill:var(--series);stroke:var(--ground);stroke-width:1.5}
.label{fill:var(--ink);font-size:13px;font-weight:500}
)";

std::string FrontOf(const std::vector<FrontPoint>& points, const char* kind, double width_px,
                    double height_px, std::string_view style_sheet = {}) {
  Figure figure{width_px, height_px, kind, SaidOf(points)};
  Extent delay = {0.0, 1.0}, jitter = {0.0, 1e-3};  // at least
  for (const FrontPoint& point : points) {
    delay.Include(1.3 * point.delay_ms);  // with place for a name
    jitter.Include(1.15 * point.jitter_deg);
  }
  const Panel panel(figure.Inside(), {delay, "delay, ms", width_px < 500.0 ? 5 : 9},
                    {jitter, "jitter, deg RMS", 5, true});
  panel.AddAxes(figure);
  std::vector<FigurePoint> places;
  for (const FrontPoint& point : points) {
    places.push_back(panel.At(point.delay_ms, point.jitter_deg));
    figure.Dot(places.back(), kPointRadius, InkOfSeries(point.series, "point"));
  }
  AddNames(figure, panel.area(), points, places);
  return SvgOf(figure, style_sheet);
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

std::string ControllersFront(const Summary& summary) {
  const std::vector<FrontPoint> points = PointsOf(summary);
  if (points.empty()) {
    return "<p class=\"note\">The wearer did not move, so there is no delay to draw.</p>\n";
  }
  return FrontOf(points, "wide", 640.0, 320.0) + FrontOf(points, "narrow", 360.0, 215.0) +
         "<p class=\"note small\">Nearer to the lower left corner is better. The delay contains "
         "glove, "
         "servos and cables.</p>\n";
}

std::string ControllersFrontFile(const Summary& summary) {
  const std::vector<FrontPoint> points = PointsOf(summary);
  if (points.empty()) return {};
  return FrontOf(points, "wide", 640.0, 320.0,
                 fmt::format("<style>{}{}</style>", PaletteCss(), kFileStyle));
}

}  // namespace gauntlet::sim
