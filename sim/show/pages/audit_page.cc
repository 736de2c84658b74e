#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>
#include <vector>

#include "controller/calibration/robust_statistics.h"
#include "sim/fit/audit.h"
#include "sim/fit/fit_tables.h"
#include "sim/results/html_text.h"
#include "sim/results/table_text.h"
#include "sim/show/figure/panel.h"
#include "sim/show/pages/cells_chart.h"
#include "sim/show/pages/cells_page.h"
#include "sim/show/pages/pages.h"
#include "sim/show/pages/plain_page.h"
#include "sim/show/pages/svg_chart.h"

namespace gauntlet::sim {
namespace {

constexpr std::size_t kMostColumns = 40;  // of a heat map
constexpr double kLongestShown_s = 10.0;

/// The delay of each part that has one: interval, and the range over stretches behind it.
std::string DelaySvg(const Audit& audit) {
  constexpr double kEach = 26.0, kFirst = 14.0, kLeft = 120.0, kHalfBar = 7.0;
  std::vector<const AuditedPart*> parts;
  Extent range;
  range.Include(0.0);
  for (const AuditedPart& part : audit.parts) {
    if (!part.is_target()) continue;
    parts.push_back(&part);
    range.Include(part.delay_low_ms);
    range.Include(part.delay_high_ms);
    range.Include(part.delay_ms.high);
  }
  if (parts.empty()) return "";
  range.high += 0.06 * (range.high - range.low);
  const double bottom = kFirst + kEach * static_cast<double>(parts.size());
  Figure figure{460.0, bottom + kFigureLayout.bottom, "figure", "Delay of each part"};
  const FigureBox area = {kLeft, kFirst - 6.0, figure.width_px - 14.0, bottom};
  const Panel panel(area, {range, "delay [ms]", 6, true}, {});
  panel.AddAxes(figure);
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const AuditedPart& part = *parts[i];
    const double y = kFirst + kEach * (static_cast<double>(i) + 0.5);
    const std::string said = fmt::format("{}: {:.1f} ms", part.name, part.delay_ms.value);
    figure.Text({kLeft - kFigureLayout.tick_gap, y + kFigureLayout.baseline}, Anchor::kEnd,
                FittedText(part.name, kLeft - 2.0 * kFigureLayout.tick_gap), {"name"});
    figure.Box({panel.X(part.delay_low_ms), y - kHalfBar},
               {panel.X(part.delay_high_ms), y + kHalfBar}, {.css = "band", .said = said}, 3.0);
    figure.Line({panel.X(part.delay_ms.low), y}, {panel.X(part.delay_ms.high), y},
                {.attributes = " style=\"stroke: var(--accent); stroke-width: 2\""});
    figure.Dot({panel.X(part.delay_ms.value), y}, 4.5,
               {.said = said, .attributes = " fill=\"var(--accent)\""});
  }
  return SvgOf(figure);
}

/// A value of each part and episode, coloured by `times_limit` of it; of many episodes, the worst
/// of some that follow each other.
std::string EpisodesSvg(const Audit& audit, double AuditedEpisode::*value, const std::string& name,
                        LimitScale scale, const auto& times_limit) {
  const std::size_t count = audit.episodes.size();
  const std::size_t each = (count + kMostColumns - 1) / kMostColumns;
  HeatMap map{.x_name = each == 1 ? "episode" : fmt::format("episode, {} in a column", each),
              .y_name = "part",
              .score = name,
              .x_labels = {},
              .y_labels = {},
              .best = {},
              .points = {}};
  for (std::size_t e = 0; e < count; e += each) {
    map.x_labels.push_back(fmt::format("{:g}", audit.episodes[e]));
  }
  for (auto part = audit.parts.rbegin(); part != audit.parts.rend(); ++part) {
    if (!part->is_target()) continue;
    map.y_labels.push_back(part->name);
    for (std::size_t e = 0; e < count; e += each) {
      double shown = kNaN, worst = -1.0;
      for (std::size_t i = e; i < std::min(e + each, count); ++i) {
        const double one = part->episodes[i].*value;
        const double times = times_limit(*part, one);
        if (!(times > worst)) continue;
        worst = times;
        shown = one;
      }
      map.best.push_back(shown);
      scale.times_limit.push_back(worst);
      map.points.push_back(kNoPoint);
    }
  }
  map.scale = std::move(scale);
  return map.y_labels.empty() ? "" : HeatMapSvg(map);
}

std::string FigureOf(const Audit& audit, const AuditedPart& part) {
  const FollowRows& rows = part.worst;
  if (rows.command.size() == 0) return "";
  const Eigen::Index count = std::min<Eigen::Index>(
      rows.command.size(), std::lround(kLongestShown_s * part.worst_rate_hz) + 1);
  const auto curve = [&](const std::string& name, const Eigen::VectorXd& values) {
    return ChartCurve{.name = name,
                      .step_x = 1.0 / part.worst_rate_hz,
                      .values = {values.data(), values.data() + count}};
  };
  Chart chart{.title = part.name,
              .x_label = "time [s]",
              .y_label = fmt::format("angle [{}]", part.unit),
              .bars = {},
              .curves = {curve("command", rows.command), curve("measured", rows.angle)}};
  chart.curves.front().is_command = true;
  std::string caption = part.is_target() ? fmt::format("Delay {:.1f} ms, offset {:.2f} {}.",
                                                       part.delay_ms.value, part.offset, part.unit)
                                         : part.kind_text + ".";
  if (audit.episodes.size() > 1)
    caption = fmt::format("Episode {:g}. ", part.worst_episode) + caption;
  for (const AuditFault& fault : part.faults) caption += " It " + fault.text + ".";
  return fmt::format("<figure>{}<figcaption>{}</figcaption></figure>\n", SvgChart(chart),
                     EscapeHtml(caption));
}

std::vector<HeadNumber> NumbersOf(const Audit& audit) {
  std::vector<double> delays_ms;
  std::size_t targets = 0, faulty = 0;
  for (const AuditedPart& part : audit.parts) {
    if (part.is_target()) ++targets;
    if (!part.faults.empty()) ++faulty;
    if (std::isfinite(part.delay_ms.value)) delays_ms.push_back(part.delay_ms.value);
  }
  const auto of_parts = [&](std::size_t count) {
    return fmt::format("{} of {}", count, audit.parts.size());
  };
  std::vector<HeadNumber> numbers = {
      {.name = "parts with targets",
       .value = of_parts(targets),
       .judgement = targets == audit.parts.size() ? Judgement::kBetter : Judgement::kWorse},
      {.name = "parts with a fault",
       .value = of_parts(faulty),
       .judgement = faulty == 0 ? Judgement::kBetter : Judgement::kWorse}};
  if (!delays_ms.empty()) {
    numbers.push_back({.name = "delay",
                       .value = RangeText(delays_ms, 0) + " ms",
                       .note = "angle behind its command"});
  }
  return numbers;
}

}  // namespace

