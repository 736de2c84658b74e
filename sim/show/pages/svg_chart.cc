#include "sim/show/pages/svg_chart.h"

#include <fmt/format.h>

#include <algorithm>

#include "sim/show/figure/palette.h"
#include "sim/show/figure/panel.h"
#include "sim/show/pages/curve_codec.h"

namespace gauntlet::sim {
namespace {

constexpr std::size_t kChartColours = 4;
constexpr double kChartLetters = 13.0;
constexpr FigureLayout kChartLayout = {
    .name_drop = 36.0, .left = 62.0, .top = 52.0, .bottom = 44.0};
constexpr FigurePoint kTitle = {kChartLayout.left, 18.0};
constexpr double kLegendBaseline = 40.0;
constexpr double kLegendMark = 16.0;   // width
constexpr double kLegendGap = 6.0;     // between mark and name
constexpr double kLegendSpace = 18.0;  // between two entries

constexpr const char* kChartStyle = R"(<style>
.ground{fill:#fff}text{fill:#5b6675}.grid{stroke:#dfe3e9}.axis{stroke:#a3acb8}
.line{fill:none;stroke-linejoin:round}
.bar{fill:#9db8dd}
.ink,.name,.title{fill:#1b2330}
@media (prefers-color-scheme:dark){.ground{fill:#12161c}text{fill:#98a3b2}.grid{stroke:#2b333f}
.axis{stroke:#5d6978}.bar{fill:#3d5a86}
.ink,.name,.title{fill:#e6eaf0}}
text{font:13px system-ui,"DejaVu Sans",sans-serif}.title{font-size:14px;font-weight:600}
)";

/// Without CSS variables, which some programs that show SVG do not know.
std::string StyleOfCurves() {
  std::string light, dark;
  const auto add = [&](const std::string& css, const Shade& shade) {
    light += fmt::format(".line.{}{{stroke:#{:06x}}}", css, shade.light);
    dark += fmt::format(".line.{}{{stroke:#{:06x}}}", css, shade.dark);
  };
  add("command", palette::kCommand);
  add("s0", palette::kGlove);
  for (std::size_t i = 1; i < kChartColours; ++i) add(fmt::format("s{}", i), palette::kSeries[i]);
  return light + "@media (prefers-color-scheme:dark){" + dark + "}</style>";
}

/// Ranges of both axes over all bars and curves.
std::pair<Extent, Extent> RangesOf(const Chart& chart) {
  Extent x, y;
  for (const ChartCurve& curve : chart.curves) {
    if (curve.values.empty()) continue;  // only takes a colour
    x.Include(curve.first_x);
    x.Include(curve.first_x + curve.step_x * (curve.values.size() - 1));
    for (const double value : curve.values) y.Include(value);
  }
  for (const ChartBars& bars : chart.bars) {
    x.Include(bars.first_x - 0.5 * bars.step_x);
    x.Include(bars.first_x + bars.step_x * (bars.heights.size() - 0.5));
    y.Include(0.0);
    for (const double height : bars.heights) y.Include(height);
  }
  constexpr double kFreeShare = 0.05;
  if (chart.bars.empty()) {
    y.Widen(kFreeShare);
  } else {
    y.high += kFreeShare * (y.high - y.low);
  }
  return {x, y};
}

std::vector<FigurePoint> PointsOf(const ChartCurve& curve, const Panel& panel, int width_px) {
  const int per_column = std::max(1, static_cast<int>(curve.values.size()) / width_px);
  const std::vector<double> values = KeepPeaks(curve.values, per_column);
  const double step = curve.step_x * per_column / (per_column == 1 ? 1.0 : 2.0);
  std::vector<FigurePoint> points;
  for (std::size_t i = 0; i < values.size(); ++i) {
    points.push_back(panel.At(curve.first_x + step * i, values[i]));
  }
  return points;
}

/// Adds the entry of one mark at `x`; returns the place of the next entry.
template <class AddMark>
double AddLegend(Figure& figure, double x, const std::string& name, const AddMark& add_mark) {
  if (name.empty()) return x;
  add_mark(FigureBox{x, kLegendBaseline - 9.0, x + kLegendMark, kLegendBaseline + 1.0});
  figure.Text({x + kLegendMark + kLegendGap, kLegendBaseline}, Anchor::kStart, name, {"ink"});
  return x + kLegendMark + kLegendGap + TextWidth(name, kChartLetters) + kLegendSpace;
}

}  // namespace

std::string SvgChart(const Chart& chart) {
  const auto [x, y] = RangesOf(chart);
  const double width = chart.width_px, height = chart.height_px;
  Figure figure{width, height, "chart", chart.title};
  figure.Box({0.0, 0.0}, {width, height}, {"ground"});
  figure.Text(kTitle, Anchor::kStart, chart.title, {"title"});
  const Panel panel(figure.Inside(kChartLayout), {x, chart.x_label, 8},
                    {y, chart.y_label, 5, true});
  panel.AddAxes(figure, kChartLayout);
  double legend_x = kChartLayout.left;
  for (const ChartBars& bars : chart.bars) {
    for (std::size_t i = 0; i < bars.heights.size(); ++i) {
      const double centre = bars.first_x + bars.step_x * i, half = 0.45 * bars.step_x;
      figure.Box(panel.At(centre - half, bars.heights[i]), panel.At(centre + half, 0.0), {"bar"});
    }
    legend_x = AddLegend(figure, legend_x, bars.name, [&](const FigureBox& place) {
      figure.Box({place.left, place.top}, {place.right, place.bottom}, {"bar"});
    });
  }
  for (std::size_t i = 0; i < chart.curves.size(); ++i) {
    const Ink ink = {.css = chart.curves[i].is_command ? "line command"
                                                       : fmt::format("line s{}", i % kChartColours),
                     .attributes = fmt::format(" stroke-width=\"{:g}\"", chart.curves[i].width_px)};
    figure.Path(PointsOf(chart.curves[i], panel, chart.width_px), ink);
    legend_x = AddLegend(figure, legend_x, chart.curves[i].name, [&](const FigureBox& place) {
      const double middle = place.centre().y;
      figure.Line({place.left, middle}, {place.right, middle}, ink);
    });
  }
  return SvgOf(figure, kChartStyle + StyleOfCurves());
}

}  // namespace gauntlet::sim
