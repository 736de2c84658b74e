#include "sim/report/front_chart.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "sim/base/chart_scale.h"
#include "sim/report/drawing.h"
#include "sim/results/html_text.h"

namespace gauntlet::sim {
namespace {

/// Axes of jitter against delay: ticks, lines and names, from (left, top) to (right, bottom).
class FrontAxes {
 public:
  FrontAxes(const Extent& delay, const Extent& jitter, double right, double bottom)
      : delay_(delay), jitter_(jitter), right_(right), bottom_(bottom) {
    jitter_.Take(0.0);
    const double margin = std::max(0.05 * (delay.high - delay.low), 1.0);
    delay_ = {delay.low - margin, delay.high + margin};
    jitter_.high *= 1.05;
  }

  double X(double delay_ms) const { return kLeft + delay_.Share(delay_ms) * (right_ - kLeft); }
  double Y(double jitter_deg) const {
    return bottom_ - jitter_.Share(jitter_deg) * (bottom_ - kTop);
  }
  double right() const { return right_; }
  double bottom() const { return bottom_; }

  void DrawOn(Drawing& drawing) const {
    for (const double tick : Ticks(jitter_, TickStep(jitter_, 5))) {
      drawing.Line(kLeft, Y(tick), right_, Y(tick), "grid");
      drawing.Text(kLeft - 8.0, Y(tick) + 4.0, "end", fmt::format("{:.3g}", tick));
    }
    for (const double tick : Ticks(delay_, TickStep(delay_, 6))) {
      drawing.Text(X(tick), bottom_ + 18.0, "middle", fmt::format("{:.4g}", tick));
    }
    drawing.Text(0.5 * (kLeft + right_ + 12.0), bottom_ + 40.0, "middle", "delay, ms", "name");
    drawing.Add(
        "<text class=\"name\" text-anchor=\"middle\" transform=\"translate(13 {:.0f}) "
        "rotate(-90)\">jitter, deg RMS</text>",
        0.5 * bottom_);
  }

  static constexpr double kLeft = 58.0, kTop = 12.0;

 private:
  Extent delay_, jitter_;
  double right_, bottom_;
};

/// Where the answers are, and as much again: the ends of fronts would leave them no room. All where
/// there are no answers.
class PartInSight {
 public:
  explicit PartInSight(const std::vector<FrontSeries>& series) {
    Extent delay, jitter;
    for (const FrontSeries& one : series) {
      if (!one.answer) continue;
      delay.Take(one.answer->delay_ms);
      jitter.Take(one.answer->jitter_deg);
    }
    if (!std::isfinite(delay.low)) return;
    most_delay_ms_ = delay.high + std::max(delay.high - delay.low, 20.0);
    most_jitter_deg_ = 2.0 * jitter.high;
  }
  bool Has(const FrontSeries::Place& place) const {
    return place.delay_ms <= most_delay_ms_ && place.jitter_deg <= most_jitter_deg_;
  }

 private:
  double most_delay_ms_ = std::numeric_limits<double>::infinity();
  double most_jitter_deg_ = std::numeric_limits<double>::infinity();
};

}  // namespace

std::string FrontSvg(const std::vector<ChartPoint>& points) {
  constexpr double kWidth = 460.0, kHeight = 320.0;
  Extent delay, jitter;
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!std::isfinite(points[i].delay_ms) || !std::isfinite(points[i].jitter_deg)) continue;
    order.push_back(i);
    delay.Take(points[i].delay_ms);
    jitter.Take(points[i].jitter_deg);
  }
  if (order.empty()) return "";
  const FrontAxes axes(delay, jitter, kWidth - 12.0, kHeight - 46.0);
  Drawing drawing(kWidth, kHeight, "front", "Jitter against delay");
  axes.DrawOn(drawing);
  std::ranges::stable_sort(order, [&](std::size_t a, std::size_t b) {
    return std::pair(points[a].delay_ms, points[a].jitter_deg) <
           std::pair(points[b].delay_ms, points[b].jitter_deg);
  });
  std::string way;
  double least = std::numeric_limits<double>::infinity();
  for (const std::size_t i : order) {
    if (points[i].jitter_deg >= least) continue;
    least = points[i].jitter_deg;
    way += fmt::format("{}{:.1f} {:.1f}", way.empty() ? "M" : "L", axes.X(points[i].delay_ms),
                       axes.Y(points[i].jitter_deg));
  }
  drawing.Add("<path class=\"front-line\" d=\"{}\"/>", way);
  std::ranges::sort(order, std::greater<>());  // the best last, over the others
  for (const std::size_t i : order) {
    drawing.Add("<circle data-point=\"{}\" class=\"{}\" cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"4.5\"/>", i,
                points[i].faint ? "faint" : (points[i].good ? "good" : ""),
                axes.X(points[i].delay_ms), axes.Y(points[i].jitter_deg));
  }
  return drawing.Done();
}

