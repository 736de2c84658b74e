#include "sim/report/svg_chart.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>

#include "sim/base/chart_scale.h"
#include "sim/report/curve_codec.h"
#include "sim/results/html_text.h"

namespace gauntlet::sim {
namespace {

constexpr double kLeftPx = 62.0;
constexpr double kRightPx = 14.0;
constexpr double kTopPx = 52.0;
constexpr double kBottomPx = 44.0;
constexpr int kColours = 4;

constexpr const char* kStyle = R"(<style>
.ink{fill:#1b2330}.muted{fill:#5b6675}.ground{fill:#fff}.grid{stroke:#dfe3e9}
.line{fill:none;stroke-linejoin:round}
.s0{stroke:#a3acb8}.s1{stroke:#cc4455}.s2{stroke:#2b6fd1}.s3{stroke:#12866f}.bar{fill:#9db8dd}
@media (prefers-color-scheme:dark){.ink{fill:#e6eaf0}.muted{fill:#98a3b2}.ground{fill:#12161c}
.grid{stroke:#2b333f}.s0{stroke:#5d6978}.s1{stroke:#f07a88}.s2{stroke:#6fa5f2}.s3{stroke:#4cc2a8}
.bar{fill:#3d5a86}}
text{font:13px system-ui,"DejaVu Sans",sans-serif}.title{font-size:14px;font-weight:600}
</style>)";

/// Writes one chart.
class Writer {
 public:
  explicit Writer(const Chart& chart) : chart_(chart) {
    for (const ChartCurve& curve : chart.curves) {
      if (curve.values.empty()) continue;  // only takes a colour
      x_.Take(curve.first_x);
      x_.Take(curve.first_x + curve.step_x * (curve.values.size() - 1));
      for (const double value : curve.values) y_.Take(value);
    }
    for (const ChartBars& bars : chart.bars) {
      x_.Take(bars.first_x - 0.5 * bars.step_x);
      x_.Take(bars.first_x + bars.step_x * (bars.heights.size() - 0.5));
      y_.Take(0.0);
      for (const double height : bars.heights) y_.Take(height);
    }
    if (chart.bars.empty()) {
      y_.Widen(0.05);
    } else {
      y_.high += 0.05 * (y_.high - y_.low);
    }
  }

  std::string Write() {
    Add("<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0} {1}\" width=\"{0}\" "
        "height=\"{1}\" role=\"img\" aria-label=\"{2}\">{3}<rect class=\"ground\" width=\"{0}\" "
        "height=\"{1}\"/>",
        chart_.width_px, chart_.height_px, EscapeHtml(chart_.title), kStyle);
    Text(kLeftPx, 18.0, "ink title", "start", chart_.title);
    Grid();
    for (const ChartBars& bars : chart_.bars) Bars(bars);
    for (std::size_t i = 0; i < chart_.curves.size(); ++i) Curve(chart_.curves[i], i % kColours);
    Legend();
    Text(0.5 * (kLeftPx + chart_.width_px - kRightPx), chart_.height_px - 8.0, "muted", "middle",
         chart_.x_label);
    Add("<text class=\"muted\" text-anchor=\"middle\" transform=\"translate(14 {:.1f}) "
        "rotate(-90)\">{}</text></svg>\n",
        0.5 * (kTopPx + chart_.height_px - kBottomPx), EscapeHtml(chart_.y_label));
    return fmt::to_string(out_);
  }

 private:
  template <class... Values>
  void Add(fmt::format_string<Values...> format, Values&&... values) {
    fmt::format_to(std::back_inserter(out_), format, std::forward<Values>(values)...);
  }
  void Text(double x, double y, const char* style, const char* anchor, const std::string& text) {
    Add("<text x=\"{:.1f}\" y=\"{:.1f}\" class=\"{}\" text-anchor=\"{}\">{}</text>", x, y, style,
        anchor, EscapeHtml(text));
  }
  double X(double value) const {
    return kLeftPx + (value - x_.low) / (x_.high - x_.low) * (chart_.width_px - kLeftPx - kRightPx);
  }
  double Y(double value) const {
    const double bottom = chart_.height_px - kBottomPx;
    return bottom - (value - y_.low) / (y_.high - y_.low) * (bottom - kTopPx);
  }

  void Grid() {
    const double right = chart_.width_px - kRightPx;
    const double y_step = TickStep(y_, 5);
    for (const double tick : Ticks(y_, y_step)) {
      Add("<line class=\"grid\" x1=\"{:.1f}\" x2=\"{:.1f}\" y1=\"{:.1f}\" y2=\"{:.1f}\"/>", kLeftPx,
          right, Y(tick), Y(tick));
      Text(kLeftPx - 6.0, Y(tick) + 4.0, "muted", "end", Number(tick, y_step));
    }
    const double x_step = TickStep(x_, 8);
    for (const double tick : Ticks(x_, x_step)) {
      Text(X(tick), chart_.height_px - kBottomPx + 16.0, "muted", "middle", Number(tick, x_step));
    }
  }
  /// Without the -0 and the many digits of sums of steps.
  static std::string Number(double value, double step) {
    return fmt::format("{:g}", std::round(value / step) * step + 0.0);
  }

  void Bars(const ChartBars& bars) {
    for (std::size_t i = 0; i < bars.heights.size(); ++i) {
      const double centre = bars.first_x + bars.step_x * i;
      const double left = X(centre - 0.45 * bars.step_x);
      const double top = Y(bars.heights[i]);
      Add("<rect class=\"bar\" x=\"{:.2f}\" y=\"{:.2f}\" width=\"{:.2f}\" height=\"{:.2f}\"/>",
          left, top, X(centre + 0.45 * bars.step_x) - left, Y(0.0) - top);
    }
  }

  void Curve(const ChartCurve& curve, std::size_t colour) {
    const int per_column = std::max(1, static_cast<int>(curve.values.size()) / chart_.width_px);
    const std::vector<double> points = KeepPeaks(curve.values, per_column);
    const double points_per_bucket = per_column == 1 ? 1.0 : 2.0;
    const double step = curve.step_x * per_column / points_per_bucket;
    Add("<polyline class=\"line s{}\" stroke-width=\"{:g}\" points=\"", colour, curve.width_px);
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (!std::isfinite(points[i])) continue;
      Add("{:.1f},{:.1f} ", X(curve.first_x + step * i), Y(points[i]));
    }
    Add("\"/>");
  }

  void Legend() {
    double x = kLeftPx;
    const auto entry = [&](const std::string& name, const std::string& mark) {
      if (name.empty()) return;
      Add("{}", mark);
      Text(x + 22.0, 40.0, "ink", "start", name);
      x += 40.0 + 7.4 * name.size();
    };
    for (const ChartBars& bars : chart_.bars) {
      entry(
          bars.name,
          fmt::format("<rect class=\"bar\" x=\"{:.1f}\" y=\"31\" width=\"16\" height=\"10\"/>", x));
    }
    for (std::size_t i = 0; i < chart_.curves.size(); ++i) {
      entry(
          chart_.curves[i].name,
          fmt::format("<line class=\"line s{}\" stroke-width=\"{:g}\" x1=\"{:.1f}\" x2=\"{:.1f}\" "
                      "y1=\"36\" y2=\"36\"/>",
                      i % kColours, chart_.curves[i].width_px, x, x + 16.0));
    }
  }

  const Chart& chart_;
  Extent x_;
  Extent y_;
  fmt::memory_buffer out_;
};

}  // namespace

std::string SvgChart(const Chart& chart) { return Writer(chart).Write(); }

}  // namespace gauntlet::sim
