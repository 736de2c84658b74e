#include "sim/show/pages/controllers_front.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>
#include <string_view>
#include <tuple>

#include "sim/results/table_text.h"
#include "sim/show/figure/palette.h"
#include "sim/show/figure/panel.h"

namespace gauntlet::sim {
namespace {

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
