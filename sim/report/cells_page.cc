#include "sim/report/cells_page.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <tuple>

#include "sim/report/assets.h"
#include "sim/report/cells_chart.h"
#include "sim/report/html_text.h"
#include "sim/report/robust_table.h"
#include "sim/report/sweep_table.h"

namespace gauntlet::sim {
namespace {

constexpr double kNothing = std::numeric_limits<double>::quiet_NaN();
constexpr std::size_t kMostScores = 4;      // of parallel coordinates
constexpr std::size_t kMostAxesOfHeat = 4;  // six pairs
constexpr std::size_t kMostLabels = 40;     // of a heat map's side: more values are binned
constexpr int kBins = 12;

/// One setting of one controller with its scores: a line, a point, a place in heat maps.
struct Point {
  std::string name;
  std::vector<std::string> values;  // of the axes
  std::vector<double> scores;       // of the page's metrics
  bool keeps_bounds = true;
  bool stopped = false;
  std::string yaml;
  std::string command;
};

/// A side of heat maps: what a value's column is.
struct Side {
  ChartAxis axis;
  std::vector<std::string> labels;

  explicit Side(const ChartAxis& of) : axis(of), labels(of.labels) {
    for (int bin = 0; labels.size() < kBins && of.labels.empty(); ++bin) {
      const double place = (bin + 0.5) / kBins;
      labels.push_back(fmt::format("{:.3g}", of.log ? of.low * std::pow(of.high / of.low, place)
                                                    : of.low + place * (of.high - of.low)));
    }
  }
  std::optional<std::size_t> ColumnOf(const std::string& value) const {
    const double place = axis.PlaceOf(value);
    if (std::isnan(place)) return std::nullopt;
    if (!axis.labels.empty()) {
      return static_cast<std::size_t>(std::ranges::find(labels, value) - labels.begin());
    }
    return std::min(static_cast<std::size_t>(place * kBins), labels.size() - 1);
  }
};

/// Takes the points of a study one by one, and keeps what the page shows of them.
class Gathered {
 public:
  /// `all`: how many points will come, about.
  Gathered(std::vector<ChartAxis> axes, std::vector<std::size_t> metrics, std::size_t best_by,
           std::int64_t all)
      : axes_(std::move(axes)),
        metrics_(std::move(metrics)),
        best_by_(best_by),
        every_(std::max<std::int64_t>(1, (2 * all + kPagePoints - 1) / kPagePoints)) {
    if (all <= kPagePoints) every_ = 1;
    const std::size_t sides = std::min(axes_.size(), kMostAxesOfHeat);
    for (std::size_t x = 0; x < sides; ++x) {
      for (std::size_t y = x + 1; y < sides; ++y) pairs_.push_back({x, y, {}});
    }
    for (const ChartAxis& axis : axes_) sides_.emplace_back(axis);
  }

  /// `point` is asked for its texts only if it is kept.
  template <class Texts>
  void Add(Point point, const Texts& texts) {
    const std::int64_t number = seen_++;
    const double rank = RankOf(point);
    for (Pair& pair : pairs_) {
      const auto x = sides_[pair.x].ColumnOf(point.values[pair.x]);
      const auto y = sides_[pair.y].ColumnOf(point.values[pair.y]);
      if (!x || !y || !std::isfinite(rank) || !point.keeps_bounds) continue;
      pair.best.resize(sides_[pair.x].labels.size() * sides_[pair.y].labels.size());
      Best& best = pair.best[*y * sides_[pair.x].labels.size() + *x];
      if (rank < best.rank) best = {rank, number};
    }
    const bool is_sample = number % every_ == 0;
    const Order order{!point.keeps_bounds, point.stopped, rank, number};
    const bool is_good = kept_.size() < kPagePoints / 2 || order < worst_good_;
    if (!is_sample && !is_good) return;
    texts(point);
    kept_.push_back({order, number, is_sample, std::move(point)});
    if (std::ssize(kept_) > 2 * kPagePoints) DropSome();
  }

  void Finish() { DropSome(); }

  /// The best first: what keeps all bounds, then what was not stopped, then by the score.
  using Order = std::tuple<bool, bool, double, std::int64_t>;
  struct Kept {
    Order order;
    std::int64_t number;
    bool is_sample;
    Point point;
  };
  const std::vector<Kept>& kept() const { return kept_; }
  std::int64_t seen() const { return seen_; }
  const std::vector<ChartAxis>& axes() const { return axes_; }
  const std::vector<std::size_t>& metrics() const { return metrics_; }
  std::size_t best_by() const { return best_by_; }

