#include "sim/report/cells_chart.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <iterator>
#include <limits>
#include <numeric>

#include "sim/base/chart_scale.h"
#include "sim/report/html_text.h"
#include "sim/report/table_text.h"

namespace gauntlet::sim {
namespace {

constexpr double kNoPlace = std::numeric_limits<double>::quiet_NaN();

/// Text of one drawing.
class Drawing {
 public:
  Drawing(double width, double height, std::string_view kind, const std::string& said) {
    Add("<svg class=\"{0}\" style=\"--natural: {1:g}px\" viewBox=\"0 0 {1:g} {2:g}\" role=\"img\" "
        "aria-label=\"{3}\">",
        kind, width, height, EscapeHtml(said));
  }
  template <class... Values>
  void Add(fmt::format_string<Values...> format, Values&&... values) {
    fmt::format_to(std::back_inserter(out_), format, std::forward<Values>(values)...);
  }
  void Text(double x, double y, std::string_view anchor, const std::string& text,
            std::string_view style = "") {
    Add("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"{}\" class=\"{}\">{}</text>", x, y, anchor,
        style, EscapeHtml(text));
  }
  void Line(double x1, double y1, double x2, double y2, std::string_view style) {
    Add("<line x1=\"{:.1f}\" y1=\"{:.1f}\" x2=\"{:.1f}\" y2=\"{:.1f}\" class=\"{}\"/>", x1, y1, x2,
        y2, style);
  }
  std::string Done() { return fmt::to_string(out_) + "</svg>\n"; }