std::string FrontsSvg(const std::vector<FrontSeries>& series, double most_delay_ms,
                      double most_jitter_deg) {
  constexpr double kWidth = 760.0, kLegend = 190.0, kEach = 20.0;
  constexpr std::size_t kColours = 8;
  const double height = std::max(420.0, 40.0 + kEach * static_cast<double>(series.size()));
  const PartInSight part(series);
  Extent delay, jitter;
  for (const FrontSeries& one : series) {
    for (const FrontSeries::Place& place : one.front) {
      if (!part.Has(place)) continue;
      delay.Take(place.delay_ms);
      jitter.Take(place.jitter_deg);
    }
  }
  if (!std::isfinite(delay.low)) return "";
  const FrontAxes axes(delay, jitter, kWidth - kLegend - 12.0, height - 46.0);
  Drawing drawing(kWidth, height, "fronts", "Jitter against delay of each kind of filter");
  axes.DrawOn(drawing);
  if (most_jitter_deg < jitter.high) {
    drawing.Line(axes.kLeft, axes.Y(most_jitter_deg), axes.right(), axes.Y(most_jitter_deg),
                 "bound");
  }
  if (most_delay_ms > delay.low && most_delay_ms < delay.high) {
    drawing.Line(axes.X(most_delay_ms), axes.kTop, axes.X(most_delay_ms), axes.bottom(), "bound");
  }
  for (std::size_t i = series.size(); i-- > 0;) {  // the best last, over the others
    const FrontSeries& one = series[i];
    const std::string style =
        fmt::format("series-{}{}", i % kColours, i < kColours ? "" : " dashed");
    std::string way;
    for (const FrontSeries::Place& place : one.front) {
      if (!part.Has(place)) continue;
      way += fmt::format("{}{:.1f} {:.1f}", way.empty() ? "M" : "L", axes.X(place.delay_ms),
                         axes.Y(place.jitter_deg));
    }
    drawing.Add("<g class=\"{}\"><title>{}</title><path d=\"{}\"/>", style, EscapeHtml(one.name),
                way);
    const auto mark = [&](const FrontSeries::Place& place, std::string_view kind, double radius) {
      const std::string point =
          place.point == kNoPoint ? "" : fmt::format(" data-point=\"{}\"", place.point);
      drawing.Add("<circle{} class=\"{}\" cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"{}\"/>", point, kind,
                  axes.X(place.delay_ms), axes.Y(place.jitter_deg), radius);
    };
    for (const FrontSeries::Place& place : one.front) {
      if (part.Has(place)) mark(place, "place", 2.5);
    }
    if (one.answer) mark(*one.answer, "answer", 6.0);
    const double y = axes.kTop + 10.0 + kEach * static_cast<double>(i);
    const double x = kWidth - kLegend + 8.0;
    drawing.Add("<path d=\"M{0:.1f} {2:.1f}L{1:.1f} {2:.1f}\"/>", x, x + 26.0, y);
    if (one.answer) {
      drawing.Add("<circle class=\"answer\" cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"5\"/>", x + 13.0, y);
    }
    drawing.Add("</g>");
    drawing.Text(x + 34.0, y + 4.0, "start", one.name);
  }
  return drawing.Done();
}

}  // namespace gauntlet::sim
