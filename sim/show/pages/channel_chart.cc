#include "sim/show/pages/channel_chart.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "sim/base/signal.h"
#include "sim/base/text.h"
#include "sim/show/figure/panel.h"

namespace gauntlet::sim {
namespace {

constexpr FigureLayout kLayout = {
    .tick_gap = 6.0, .tick_drop = 15.0, .left = 44.0, .top = 26.0, .right = 6.0, .bottom = 20.0};
constexpr double kWidth = 320.0;
constexpr double kHeight = 132.0;

bool HasFinding(const std::vector<HealthFinding>& findings, std::size_t column,
                std::string_view key) {
  return std::ranges::any_of(findings, [&](const HealthFinding& finding) {
    return finding.column == column && finding.key == key;
  });
}

/// Stretches of rows for which `holds`, of at least so many rows.
template <class Holds>
std::vector<RowStretch> Stretches(std::size_t rows, std::size_t fewest, const Holds& holds) {
  std::vector<RowStretch> stretches;
  for (std::size_t first = 0; first < rows; ++first) {
    if (!holds(first)) continue;
    std::size_t last = first;
    while (last + 1 < rows && holds(last + 1)) ++last;
    if (last - first + 1 >= fewest) stretches.push_back({first, last});
    first = last;
  }
  return stretches;
}

/// Rows far from both neighbours, on one side of them, by the limits of ColumnStatistics.
std::vector<std::size_t> SpikesOf(const ColumnStatistics& is, const std::vector<double>& values) {
  constexpr double kFarInNoise = 20.0;
  constexpr double kFarInRange = 0.1;
  constexpr double kBothSides = 0.25;  // a neighbour of a spike is far from one side
  const double far = std::max({kFarInNoise * std::sqrt(6.0) * is.noise, kFarInNoise * is.step,
                               kFarInRange * (is.usual_high - is.usual_low)});
  std::vector<std::size_t> spikes;
  for (std::size_t i = 1; i + 1 < values.size(); ++i) {
    const double from = values[i] - values[i - 1], to = values[i] - values[i + 1];
    const auto [less, more] = std::minmax(std::abs(from), std::abs(to));
    if (from * to > 0.0 && less + more > far && less > kBothSides * more) spikes.push_back(i);
  }
  return spikes;
}

/// The range of the usual values, and beyond it what is not too far to see the rest.
Extent ShownRange(const ColumnStatistics& is) {
  const double range = is.usual_high - is.usual_low;
  Extent shown;
  shown.Include(std::max(is.low, is.usual_low - 2.0 * range));
  shown.Include(std::min(is.high, is.usual_high + 2.0 * range));
  shown.Widen(0.06);
  return shown;
}

/// A curve with the lowest and the highest value of each pixel, interrupted where there is none.
std::vector<FigurePoint> ThinnedCurve(const Panel& panel, const Extent& shown,
                                      const std::vector<double>& times_s,
                                      const std::vector<double>& values,
                                      const std::vector<RowStretch>& gaps) {
  std::vector<FigurePoint> points;
  auto gap = gaps.begin();
  for (std::size_t i = 0; i < values.size();) {
    const double pixel = std::floor(panel.X(times_s[i]));
    std::size_t low = i, high = i;
    std::size_t end = i;
    while (end < values.size() && std::isfinite(values[end]) &&
           std::floor(panel.X(times_s[end])) == pixel &&
           (end == i || gap == gaps.end() || gap->last != end)) {
      if (values[end] < values[low]) low = end;
      if (values[end] > values[high]) high = end;
      ++end;
    }
    if (end == i) {  // no value
      points.push_back({kNaN, kNaN});
      ++i;
      continue;
    }
    for (const std::size_t row : {std::min(low, high), std::max(low, high)}) {
      points.push_back(panel.At(times_s[row], std::clamp(values[row], shown.low, shown.high)));
      if (low == high) break;
    }
    if (gap != gaps.end() && gap->last == end) {
      points.push_back({kNaN, kNaN});
      ++gap;
    }
    i = end;
  }
  return points;
}

/// "dead", "clipped", .. of the worst finding of a column; empty: none.
std::string WorstOf(const std::vector<HealthFinding>& findings, std::size_t column) {
  constexpr std::pair<std::string_view, std::string_view> kWords[] = {
      {"two_senders", "two senders"},
      {"no_movement", "only noise"},
      {"lost", "missing rows"},
      {"missing_code", "missing values"}};
  const auto worst = std::ranges::find(findings, column, &HealthFinding::column);
  if (worst == findings.end()) return "";
  const auto words =
      std::ranges::find(kWords, worst->key, &std::pair<std::string_view, std::string_view>::first);
  return words == std::end(kWords) ? worst->key : std::string(words->second);
}

}  // namespace

DefectMarks FindDefects(const Inspection& inspection, const std::vector<HealthFinding>& findings,
                        std::size_t column) {
  const std::vector<double>& values = inspection.picture_values[column];
  const std::vector<double>& times_s = inspection.picture_time_s;
  const ColumnStatistics& is = inspection.columns[column].statistics;
  DefectMarks marks;
  const std::size_t every = std::max<std::size_t>(1, inspection.rows / values.size());
  constexpr double kGapPerInterval = 5.0;
  const double longest_s = kGapPerInterval * static_cast<double>(every) / inspection.time.rate_hz;
  for (std::size_t i = 1; inspection.has_time && i < times_s.size(); ++i) {
    if (times_s[i] - times_s[i - 1] > longest_s) marks.gaps.push_back({i - 1, i});
  }
  marks.missing =
      Stretches(values.size(), 1, [&](std::size_t i) { return !std::isfinite(values[i]); });
  if (HasFinding(findings, column, "clipped")) {
    constexpr std::size_t kFewest = 2;  // one alone may be the peak of a movement
    for (const double end : {is.low, is.high}) {
      const auto at_end =
          Stretches(values.size(), kFewest, [&](std::size_t i) { return values[i] == end; });
      marks.clipped.insert(marks.clipped.end(), at_end.begin(), at_end.end());
    }
  }
  if (HasFinding(findings, column, "spikes") && values.size() == inspection.rows) {
    marks.spikes = SpikesOf(is, values);
  }
  return marks;
}

Figure ChannelChart(const Inspection& inspection, const std::vector<HealthFinding>& findings,
                    std::size_t column) {
  const InspectedColumn& is = inspection.columns[column];
  const std::vector<double>& values = inspection.picture_values[column];
  const std::vector<double>& times_s = inspection.picture_time_s;
  const std::string own = is.name.empty() ? fmt::format("column {}", column + 1) : OneLine(is.name);
  const std::string worst = WorstOf(findings, column);
  Figure figure{kWidth, kHeight, "channel",
                fmt::format("{} over time{}", is.channel.empty() ? own : is.channel,
                            worst.empty() ? "" : ": " + worst)};
  const Extent shown = ShownRange(is.statistics);
  const Extent times = {.low = 0.0, .high = std::max(times_s.back(), 1e-9)};
  const Panel panel(
      figure.Inside(kLayout), {.range = times, .ticks = 4},
      {.range = shown, .ticks = is.statistics.high > is.statistics.low ? 4 : 2, .lines = true});
  const FigureBox& area = panel.area();
  figure.Box({area.left, area.top}, {area.right, area.bottom}, {"ground"}, 3.0);
  const DefectMarks marks = FindDefects(inspection, findings, column);
  for (const RowStretch& gap : marks.gaps) {
    figure.Box({panel.X(times_s[gap.first]), area.top}, {panel.X(times_s[gap.last]), area.bottom},
               {"gap"});
  }
  panel.AddAxes(figure, kLayout);
  figure.Path(ThinnedCurve(panel, shown, times_s, values, marks.gaps),
              {is.is_dead ? "curve dead" : "curve"});
  constexpr double kShortest = 1.5;  // that is seen
  const auto mark = [&](const RowStretch& stretch, double y, const char* css) {
    const double from = panel.X(times_s[stretch.first]);
    figure.Line({from, y}, {std::max(from + kShortest, panel.X(times_s[stretch.last])), y}, {css});
  };
  for (const RowStretch& stretch : marks.missing) mark(stretch, area.bottom - 1.5, "missing");
  for (const RowStretch& stretch : marks.clipped) {
    mark(stretch, panel.Y(std::clamp(values[stretch.first], shown.low, shown.high)), "clipped");
  }
  for (const std::size_t i : marks.spikes) {
    figure.Dot(panel.At(times_s[i], std::clamp(values[i], shown.low, shown.high)), 4.0, {"spike"});
  }
  constexpr double kNameBaseline = 16.0;
  constexpr double kSpace = 8.0;
  const double worst_width = worst.empty() ? 0.0 : TextWidth(worst) + kSpace;
  const std::string name =
      FittedText(is.channel.empty() ? own : is.channel, area.right - area.left - worst_width);
  figure.Text({area.left, kNameBaseline}, Anchor::kStart, name, {"name"});
  const double behind = area.left + TextWidth(name) + kSpace;
  const double rest = area.right - worst_width - behind;
  if (!is.channel.empty() && is.channel != own && rest > TextWidth("...")) {
    figure.Text({behind, kNameBaseline}, Anchor::kStart, FittedText(own, rest));
  }
  if (!worst.empty()) figure.Text({area.right, kNameBaseline}, Anchor::kEnd, worst, {"bad"});
  return figure;
}

std::string LegendOfMarks(const std::vector<DefectMarks>& marks) {
  const auto item = [&](std::string_view css, std::string_view words, auto member) {
    const bool is_used = std::ranges::any_of(
        marks, [member](const DefectMarks& of) { return !(of.*member).empty(); });
    if (!is_used) return std::string();
    return fmt::format("<span class=\"item\"><span class=\"mark {}\"></span>{}</span>\n", css,
                       words);
  };
  const std::string items = item("clipped", "at an end of its range", &DefectMarks::clipped) +
                            item("missing", "no value", &DefectMarks::missing) +
                            item("spike", "spike", &DefectMarks::spikes) +
                            item("gap", "gap in the time", &DefectMarks::gaps);
  return items.empty() ? "" : "<p class=\"legend\">" + items + "</p>\n";
}

}  // namespace gauntlet::sim