  std::vector<HeatMap> HeatMaps() const {
    std::vector<HeatMap> maps;
    for (const Pair& pair : pairs_) {
      if (pair.best.empty()) continue;
      HeatMap& map = maps.emplace_back();
      map.x_name = axes_[pair.x].name;
      map.y_name = axes_[pair.y].name;
      map.score = std::string(Metrics()[best_by_].key);
      map.x_labels = sides_[pair.x].labels;
      map.y_labels = sides_[pair.y].labels;
      map.lower_is_better = Metrics()[best_by_].lower_is_better;
      for (const Best& best : pair.best) {
        const bool is_there = std::isfinite(best.rank);
        map.best.push_back(is_there ? (map.lower_is_better ? best.rank : -best.rank) : kNothing);
        const auto found = std::ranges::find(kept_, best.number, &Kept::number);
        map.points.push_back(
            found == kept_.end() ? kNoPoint : static_cast<std::size_t>(found - kept_.begin()));
      }
    }
    return maps;
  }

 private:
  struct Best {
    double rank = std::numeric_limits<double>::infinity();
    std::int64_t number = -1;
  };
  struct Pair {
    std::size_t x, y;
    std::vector<Best> best;
  };

  /// The lower the better.
  double RankOf(const Point& point) const {
    const auto place = std::ranges::find(metrics_, best_by_) - metrics_.begin();
    const double score = point.scores[static_cast<std::size_t>(place)];
    if (std::isnan(score)) return std::numeric_limits<double>::infinity();
    return Metrics()[best_by_].lower_is_better ? score : -score;
  }
  /// Sorts; of too many points keeps the samples and the best.
  void DropSome() {
    std::ranges::sort(kept_, {}, &Kept::order);
    if (std::ssize(kept_) <= kPagePoints && every_ == 1) return;
    const std::size_t good = std::min<std::size_t>(kept_.size(), kPagePoints / 2);
    std::vector<Kept> left;
    for (std::size_t i = 0; i < kept_.size(); ++i) {
      if (i < good || kept_[i].is_sample) left.push_back(std::move(kept_[i]));
    }
    kept_ = std::move(left);
    worst_good_ = kept_[good - 1].order;
  }

