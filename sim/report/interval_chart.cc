#include "sim/report/interval_chart.h"

#include <algorithm>
#include <cmath>

#include "sim/base/chart_scale.h"
#include "sim/report/drawing.h"
#include "sim/results/html_text.h"
#include "sim/results/table_text.h"
#include "sim/robust/robust_tables.h"
#include "sim/statistics/result_cells.h"

namespace gauntlet::sim {

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
