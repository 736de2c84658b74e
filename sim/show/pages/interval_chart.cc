#include "sim/show/pages/interval_chart.h"

#include <fmt/format.h>

#include <cmath>

#include "sim/answers/robust/robust_tables.h"
#include "sim/score/statistics/result_cells.h"
#include "sim/show/figure/panel.h"

namespace gauntlet::sim {
namespace {

constexpr double kMargin = 0.04;  // of the range, beyond all values

void IncludeInterval(const MeanInterval& interval, Extent& range) {
  for (const double value : {interval.mean, interval.low, interval.high}) range.Include(value);
}

/// The means of one controller as dots and a curve over the band of their intervals.
void AddResponse(Figure& figure, const Panel& panel, const Response& response, std::size_t metric,
                 std::size_t controller, const std::string& setting) {
  std::vector<FigurePoint> curve, band, lower;
  for (std::size_t v = 0; v < response.values.size(); ++v) {
    const MeanInterval& mean = response.scores[v][controller][metric];
    if (!std::isfinite(mean.mean)) continue;
    const double x = response.values[v];
    curve.push_back(panel.At(x, mean.mean));
    if (!std::isfinite(mean.low) || !std::isfinite(mean.high)) continue;
    band.push_back(panel.At(x, mean.high));
    lower.push_back(panel.At(x, mean.low));
  }
  band.insert(band.end(), lower.rbegin(), lower.rend());
  if (!band.empty()) figure.Area(band, InkOfSeries(controller + 1, "interval"));
  figure.Path(curve, InkOfSeries(controller + 1, "curve"));
  auto dot = curve.begin();
  for (std::size_t v = 0; v < response.values.size(); ++v) {
    const MeanInterval& mean = response.scores[v][controller][metric];
    if (!std::isfinite(mean.mean)) continue;
    figure.Dot(*dot++, 3.5,
               InkOfSeries(controller + 1, "",
                           fmt::format("{}, {} {}: {}", response.controllers[controller], setting,
                                       response.texts[v], IntervalText(mean))));
  }
}

/// One parameter: a bar from its low to its high end, each end with an interval, and the verdict.
void AddTornadoBar(Figure& figure, const Panel& panel, const TornadoBar& bar,
                   const std::string& name, double y) {
  const FigureBox& area = panel.area();
  const double baseline = y + kFigureLayout.baseline;
  figure.Text({area.left - 10.0, baseline}, Anchor::kEnd, name, {"name"});
  if (!bar.problem.empty()) {
    const std::string problem = FittedText(bar.problem, figure.width_px - area.left);
    return figure.Text({area.left, baseline}, Anchor::kStart, problem);
  }
  figure.Box({panel.X(bar.low.mean), y - 7.0}, {panel.X(bar.high.mean), y + 7.0},
             {"bar", fmt::format("{}: low {}, high {}, high - low {}", name, IntervalText(bar.low),
                                 IntervalText(bar.high), IntervalText(bar.change.difference))});
  for (const bool is_high : {false, true}) {
    const MeanInterval& end = is_high ? bar.high : bar.low;
    const double line = y + (is_high ? 3.5 : -3.5);
    if (std::isfinite(end.low)) {
      figure.Line({panel.X(end.low), line}, {panel.X(end.high), line}, {"whisker"});
    }
    figure.Dot({panel.X(end.mean), line}, 4.5, {is_high ? "high" : "low"});
  }
  const std::string verdict(TornadoVerdict(bar));
  figure.Text({area.right + 8.0, baseline}, Anchor::kStart, verdict,
              {verdict == "effect" ? verdict : ""});
}

}  // namespace

std::string ResponseSvg(const Response& response, std::size_t metric, const std::string& setting) {
  constexpr double kEntryHeight = 18.0, kEntryWidth = 230.0;
  const std::string score(Metrics()[response.metrics[metric]].key);
  const std::size_t controllers = response.controllers.size();
  Extent x_range, y_range;
  y_range.Include(0.0);
  for (std::size_t v = 0; v < response.values.size(); ++v) {
    x_range.Include(response.values[v]);
    for (const auto& scores : response.scores[v]) IncludeInterval(scores[metric], y_range);
  }
  const double margin = kMargin * (y_range.high - y_range.low);
  y_range = {y_range.low - (y_range.low < 0.0 ? margin : 0.0), y_range.high + margin};
  Figure figure{520.0, 300.0, "response", fmt::format("{} over {}", score, setting)};
  FigureBox area = figure.Inside();
  area.top = 16.0 + kEntryHeight * std::ceil(0.5 * static_cast<double>(controllers));
  const Panel panel(area, {x_range, setting, 6}, {y_range, score, 5, true});
  panel.AddAxes(figure);
  for (std::size_t c = 0; c < controllers; ++c) {
    AddResponse(figure, panel, response, metric, c, setting);
    const double x = area.left + kEntryWidth * static_cast<double>(c % 2);
    const std::size_t line = c / 2;
    const double y = 10.0 + kEntryHeight * static_cast<double>(line);
    figure.Dot({x + 5.0, y}, 4.5, InkOfSeries(c + 1, ""));
    figure.Text({x + 16.0, y + kFigureLayout.baseline}, Anchor::kStart,
                FittedText(response.controllers[c], kEntryWidth - 24.0), {"name"});
  }
  return SvgOf(figure);
}

std::string TornadoSvg(const RobustPlan& plan, const RobustScore& score, double nominal) {
  constexpr double kEach = 32.0, kFirst = 30.0;
  Extent range;
  range.Include(nominal);
  double relevant = 0.0;
  for (const TornadoBar& bar : score.bars) {
    if (!bar.problem.empty()) continue;
    IncludeInterval(bar.low, range);
    IncludeInterval(bar.high, range);
    relevant = bar.change.relevant_difference;
  }
  range.Include(nominal - relevant);
  range.Include(nominal + relevant);
  range.Widen(kMargin);
  const std::string title =
      fmt::format("{} - {}, {}", score.controllers[score.two_best[0]].name,
                  score.controllers[score.two_best[1]].name, Metrics()[score.metric].key);
  const double bottom = kFirst + kEach * static_cast<double>(score.bars.size());
  Figure figure{560.0, bottom + kFigureLayout.bottom, "tornado", "What changes " + title};
  const FigureBox area = {92.0, kFirst - 8.0, figure.width_px - 118.0, bottom};
  const Panel panel(area, {range, title, 5, true}, {});
  figure.Box({panel.X(nominal - relevant), area.top}, {panel.X(nominal + relevant), bottom},
             {"band"});
  panel.AddAxes(figure);
  const double own = panel.X(nominal);
  figure.Line({own, area.top}, {own, bottom}, {"own"});
  figure.Text({own, area.top - 5.0}, Anchor::kMiddle, "nominal hand");
  for (std::size_t i = 0; i < score.bars.size(); ++i) {
    AddTornadoBar(figure, panel, score.bars[i], plan.parameters[score.bars[i].parameter].name,
                  kFirst + kEach * (static_cast<double>(i) + 0.5));
  }
  return SvgOf(figure);
}

}  // namespace gauntlet::sim