 private:
  fmt::memory_buffer out_;
};

/// Not longer than a label may be.
std::string Shortened(const std::string& text, std::size_t most) {
  return text.size() <= most ? text : text.substr(0, most - 1) + "…";
}

}  // namespace

double ChartAxis::PlaceOf(double value) const {
  if (!(high > low)) return 0.5;
  const double place =
      log ? std::log(value / low) / std::log(high / low) : (value - low) / (high - low);
  return std::isfinite(place) ? std::clamp(place, 0.0, 1.0) : kNoPlace;
}

double ChartAxis::PlaceOf(const std::string& value) const {
  if (!labels.empty()) {
    const auto found = std::ranges::find(labels, value);
    if (found == labels.end()) return kNoPlace;
    const auto item = static_cast<double>(found - labels.begin());
    return labels.size() < 2 ? 0.5 : item / (static_cast<double>(labels.size()) - 1.0);
  }
  double number = kNoPlace;
  std::from_chars(value.data(), value.data() + value.size(), number);
  return PlaceOf(number);
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

std::string ResponseSvg(const Response& response, std::size_t metric, const std::string& setting) {
  constexpr double kWidth = 520.0, kHeight = 300.0, kLeft = 58.0, kRight = 14.0, kBottom = 46.0;
  const Metric& score = Metrics()[response.metrics[metric]];
  const std::size_t controllers = response.controllers.size();
  const double top = 16.0 + 18.0 * std::ceil(0.5 * static_cast<double>(controllers));
  Extent x_range, y_range;
  y_range.Take(0.0);
  for (std::size_t v = 0; v < response.values.size(); ++v) {
    x_range.Take(response.values[v]);
    for (const auto& scores : response.scores[v]) {
      for (const double value : {scores[metric].mean, scores[metric].low, scores[metric].high})
        y_range.Take(value);
    }
  }
  const double margin = 0.04 * (y_range.high - y_range.low);
  y_range = {y_range.low - (y_range.low < 0.0 ? margin : 0.0), y_range.high + margin};
  const auto x_of = [&](double value) {
    return kLeft + x_range.Share(value) * (kWidth - kLeft - kRight);
  };
  const auto y_of = [&](double value) {
    return kHeight - kBottom - y_range.Share(value) * (kHeight - kBottom - top);
  };
  Drawing drawing(kWidth, kHeight, "response", fmt::format("{} over {}", score.key, setting));
  for (const double tick : Ticks(y_range, TickStep(y_range, 5))) {
    drawing.Line(kLeft, y_of(tick), kWidth - kRight, y_of(tick), tick == 0.0 ? "axis" : "grid");
    drawing.Text(kLeft - 8.0, y_of(tick) + 4.0, "end", fmt::format("{:.3g}", tick));
  }
  for (const double tick : Ticks(x_range, TickStep(x_range, 6))) {
    drawing.Text(x_of(tick), kHeight - kBottom + 18.0, "middle", fmt::format("{:.4g}", tick));
  }
  drawing.Text(0.5 * (kLeft + kWidth - kRight), kHeight - 6.0, "middle", setting, "name");
  drawing.Add(
      "<text class=\"name\" text-anchor=\"middle\" transform=\"translate(13 {:.0f}) "
      "rotate(-90)\">{}</text>",
      0.5 * (top + kHeight - kBottom), score.key);
  for (std::size_t c = 0; c < controllers; ++c) {
    std::string upper, lower, way;
    std::string dots;
    for (std::size_t v = 0; v < response.values.size(); ++v) {
      const MeanInterval& mean = response.scores[v][c][metric];
      if (!std::isfinite(mean.mean)) continue;
      const double x = x_of(response.values[v]);
      way += fmt::format("{}{:.1f} {:.1f}", way.empty() ? "M" : "L", x, y_of(mean.mean));
      dots += fmt::format(
          "<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"3.5\"><title>{}, {} {}: {}</title></circle>", x,
          y_of(mean.mean), EscapeHtml(response.controllers[c]), EscapeHtml(setting),
          response.texts[v], IntervalText(mean));
      if (!std::isfinite(mean.low) || !std::isfinite(mean.high)) continue;
      upper += fmt::format("{}{:.1f} {:.1f}", upper.empty() ? "M" : "L", x, y_of(mean.high));
      lower = fmt::format("L{:.1f} {:.1f}", x, y_of(mean.low)) + lower;
    }
    drawing.Add("<g style=\"--line-colour: var(--c{})\">", c);
    if (!upper.empty()) drawing.Add("<path class=\"interval\" d=\"{}{}Z\"/>", upper, lower);
    drawing.Add("<path class=\"curve\" d=\"{}\"/>{}", way, dots);
    const double legend_x = kLeft + 230.0 * static_cast<double>(c % 2);
    const double legend_y = 10.0 + 18.0 * std::floor(0.5 * static_cast<double>(c));
    drawing.Add("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"4.5\"/>", legend_x + 5.0, legend_y);
    drawing.Text(legend_x + 16.0, legend_y + 4.0, "start", Shortened(response.controllers[c], 28),
                 "name");
    drawing.Add("</g>");
  }
  return drawing.Done();
}

std::string TornadoSvg(const RobustPlan& plan, const RobustScore& score, double nominal) {
  constexpr double kWidth = 560.0, kLeft = 92.0, kRight = 118.0, kTop = 30.0, kEach = 32.0;
  Extent range;
  range.Take(nominal);
  double matters = 0.0;
  for (const TornadoBar& bar : score.bars) {
    if (!bar.problem.empty()) continue;
    for (const MeanInterval& end : {bar.low, bar.high}) {
      for (const double value : {end.mean, end.low, end.high}) range.Take(value);
    }
    matters = bar.change.relevant_difference;
  }
  range.Take(nominal - matters);
  range.Take(nominal + matters);
  const double margin = 0.04 * (range.high - range.low);
  range = {range.low - margin, range.high + margin};
  const double bottom = kTop + kEach * static_cast<double>(score.bars.size());
  const auto x_of = [&](double value) {
    return kLeft + range.Share(value) * (kWidth - kLeft - kRight);
  };
  const std::string title =
      fmt::format("{} - {}, {}", score.controllers[score.two_best[0]].name,
                  score.controllers[score.two_best[1]].name, Metrics()[score.metric].key);
  Drawing drawing(kWidth, bottom + 46.0, "tornado", "What changes " + title);
  drawing.Add("<rect class=\"band\" x=\"{:.1f}\" y=\"{}\" width=\"{:.1f}\" height=\"{:.1f}\"/>",
              x_of(nominal - matters), kTop - 8.0,
              x_of(nominal + matters) - x_of(nominal - matters), bottom - kTop + 8.0);
  for (const double tick : Ticks(range, TickStep(range, 5))) {
    drawing.Line(x_of(tick), kTop - 8.0, x_of(tick), bottom, tick == 0.0 ? "axis" : "grid");
    drawing.Text(x_of(tick), bottom + 18.0, "middle", fmt::format("{:.3g}", tick));
  }
  drawing.Line(x_of(nominal), kTop - 8.0, x_of(nominal), bottom, "own");
  drawing.Text(x_of(nominal), kTop - 13.0, "middle", "own hand");
  for (std::size_t i = 0; i < score.bars.size(); ++i) {
    const TornadoBar& bar = score.bars[i];
    const double y = kTop + kEach * (static_cast<double>(i) + 0.5);
    drawing.Text(kLeft - 10.0, y + 4.0, "end", plan.parameters[bar.parameter].name, "name");
    if (!bar.problem.empty()) {
      drawing.Text(kLeft, y + 4.0, "start", Shortened(bar.problem, 50));
      continue;
    }
    const double low = x_of(bar.low.mean);
    const double high = x_of(bar.high.mean);
    drawing.Add(
        "<g><title>{}: low {}, high {}, high - low {}</title><rect class=\"bar\" "
        "x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"14\"/></g>",
        plan.parameters[bar.parameter].name, IntervalText(bar.low), IntervalText(bar.high),
        IntervalText(bar.change.difference), std::min(low, high), y - 7.0, std::abs(high - low));
    for (const bool is_high : {false, true}) {
      const MeanInterval& end = is_high ? bar.high : bar.low;
      const double line = y + (is_high ? 3.5 : -3.5);
      if (std::isfinite(end.low))
        drawing.Line(x_of(end.low), line, x_of(end.high), line, "whisker");
      drawing.Add("<circle class=\"{}\" cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"4.5\"/>",
                  is_high ? "high" : "low", x_of(end.mean), line);
    }
    drawing.Text(kWidth - kRight + 8.0, y + 4.0, "start", std::string(TornadoVerdict(bar)),
                 TornadoVerdict(bar) == "matters" ? "matters" : "");
  }
  drawing.Text(0.5 * (kLeft + kWidth - kRight), bottom + 38.0, "middle", title, "name");
  return drawing.Done();
}

}  // namespace gauntlet::sim
