#include "sim/show/pages/cells_page.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "sim/base/chart_scale.h"
#include "sim/base/json.h"
#include "sim/results/html_text.h"
#include "sim/score/statistics/result_cells.h"
#include "sim/show/figure/palette.h"
#include "sim/show/pages/assets.h"
#include "sim/show/pages/front_chart.h"

namespace gauntlet::sim {
namespace {

constexpr std::size_t kMostScores = 4;          // of parallel coordinates
constexpr std::size_t kMostColumnsInHalf = 10;  // of a heat map
constexpr std::size_t kMostLabels = 40;         // of a heat map's side: more values are binned

/// The scores that are drawn: the one that decides, then the others.
std::vector<std::size_t> DrawnScores(const CellPoints& gathered) {
  std::vector<std::size_t> places;
  for (std::size_t m = 0; m < gathered.metrics().size(); ++m) {
    if (gathered.metrics()[m] == gathered.best_by()) {
      places.insert(places.begin(), m);
    } else {
      places.push_back(m);
    }
  }
  places.resize(std::min(places.size(), kMostScores));
  return places;
}

/// Badness of the points in the score that decides: 0 best, 1 worst of those that keep all bounds;
/// NaN without a score.
std::vector<double> SharesOf(const CellPoints& gathered) {
  const std::size_t m = PlaceOfMetric(gathered.metrics(), gathered.best_by());
  Extent range;
  for (const CellPoints::Kept& kept : gathered.kept()) {
    if (kept.point.keeps_bounds) range.Include(kept.point.scores[m]);
  }
  std::vector<double> shares;
  for (const CellPoints::Kept& kept : gathered.kept()) {
    const double share = std::clamp(range.Share(kept.point.scores[m]), 0.0, 1.0);
    shares.push_back(Metrics()[gathered.best_by()].lower_is_better ? share : 1.0 - share);
  }
  return shares;
}

std::string HeatSection(const CellPoints& gathered, const std::vector<ChartAxis>& axes,
                        const std::vector<ChartPoint>& points) {
  constexpr double kMostlyFilled = 0.5;  // a map with more holes shows what was not tried
  std::string drawings;
  std::size_t most_columns = 0;
  bool has_points = false;
  for (const HeatMap& map : gathered.HeatMaps()) {
    const bool is_map = map.FilledShare() > kMostlyFilled;
    if (is_map) most_columns = std::max(most_columns, map.x_labels.size());
    has_points |= !is_map;
    drawings += fmt::format(
        "<figure class=\"heat-figure\" data-name=\"{} and {}\">{}</figure>\n",
        EscapeHtml(map.x_name), EscapeHtml(map.y_name),
        ScrolledDrawing(
            is_map ? HeatMapSvg(map) : ScatterSvg(axes, map.x, map.y, points, SharesOf(gathered)),
            is_map ? "Heat map" : "Settings tried"));
  }
  if (drawings.empty()) return "";
  const std::string score = ScoreName(gathered.best_by());
  std::string note;
  if (most_columns > 0) {
    note = fmt::format("The best {} over all other settings, of what keeps all bounds. ", score);
  }
  if (has_points) note += "A dot is a setting tried; pale: breaks a bound. ";
  return PageSection("heat", "Two settings at a time",
                     note + fmt::format("Darker: worse {}.", score),
                     "<p class=\"controls\" id=\"heat-controls\" hidden><label "
                     "for=\"heat-pair\">Settings</label> <select "
                     "id=\"heat-pair\"></select></p>\n" +
                         drawings,
                     most_columns <= kMostColumnsInHalf ? SectionWidth::kHalf : SectionWidth::kAll);
}

/// The axes of the settings, then one for each drawn score, from its lowest to its highest value.
std::vector<ChartAxis> AxesOf(const CellPoints& gathered, const std::vector<std::size_t>& scores) {
  std::vector<ChartAxis> axes = gathered.axes();
  for (const std::size_t m : scores) {
    Extent range;
    for (const CellPoints::Kept& kept : gathered.kept()) range.Include(kept.point.scores[m]);
    axes.push_back({.name = std::string(Metrics()[gathered.metrics()[m]].key),
                    .low = range.low,
                    .high = range.high});
  }
  return axes;
}

/// A score of a point; NaN if the study does not have it.
double ScoreOf(const CellPoints& gathered, const CellPoint& point, std::string_view metric) {
  const std::size_t place = PlaceOfMetric(gathered.metrics(), MetricIndex(metric));
  return place < point.scores.size() ? point.scores[place] : kNaN;
}

std::vector<ChartPoint> PointsOf(const CellPoints& gathered, const std::vector<ChartAxis>& axes,
                                 const std::vector<std::size_t>& scores) {
  std::vector<ChartPoint> points;
  const std::size_t good = std::max<std::size_t>(1, gathered.kept().size() / 10);
  for (const auto& [order, number, is_sample, kept] : gathered.kept()) {
    ChartPoint& point = points.emplace_back();
    auto axis = axes.begin();
    for (std::size_t a = 0; a < gathered.axes().size(); ++a) {
      point.places.push_back((axis++)->PlaceOf(kept.values[a]));
    }
    for (const std::size_t m : scores) point.places.push_back((axis++)->PlaceOf(kept.scores[m]));
    point.faint = !kept.keeps_bounds;
    point.good = !point.faint && points.size() <= good;
    point.delay_ms = ScoreOf(gathered, kept, "delay_ms");
    point.jitter_deg = ScoreOf(gathered, kept, "jitter_rms_deg");
  }
  return points;
}

/// The data of one point for the scripts of the page.
Json PointJson(const CellPoints& gathered, const CellPoint& kept, const ChartPoint& point) {
  Json json = {{"name", kept.name}, {"yaml", kept.yaml}, {"command", kept.command}};
  for (const double place : point.places) {
    json["places"].push_back(NumberOrNull(std::round(1000.0 * place) / 1000.0));
  }
  for (std::size_t m = 0; m < gathered.metrics().size(); ++m) {
    if (!std::isfinite(kept.scores[m])) continue;
    json["scores"][std::string(Metrics()[gathered.metrics()[m]].key)] = kept.scores[m];
  }
  return json;
}

std::string Sections(const CellPoints& gathered, const CellsPageTexts& texts,
                     const std::vector<ChartAxis>& axes, const std::vector<ChartPoint>& points) {
  std::string sections;
  // Beside the result, then the pictures of the command, then those of all settings.
  if (const std::string front = texts.front ? FrontSvg(points) : ""; !front.empty()) {
    sections +=
        PageSection("front", "Jitter against delay",
                    "Nearer to the lower left corner is better. Dotted: Pareto front of the means.",
                    front, SectionWidth::kHalf);
  }
  sections += texts.first_sections;
  if (texts.heat) sections += HeatSection(gathered, axes, points);
  if (!points.empty()) {
    constexpr std::size_t kMostInHalf = 6;
    sections += PageSection(
        "parallel", "All settings at once",
        "A line is one setting with its scores; the first tenth of the list is drawn over the "
        "others. <span "
        "class=\"needs-script\">Drag along an axis to keep only what passes there; press the axis "
        "to let go. Press a line for its settings.</span>",
        "<p class=\"controls needs-script\"><span id=\"brushed\" role=\"status\"></span> <button "
        "type=\"button\" id=\"brush-none\" hidden>All</button></p>\n" +
            ScrolledDrawing(ParallelSvg(axes, points), "Parallel coordinates"),
        axes.size() <= kMostInHalf ? SectionWidth::kHalf : SectionWidth::kAll);
  }
  return sections;
}

/// True if a table of the text needs more than half of a wide page.
bool IsWide(const ResultText& text) {
  constexpr std::ptrdiff_t kMostColumns = 7;
  return std::ranges::any_of(text, [](const auto& part) {
    const auto* table = std::get_if<ResultTable>(&part);
    return table != nullptr &&
           std::ranges::count_if(table->columns, [](const ResultColumn& column) {
             return !column.heading.empty();
           }) > kMostColumns;
  });
}

std::string FactsOf(const CellPoints& gathered, const CellsPageTexts& texts) {
  const std::int64_t shown = std::ssize(gathered.kept());
  if (shown == gathered.seen()) return texts.head.facts;
  return fmt::format(
      "{} · pictures have {} of {} settings: the best {} and every n-th of the rest; heat maps "
      "have all",
      texts.head.facts, shown, gathered.seen(), kPagePoints / 2);
}

}  // namespace

std::string ScrolledDrawing(const std::string& drawing, const std::string& label) {
  return fmt::format(
      "<div class=\"scroll\" tabindex=\"0\" role=\"region\" aria-label=\"{}\">{}</div>\n", label,
      drawing);
}

std::string PageSection(const std::string& id, const std::string& title, const std::string& note,
                        const std::string& drawing, SectionWidth width) {
  return fmt::format(
      "<section id=\"{0}\"{1} aria-labelledby=\"{0}-title\">\n<h2 id=\"{0}-title\">{2}</h2>\n"
      "{3}{4}</section>\n",
      id, width == SectionWidth::kAll ? " class=\"wide\"" : "", title,
      note.empty() ? "" : fmt::format("<p class=\"note\">{}</p>\n", note), drawing);
}

ChartAxis ChartAxisOf(const SweepAxis& setting, const std::string& name, bool grid) {
  ChartAxis axis{.name = name, .labels = setting.values};
  if (!setting.is_range()) return axis;
  axis.low = setting.low;
  axis.high = setting.high;
  axis.log = setting.spacing == SweepAxis::Spacing::kLog;
  if (grid && setting.count <= static_cast<int>(kMostLabels)) {
    for (int i = 0; i < setting.count; ++i) {
      const std::string label =
          setting.ValueAt(i / static_cast<double>(std::max(setting.count - 1, 1)));
      if (axis.labels.empty() || axis.labels.back() != label) axis.labels.push_back(label);
    }
  }
  return axis;
}

ResultText TextBehindAnswer(const ResultText& text) {
  return {text.begin() + std::min<std::ptrdiff_t>(2, std::ssize(text)), text.end()};
}

std::string CellsPage(const CellPoints& gathered, const CellsPageTexts& texts) {
  const std::vector<std::size_t> scores = DrawnScores(gathered);
  const std::vector<ChartAxis> axes = AxesOf(gathered, scores);
  const std::vector<ChartPoint> points = PointsOf(gathered, axes, scores);
  Json data = Json::array();
  for (std::size_t i = 0; i < points.size(); ++i) {
    data.push_back(PointJson(gathered, gathered.kept()[i].point, points[i]));
  }
  const CellPoint first = points.empty() ? CellPoint{} : gathered.kept().front().point;
  PageHead head = texts.head;
  head.facts = FactsOf(gathered, texts);
  const std::string details =
      texts.details.empty()
          ? ""
          : PageSection("details", "All numbers", "",
                        "<div class=\"flow\">" + HtmlOf(texts.details) + "</div>\n");
  return FillTemplate(
      assets::kCellsHtml,
      {{"kind", EscapeHtml(head.kind)},
       {"title", EscapeHtml(head.title)},
       {"head", HtmlOf(head)},
       {"table_class", IsWide(texts.text) ? " class=\"wide\"" : ""},
       {"table", HtmlOf(TextBehindAnswer(texts.text))},
       {"sections", Sections(gathered, texts, axes, points)},
       {"details", details},
       {"name", EscapeHtml(first.name)},
       {"yaml", EscapeHtml(first.yaml)},
       {"command", EscapeHtml(first.command)},
       {"command_folder", texts.command_folder},
       {"data", JsonForScript(data)},
       {"sources", assets::kScriptSources},
       {"style", PaletteCss() + std::string(assets::kStyle) + std::string(assets::kCellsStyle)},
       {"script", std::string(assets::kCellsScript)}});
}

std::string BoundsText(const std::vector<Constraint>& constraints) {
  return constraints.empty() ? "" : fmt::format(" · {}", fmt::join(TextsOf(constraints), ", "));
}

std::vector<double> MeansOf(const std::vector<MeanInterval>& scores) {
  std::vector<double> means;
  for (const MeanInterval& score : scores) means.push_back(score.mean);
  return means;
}

std::string SettingsYaml(std::vector<std::string> overrides) {
  std::ranges::sort(overrides);
  std::string text;
  std::string comments;
  std::vector<std::string> open;  // the groups that the last line stands in
  for (const std::string& override : overrides) {
    const std::size_t equals = override.find('=');
    std::vector<std::string> parts;
    for (std::size_t from = 0; from <= equals;) {
      const std::size_t dot = std::min(override.find_first_of(".[", from), equals);
      parts.push_back(override.substr(from, dot - from));
      from = dot + 1;
    }
    const bool in_list = std::ranges::any_of(parts, [](const std::string& part) {
      return part.find_first_not_of("0123456789]") == std::string::npos;
    });
    if (in_list) {
      comments += "# --set " + override + "\n";
      continue;
    }
    std::size_t same = 0;
    while (same < open.size() && same + 1 < parts.size() && open[same] == parts[same]) ++same;
    open.assign(parts.begin(), parts.end() - 1);
    for (; same < open.size(); ++same) {
      text += std::string(2 * same, ' ') + open[same] + ":\n";
    }
    text += std::string(2 * open.size(), ' ') + parts.back() + ": " + override.substr(equals + 1) +
            "\n";
  }
  return text + comments;
}

}  // namespace gauntlet::sim