  std::vector<ChartAxis> axes_;
  std::vector<std::size_t> metrics_;
  std::size_t best_by_;
  std::int64_t every_;
  std::int64_t seen_ = 0;
  Order worst_good_{true, true, std::numeric_limits<double>::infinity(), 0};
  std::vector<Side> sides_;
  std::vector<Pair> pairs_;
  std::vector<Kept> kept_;
};

/// An axis of a study file, or a free setting of tuning, with a name of its own.
ChartAxis AxisOf(const SweepAxis& setting, const std::string& name, bool grid) {
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

/// The scores that are drawn: the one that decides, then the others.
std::vector<std::size_t> DrawnScores(const Gathered& gathered) {
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

struct PageTexts {
  std::string kind;  // "sweep"
  std::string title;
  std::string question;
  std::string facts;
  std::string verdict;
  std::string table;
  std::string tornadoes;  // SVG and headings
  bool heat = true;
};

std::string Section(const std::string& id, const std::string& title, const std::string& note,
                    const std::string& drawing) {
  return fmt::format(
      "<section id=\"{0}\" aria-labelledby=\"{0}-title\">\n<h2 id=\"{0}-title\">{1}</h2>\n"
      "<p class=\"note\">{2}</p>\n{3}</section>\n",
      id, title, note, drawing);
}

std::string Scrolled(const std::string& drawing, const std::string& label) {
  return fmt::format(
      "<div class=\"scroll\" tabindex=\"0\" role=\"region\" aria-label=\"{}\">{}</div>\n", label,
      drawing);
}

std::string HeatSection(const Gathered& gathered) {
  std::string drawings;
  for (const HeatMap& map : gathered.HeatMaps()) {
    drawings += fmt::format("<figure class=\"heat-figure\" data-name=\"{} and {}\">{}</figure>\n",
                            EscapeHtml(map.x_name), EscapeHtml(map.y_name),
                            Scrolled(HeatMapSvg(map), "Heat map"));
  }
  if (drawings.empty()) return "";
  return Section("heat", "Two settings at a time",
                 fmt::format("The best {} over all other settings, of what keeps all bounds. The "
                             "warmest is the worst.",
                             Metrics()[gathered.best_by()].key),
                 "<p class=\"controls\" id=\"heat-controls\" hidden><label "
                 "for=\"heat-pair\">Settings</label> <select id=\"heat-pair\"></select></p>\n" +
                     drawings);
}

std::string Page(const Gathered& gathered, const PageTexts& texts) {
  std::vector<ChartAxis> axes = gathered.axes();
  const std::vector<std::size_t> scores = DrawnScores(gathered);
  for (const std::size_t m : scores) {
    ChartAxis& axis = axes.emplace_back();
    axis.name = std::string(Metrics()[gathered.metrics()[m]].key);
    axis.low = std::numeric_limits<double>::infinity();
    axis.high = -axis.low;
    for (const Gathered::Kept& kept : gathered.kept()) {
      const double score = kept.point.scores[m];
      if (!std::isfinite(score)) continue;
      axis.low = std::min(axis.low, score);
      axis.high = std::max(axis.high, score);
    }
  }
  const auto place_of = [&gathered](std::string_view metric) {
    const auto& metrics = gathered.metrics();
    return static_cast<std::size_t>(std::ranges::find(metrics, MetricIndex(metric)) -
                                    metrics.begin());
  };
  const std::size_t delay = place_of("delay_ms");
  const std::size_t jitter = place_of("jitter_rms_deg");
  std::vector<ChartPoint> points;
  nlohmann::ordered_json data = nlohmann::ordered_json::array();
  const std::size_t good = std::max<std::size_t>(1, gathered.kept().size() / 10);
  for (const Gathered::Kept& kept : gathered.kept()) {
    ChartPoint& point = points.emplace_back();
    for (std::size_t a = 0; a < gathered.axes().size(); ++a) {
      point.places.push_back(axes[a].PlaceOf(kept.point.values[a]));
    }
    for (std::size_t i = 0; i < scores.size(); ++i) {
      point.places.push_back(
          axes[gathered.axes().size() + i].PlaceOf(kept.point.scores[scores[i]]));
    }
    point.faint = !kept.point.keeps_bounds;
    point.good = !point.faint && points.size() <= good;
    const bool front = delay < gathered.metrics().size() && jitter < gathered.metrics().size();
    point.delay_ms = front ? kept.point.scores[delay] : kNothing;
    point.jitter_deg = front ? kept.point.scores[jitter] : kNothing;
    nlohmann::ordered_json& entry = data.emplace_back();
    entry["name"] = kept.point.name;
    entry["yaml"] = kept.point.yaml;
    entry["command"] = kept.point.command;
    for (const double place : point.places) {
      entry["places"].push_back(std::isnan(place)
                                    ? nlohmann::ordered_json(nullptr)
                                    : nlohmann::ordered_json(std::round(1000.0 * place) / 1000.0));
    }
    for (std::size_t m = 0; m < gathered.metrics().size(); ++m) {
      const double score = kept.point.scores[m];
      if (std::isfinite(score)) {
        entry["scores"][std::string(Metrics()[gathered.metrics()[m]].key)] = score;
      }
    }
  }
  std::string sections = texts.tornadoes;
  if (texts.heat) sections += HeatSection(gathered);
  if (!points.empty()) {
    sections += Section(
        "parallel", "All settings at once",
        "A line is one setting with its scores; the best tenth is drawn over the others. <span "
        "class=\"needs-script\">Drag along an axis to keep only what passes there; press the axis "
        "to let go. Press a line for its settings.</span>",
        "<p class=\"controls needs-script\"><span id=\"brushed\" role=\"status\"></span> <button "
        "type=\"button\" id=\"brush-none\" hidden>All</button></p>\n" +
            Scrolled(ParallelSvg(axes, points), "Parallel coordinates"));
  }
  if (const std::string front = FrontSvg(points); !front.empty()) {
    sections += Section("front", "Jitter against delay",
                        "Nearer to the lower left corner is better; the line joins what nothing "
                        "else is better than in both means.",
                        front);
  }
  const std::int64_t shown = std::ssize(points);
  const std::string facts =
      texts.facts + (shown < gathered.seen()
                         ? fmt::format(" · pictures have {} of {} settings: the best {} and every "
                                       "so manieth of the others; heat maps have all",
                                       shown, gathered.seen(), kPagePoints / 2)
                         : "");
  const bool any = !gathered.kept().empty();
  return FillTemplate(assets::kCellsHtml,
                      {{"kind", texts.kind},
                       {"title", EscapeHtml(texts.title)},
                       {"question", EscapeHtml(texts.question)},
                       {"facts", EscapeHtml(facts)},
                       {"verdict", EscapeHtml(texts.verdict)},
                       {"table", EscapeHtml(texts.table)},
                       {"sections", sections},
                       {"name", any ? EscapeHtml(gathered.kept().front().point.name) : ""},
                       {"yaml", any ? EscapeHtml(gathered.kept().front().point.yaml) : ""},
                       {"command", any ? EscapeHtml(gathered.kept().front().point.command) : ""},
                       {"data", JsonForScript(data)},
                       {"style", std::string(assets::kStyle) + std::string(assets::kCellsStyle)},
                       {"script", std::string(assets::kCellsScript)}});
}

std::string BoundsText(const std::vector<Constraint>& constraints) {
  std::vector<std::string> bounds;
  for (const Constraint& constraint : constraints) bounds.push_back(constraint.Text());
  return bounds.empty() ? "" : fmt::format(" · {}", fmt::join(bounds, ", "));
}

std::vector<double> MeansOf(const std::vector<MeanInterval>& scores) {
  std::vector<double> means;
  for (const MeanInterval& score : scores) means.push_back(score.mean);
  return means;
}

}  // namespace

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

std::string SweepPage(const SweepPlan& plan, SweepDatabase& database, const CellRange& cells,
                      const SweepSummary& summary, const std::string& table) {
  std::vector<ChartAxis> axes;
  for (std::size_t a = 0; a < plan.file.axes.size(); ++a) {
    axes.push_back(
        AxisOf(plan.file.axes[a], ShortKey(plan, a), plan.file.design == SweepFile::Design::kGrid));
  }
  Scenario scenario = ParseScenario(plan.scenario);
  KeepControllers(plan.file.controllers, scenario);
  const bool several = scenario.controllers.size() > 1 || axes.size() < 2;
  if (several) {
    ChartAxis& axis = axes.emplace_back();
    axis.name = "controller";
    for (const NamedController& named : scenario.controllers) axis.labels.push_back(named.name);
  }
  Gathered gathered(std::move(axes), plan.metrics, plan.best_by, summary.results);
  ForEachCell(plan, database, cells, [&](const CellResult& result) {
    if (!result.problem.empty()) return;
    Point point{.name = fmt::format("cell {}, {}", result.number, result.controller),
                .values = result.values,
                .scores = MeansOf(result.scores),
                .keeps_bounds = result.CanBeBest(),
                .stopped = result.stopped,
                .yaml = {},
                .command = {}};
    if (several) point.values.push_back(result.controller);
    gathered.Add(std::move(point), [&](Point& kept) {
      kept.yaml = SettingsYaml(plan.OverridesOf(result.number));
      kept.command = RepeatCommand(plan, result.controller, result.number);
    });
  });
  gathered.Finish();
  const std::string verdict =
      summary.best.empty()
          ? "No cell keeps all bounds."
          : fmt::format("Best by {}: cell {}, {}.", Metrics()[plan.best_by].key,
                        summary.best.front().number, summary.best.front().controller);
  return Page(gathered,
              {.kind = "Gauntlet sweep",
               .title = plan.file.name,
               .question = plan.file.question,
               .facts = fmt::format("{} cells · {} seed{} · best by {}{}{}", plan.cell_count(),
                                    plan.file.seeds, plan.file.seeds == 1 ? "" : "s",
                                    Metrics()[plan.best_by].key, BoundsText(plan.constraints),
                                    plan.file.physics ? "" : " · filters only, no hand"),
               .verdict = verdict,
               .table = table,
               .tornadoes = {}});
}

std::string RobustPage(const RobustPlan& plan, SweepDatabase& database, const RobustResult& result,
                       const std::string& table) {
  std::vector<ChartAxis> axes;
  for (const RobustParameter& parameter : plan.parameters) {
    const double within = 0.01 * plan.within_percent;
    axes.push_back({.name = parameter.name, .low = 1.0 - within, .high = 1.0 + within});
  }
  ChartAxis& controllers = axes.emplace_back();
  controllers.name = "controller";
  for (const ControllerSummary& controller : result.nominal.controllers) {
    controllers.labels.push_back(controller.name);
  }
  Gathered gathered(
      std::move(axes), plan.sweep.metrics, plan.sweep.best_by,
      plan.sweep.cell_count() * static_cast<std::int64_t>(result.nominal.controllers.size()));
  ForEachCell(plan.sweep, database, ShardOf(plan.sweep, 1, 1), [&](const CellResult& cell) {
    if (!cell.problem.empty()) return;
    Point point{.name = fmt::format("hand {}, {}", cell.number, cell.controller),
                .values = {},
                .scores = MeansOf(cell.scores),
                .yaml = {},
                .command = {}};
    for (const double factor : plan.factors[static_cast<std::size_t>(cell.number)]) {
      point.values.push_back(fmt::format("{}", factor));
    }
    point.values.push_back(cell.controller);
    gathered.Add(std::move(point), [&](Point& kept) {
      kept.yaml = SettingsYaml(plan.sweep.OverridesOf(cell.number));
      kept.command = RepeatCommand(plan.sweep, "", cell.number);
    });
  });
  gathered.Finish();
  std::string tornadoes;
  for (const RobustScore& score : result.scores) {
    if (score.bars.empty()) continue;
    tornadoes += fmt::format(
        "<figure class=\"tornado-figure\">{}</figure>\n",
        TornadoSvg(
            plan, score,
            result.nominal.Of(score.metric, score.two_best[0], score.two_best[1]).difference.mean));
  }
  return Page(gathered,
              {.kind = "Does the verdict hold?",
               .title = plan.sweep.file.name,
               .question = plan.sweep.file.question,
               .facts = HandsText(plan),
               .verdict = RobustVerdicts(result).front(),
               .table = table,
               .tornadoes =
                   Section("tornado", "What matters",
                           "How the difference between the two that are best on the scenario's own "
                           "hand changes where one parameter is low (hollow) or high (filled), "
                           "with 95 % intervals; in the band around the own hand's a change is "
                           "less than what matters. A word stands where high against low is "
                           "decided: all these hold together with 95 %.",
                           "<div class=\"tornadoes\">" + tornadoes + "</div>\n"),
               .heat = false});
}

std::string TunePage(const TunePlan& plan, const TuneResult& result, const std::string& table) {
  std::vector<ChartAxis> axes;
  const std::size_t prefix = std::string("controllers.").size() + plan.controller.size() + 1;
  for (const SweepAxis& axis : plan.free) {
    axes.push_back(AxisOf(axis, axis.key.substr(prefix), false));
  }
  Gathered gathered(std::move(axes), result.metrics, plan.minimise, std::ssize(result.tried));
  for (std::size_t i = 0; i < result.tried.size(); ++i) {
    const TunedSetting& setting = result.tried[i];
    if (!setting.problem.empty()) continue;
    gathered.Add(
        {.name = fmt::format("try {}{}", i, i == result.chosen ? ", the answer" : ""),
         .values = setting.values,
         .scores = MeansOf(setting.scores),
         .keeps_bounds = setting.KeepsBounds(),
         .yaml = {},
         .command = {}},
        [&](Point& kept) {
          std::vector<std::string> sets;
          for (std::size_t a = 0; a < plan.free.size(); ++a) {
            sets.push_back(plan.free[a].key + "=" + setting.values[a]);
          }
          kept.yaml = SettingsYaml(sets);
          sets.insert(sets.begin(), plan.scenario.overrides.begin(), plan.scenario.overrides.end());
          kept.command =
              CompareCommand(plan.scenario.file.string(), plan.seeds, plan.controller, sets);
        });
  }
  gathered.Finish();
  const Metric& metric = Metrics()[plan.minimise];
  return Page(
      gathered,
      {.kind = "Gauntlet tune",
       .title = fmt::format("{} of {}", plan.controller, plan.scenario.file.stem().string()),
       .question =
           fmt::format("Which values give the {} {}{}?", metric.lower_is_better ? "least" : "most",
                       metric.key, BoundsText(plan.constraints)),
       .facts =
           fmt::format("{} settings tried on {} seeds · judged on {} others{}", result.tried.size(),
                       plan.seeds, plan.held_out, plan.physics ? "" : " · filters only, no hand"),
       .verdict = fmt::format("Try {} is the answer: see its intervals on the held-out "
                              "seeds below.",
                              result.chosen),
       .table = table,
       .tornadoes = {}});
}

}  // namespace gauntlet::sim