std::string AuditPage(const Audit& audit) {
  PageHead head{
      .kind = "Gauntlet audit",
      .title = audit.name,
      .question = "What are the commands, and how large are delay and offset of each part?",
      .numbers = NumbersOf(audit),
      .facts = fmt::format("{} · {}", Counted(std::ssize(audit.parts), "part"), ExtentText(audit))};
  SetAnswer(VerdictOf(audit, "below"), head);
  std::string sections;
  if (const std::string delays = DelaySvg(audit); !delays.empty()) {
    sections += PageSection("delays", "Delay",
                            "Dot and line: mean and its 95 % confidence interval. Band: from the "
                            "5th to the 95th percentile over the data set.",
                            "<div class=\"pair\">" + delays + "</div>", SectionWidth::kHalf);
  }
  if (audit.episodes.size() > 1) {
    const auto add = [&](const char* id, const std::string& title, const std::string& text,
                         const std::string& map) {
      if (map.empty()) return;
      constexpr std::size_t kMostInHalf = 8;
      sections += PageSection(
          id, title, text, ScrolledDrawing(map, title),
          audit.episodes.size() <= kMostInHalf ? SectionWidth::kHalf : SectionWidth::kAll);
    };
    const double percent = 100.0 * kOffsetOfTravel;
    add("offsets", "Offset by episode",
        fmt::format(
            "Median of the angle less the delayed command [{}], worst of a column. It counts "
            "above {:g} % of the part's motion{}. Empty: none is known.",
            audit.unit, percent, audit.unit == "deg" ? " and 1 deg" : ""),
        EpisodesSvg(audit, &AuditedEpisode::offset, fmt::format("offset [{}]", audit.unit),
                    {.times_limit = {},
                     .at_zero = "0",
                     .at_limit = fmt::format("{:g} % of motion", percent),
                     .above = fmt::format("{:g} % or more", 2.0 * percent)},
                    [](const AuditedPart& part, double offset) {
                      return std::abs(offset) / part.offset_limit;
                    }));
    double limit_ms = 0.0;
    std::map<const AuditedPart*, double> usual_ms;
    for (const AuditedPart& part : audit.parts) {
      if (part.delay_limit_ms > limit_ms) limit_ms = part.delay_limit_ms;
      std::vector<double> delays_ms;
      for (const AuditedEpisode& one : part.episodes) {
        if (std::isfinite(one.delay_ms)) delays_ms.push_back(one.delay_ms);
      }
      if (!delays_ms.empty()) usual_ms[&part] = controller::MedianOf(delays_ms);
    }
    add("delays-of-episodes", "Delay by episode",
        fmt::format(
            "Delay of the angle [ms], that of a column which is farthest from the median of "
            "its part. Differences above {:.0f} ms count. Empty: none is known.",
            limit_ms),
        EpisodesSvg(audit, &AuditedEpisode::delay_ms, "delay [ms]",
                    {.times_limit = {},
                     .at_zero = "median",
                     .at_limit = fmt::format("{:.0f} ms from it", limit_ms),
                     .above = fmt::format("{:.0f} ms or more", 2.0 * limit_ms)},
                    [&](const AuditedPart& part, double delay_ms) {
                      return std::isfinite(delay_ms)
                                 ? std::abs(delay_ms - usual_ms.at(&part)) / limit_ms
                                 : kNaN;
                    }));
  }
  std::string figures;
  for (const AuditedPart& part : audit.parts) figures += FigureOf(audit, part);
  sections += PageSection("parts", "Largest errors",
                          "The stretch in which each angle is farthest from its command.",
                          "<div class=\"pair\">" + figures + "</div>");
  return PlainPage({.head = std::move(head),
                    .heading = "Result",
                    .table = HtmlOf(AuditFindings(audit)),
                    .sections = sections});
}

}  // namespace gauntlet::sim
