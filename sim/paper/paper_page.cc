#include "sim/paper/paper_page.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <span>
#include <string_view>

#include "controller/filters/paper_noise.h"
#include "paper_html.h"
#include "sim/comparison/study_files.h"
#include "sim/glove/noise/galton_board.h"
#include "sim/report/assets.h"
#include "sim/report/score_table.h"
#include "sim/results/html_text.h"
#include "sim/results/table_text.h"

namespace gauntlet::sim {
namespace {

std::string Range(const std::vector<double>& values) {
  const auto [low, high] = std::minmax_element(values.begin(), values.end());
  return fmt::format("{:.2f} to {:.2f}", *low, *high);
}

/// A cell that is a number stands at the right.
struct Cell {
  std::string text;
  bool number = false;
  std::string style = {};
};
using Row = std::vector<Cell>;

std::string CellHtml(const Cell& cell, const char* element, const std::string& attributes) {
  const std::string style = cell.number ? "number" : cell.style;
  return fmt::format("<{0}{1}{2}>{3}</{0}>", element,
                     style.empty() ? "" : fmt::format(" class=\"{}\"", style), attributes,
                     EscapeHtml(cell.text));
}

/// A table. Each cell knows its column's name: on a phone rows stand below each other, and no head.
std::string Table(const Row& head, const std::vector<Row>& rows) {
  std::string html = "<table class=\"plain\">\n<thead><tr>";
  for (const Cell& cell : head) html += CellHtml(cell, "th", "");
  html += "</tr></thead>\n<tbody>\n";
  for (const Row& row : rows) {
    html += "<tr>";
    for (std::size_t i = 0; i < row.size(); ++i) {
      html += CellHtml(row[i], "td", fmt::format(" data-column=\"{}\"", EscapeHtml(head[i].text)));
    }
    html += "</tr>\n";
  }
  return html + "</tbody></table>";
}

/// "-5.21 (-5.80 to -4.62)".
std::string DifferenceText(const MeanInterval& difference) {
  if (std::isnan(difference.low)) return Short(difference.mean);
  return fmt::format("{} ({} to {})", Short(difference.mean), Short(difference.low),
                     Short(difference.high));
}

std::string ClaimTable(const PaperExperiment& experiment) {
  std::vector<Row> rows;
  for (const Claim& claim : experiment.claims) {
    const auto& [difference, relevant_difference, judgement] = claim.comparison;
    std::string said = claim.claim;
    if (!claim.costs.empty()) said += fmt::format(". It costs: {}", claim.costs);
    rows.push_back({{said},
                    {claim.measured},
                    {Short(claim.before), true},
                    {Short(claim.after), true},
                    {DifferenceText(difference), true},
                    {fmt::format("{}: {}", Short(relevant_difference), claim.relevant_reason)},
                    {std::string(AnswerText(judgement)), false,
                     judgement == Judgement::kNone ? "" : std::string(JudgementText(judgement))}});
  }
  return Table({{"Claim"},
                {"Measured by"},
                {"Before", true},
                {"After", true},
                {"Difference, interval", true},
                {"Matters from"},
                {"Answer"}},
               rows);
}

std::string ScoresTable(const PaperExperiment& experiment) {
  const Summary& summary = experiment.finished.summary;
  Row head = {{"Controller"}};
  std::vector<Row> rows;
  for (const ControllerSummary& controller : summary.controllers)
    rows.push_back({{controller.name}});
  for (std::size_t metric = 0; metric < Metrics().size(); ++metric) {
    const bool has_value = std::isfinite(summary.controllers[0].summary[metric].mean);
    if (!Metrics()[metric].main || !has_value) continue;
    head.push_back({std::string(Metrics()[metric].key), true});
    for (std::size_t c = 0; c < rows.size(); ++c) {
      const ControllerSummary& controller = summary.controllers[c];
      const Comparison& to_best = controller.to_best[metric];
      std::string text = Short(controller.summary[metric].mean);
      if (to_best.judgement != Judgement::kNone) {
        text += fmt::format("; {}: {}", DifferenceText(to_best.difference),
                            JudgementText(to_best.judgement));
      } else if (controller.as_good_as_best[metric]) {
        text += "; best";
      }
      rows[c].push_back({text, true});
    }
  }
  return Table(head, rows);
}

std::string FilterTable(const PaperExperiment& experiment) {
  std::vector<Row> rows;
  for (const FilterFacts& facts : experiment.filters) {
    rows.push_back({{facts.name},
                    {facts.per_event ? "an event, 20 ms" : "a sample, 1 ms"},
                    {Range(facts.gain), true},
                    {Range(facts.noise_share), true},
                    {fmt::format("{:.1f}", facts.delay_ms + 0.0), true}});
  }
  return Table({{"Controller"},
                {"One step is"},
                {"Passes at once", true},
                {"Noise left", true},
                {"Delay at 1 Hz, ms", true}},
               rows);
}

double Score(const PaperExperiment& experiment, const char* controller, const char* metric) {
  const std::size_t index = ControllerIndex(experiment.finished.result, controller);
  return experiment.finished.summary.controllers[index].summary[MetricIndex(metric)].mean;
}

const FilterFacts& Facts(const PaperExperiment& experiment, const char* name) {
  return *std::find_if(experiment.filters.begin(), experiment.filters.end(),
                       [&](const FilterFacts& facts) { return facts.name == name; });
}

/// How many of the paper's 18 variances lie in the interval of what was estimated.
int VariancesInside(const PaperExperiment& experiment) {
  const std::vector<double> paper = controller::PaperMeasurementVariance();
  int inside = 0;
  for (std::size_t c = 0; c < paper.size(); ++c) {
    inside += paper[c] >= experiment.estimated_variance_low[c] &&
              paper[c] <= experiment.estimated_variance_high[c];
  }
  return inside;
}

/// The largest share of another joint in what a spool has to turn.
double LargestCoupling(const controller::TendonTransmission& hand) {
  const std::size_t joints = hand.joint_names.size();
  double largest = 0.0;
  for (std::size_t m = 0; m < hand.motor_names.size(); ++m) {
    const auto row = std::span(hand.coupling).subspan(m * joints, joints);
    const auto own = std::ranges::find(hand.joint_names, hand.motor_names[m]);
    if (own == hand.joint_names.end()) continue;
    const auto own_joint = static_cast<std::size_t>(own - hand.joint_names.begin());
    for (std::size_t j = 0; j < joints; ++j) {
      if (j != own_joint) largest = std::max(largest, std::abs(row[j] / row[own_joint]));
    }
  }
  return largest;
}

std::string RowTable(const PaperExperiment& e) {
  const auto& glove = *e.finished.result.first_glove;
  const auto& hand = e.finished.study.hand->transmission();
  const auto claims_of = [&](std::string_view row) {
    std::string text;
    for (const Claim& claim : e.claims) {
      if (claim.row != row) continue;
      if (!text.empty()) text += "; ";
      text += fmt::format("{}: {}", claim.claim, AnswerText(claim.comparison.judgement));
      if (!claim.costs.empty()) text += fmt::format(" (it costs: {})", claim.costs);
    }
    return text;
  };
  std::vector<Row> rows;
  const auto add = [&](const char* number, const char* paper, const std::string& here) {
    rows.push_back({{number}, {paper}, {here}});
  };
  add("P1", "A glove of 18 bend sensors, very noisy (figure 4)",
      fmt::format("{} named channels, {} to {} counts", glove.counts.cols(),
                  glove.counts.minCoeff(), glove.counts.maxCoeff()));
  add("P2", "Linearisation, then motor command (figure 3)",
      "counts, filter, angle, prediction, tendon map, integer command: each can be changed in the "
      "scenario");
  add("P3", "Interference drive: cables of distal joints pass proximal ones",
      fmt::format(
          "a spool turns by up to {:.0f} % of its own share for another joint; the map takes "
          "that away (gauntlet list channels)",
          100.0 * LargestCoupling(hand)));
  add("P4", "A mean filter is not good and costs real-time behaviour",
      fmt::format("mean over 20: delay {} ms against {} of the Kalman filter, jitter {} against {} "
                  "deg. It is late, but calmer than Q = I",
                  Short(Score(e, "mean_20", "delay_ms")),
                  Short(Score(e, "paper_kalman", "delay_ms")),
                  Short(Score(e, "mean_20", "jitter_rms_deg")),
                  Short(Score(e, "paper_kalman", "jitter_rms_deg"))) +
          ". " + claims_of("P4"));
  add("P5", "A Kalman filter per joint, A = [1 1; 0 1]",
      fmt::format("that model; largest difference from the textbook recursion over 6000 samples: "
                  "{:.1e} counts",
                  e.one_channel.textbook_difference));
  add("P6", "Any number of joints, changed while running",
      fmt::format("one channel switched off and on again changes the others by {:g} rad",
                  e.switching_change));
  add("P7", "K from P_j as printed", "K from the a-priori covariance, the standard form");
  add("P8", "R of 18 channels from sampling; Q = I",
      fmt::format("both are presets; R estimated from this glove at rest: {} of 18 of the paper's "
                  "values lie in its 95 % interval (17 are expected)",
                  VariancesInside(e)));
  add("P9", "Gaussian noise by Box-Muller (figures 6, 7)",
      fmt::format("{} draws: mean {:.4f}, deviation {:.4f}, kurtosis {:.3f} (0, 1, 3)",
                  e.generators.draws, e.generators.normal_mean, e.generators.normal_deviation,
                  e.generators.normal_kurtosis));
  add("P10", "Gaussian noise by the Galton board (figures 8, 9)",
      fmt::format("{} rows: {:.4f} from the normal law (theory: about {:.4f}); {} balls are {:.4f} "
                  "from the board's own law",
                  e.generators.galton_rows, e.generators.galton_distance,
                  1.0 / std::sqrt(2.0 * std::numbers::pi * e.generators.galton_rows),
                  e.generators.draws, e.generators.galton_seen_distance));
  add("P11", "First test: 6000 steps of one channel (figure 10)", "figure 10 above");
  add("P12", "Matrices whose size follows the number of channels, with Eigen",
      "sized once, no allocation in a step (a test counts them)");
  add("P13", "1000 Hz, an event every 0.02 s, event time below 45 ms",
      fmt::format(
          "{:g} Hz, an event every {:g} ms with a delay of {:g} ms; from glove to finger {} "
          "ms without a filter, {} with the paper's",
          glove.rate_hz, e.finished.study.scenario.event.period_ms,
          e.finished.study.scenario.event.delay_ms, Short(Score(e, "raw", "delay_ms")),
          Short(Score(e, "paper_kalman", "delay_ms"))));
  add("P14", "Real-time test: 94096 x 18 samples of random motion",
      fmt::format("{} x {} samples for each of {} controllers and {} seeds", glove.counts.rows(),
                  glove.counts.cols(), e.finished.result.controller_names.size(),
                  e.finished.result.seeds.size()));
  add("P15", "Figure 12: six channels, original, processed, sent to the motor",
      "figure 12 above; the command is integer");
  add("P16",
      "Less local jumps, quieter, lower motor noise, more so in slow motion, and with better "
      "servos",
      claims_of("P16"));
  add("P17", "No measurement was possible; a video as evidence",
      fmt::format(
          "tracking error {} deg RMS without a filter, {} with the paper's, {} tuned; video "
          "by gauntlet render",
          Short(Score(e, "raw", "tracking_rmse_deg")),
          Short(Score(e, "paper_kalman", "tracking_rmse_deg")),
          Short(Score(e, "tuned_kalman", "tracking_rmse_deg"))));
  add("P18", "Prediction control, never built",
      fmt::format(
          "built: from tuned_kalman to prediction the tracking error goes from {} to {} deg "
          "RMS and the delay from {} to {} ms; it costs jitter, {} to {} deg RMS, and local "
          "jumps, {} to {} a second. {}",
          Short(Score(e, "tuned_kalman", "tracking_rmse_deg")),
          Short(Score(e, "prediction", "tracking_rmse_deg")),
          Short(Score(e, "tuned_kalman", "delay_ms")), Short(Score(e, "prediction", "delay_ms")),
          Short(Score(e, "tuned_kalman", "jitter_rms_deg")),
          Short(Score(e, "prediction", "jitter_rms_deg")),
          Short(Score(e, "tuned_kalman", "command_reversals_per_s")),
          Short(Score(e, "prediction", "command_reversals_per_s")), claims_of("P18")));
  return Table({{""}, {"In the paper"}, {"Here"}}, rows);
}

std::string FigureHtml(const std::vector<PaperFigure>& figures) {
  std::string html;
  for (const PaperFigure& figure : figures) {
    html += fmt::format("<figure id=\"{}\"><div class=\"pair\">", figure.name);
    for (const PaperChart& chart : figure.charts) html += chart.svg;
    html += fmt::format("</div><figcaption>{}</figcaption></figure>\n", EscapeHtml(figure.caption));
  }
  return html;
}

}  // namespace

std::string PaperVerdict(const PaperExperiment& experiment) {
  std::map<Judgement, int> answers;
  for (const Claim& claim : experiment.claims) ++answers[claim.comparison.judgement];
  std::string counts;
  for (const Judgement judgement : {Judgement::kBetter, Judgement::kEqual, Judgement::kUndecided,
                                    Judgement::kWorse, Judgement::kNone}) {
    if (answers[judgement] == 0) continue;
    if (!counts.empty()) counts += ", ";
    counts += fmt::format("{} {}", answers[judgement], AnswerText(judgement));
  }
  return fmt::format(
      "Of {} claims: {}. With Q = I the paper's filter leaves {} of the glove's noise and takes "
      "jitter from {} to {} deg RMS; a tuned Q takes it to {}, with a tracking error of {} against "
      "{} deg RMS.",
      experiment.claims.size(), counts, Range(Facts(experiment, "paper_kalman").noise_share),
      Short(Score(experiment, "raw", "jitter_rms_deg")),
      Short(Score(experiment, "paper_kalman", "jitter_rms_deg")),
      Short(Score(experiment, "tuned_kalman", "jitter_rms_deg")),
      Short(Score(experiment, "tuned_kalman", "tracking_rmse_deg")),
      Short(Score(experiment, "paper_kalman", "tracking_rmse_deg")));
}

std::string PaperPage(const PaperExperiment& experiment, const std::vector<PaperFigure>& figures) {
  const StudyResult& result = experiment.finished.result;
  const std::string facts = fmt::format(
      "{} samples x {} channels · {} controllers · {} seeds{}", result.first_glove->counts.rows(),
      result.first_glove->channel_names.size(), result.controller_names.size(), result.seeds.size(),
      experiment.quick ? " · quick: 6 s of motion instead of the paper's 94" : "");
  return FillTemplate(kPaperHtml,
                      {{"title", "The paper, measured"},
                       {"kind", "Gauntlet"},
                       {"sources", ""},
                       {"style", std::string(assets::kStyle) + std::string(kPaperStyle)},
                       {"verdict", EscapeHtml(PaperVerdict(experiment))},
                       {"facts", EscapeHtml(facts)},
                       {"claims", ClaimTable(experiment)},
                       {"scores", ScoresTable(experiment)},
                       {"filters", FilterTable(experiment)},
                       {"figures", FigureHtml(figures)},
                       {"rows", RowTable(experiment)},
                       {"settings", EscapeHtml(ResolvedScenario(experiment.finished))}});
}

std::string PaperTable(const PaperExperiment& experiment) {
  std::string out;
  for (const Claim& claim : experiment.claims) {
    const auto& [difference, relevant_difference, judgement] = claim.comparison;
    out += fmt::format("{:<19}  {}\n", AnswerText(judgement), claim.claim);
    out += fmt::format("{:21}{} -> {}  {}\n", "", Short(claim.before), Short(claim.after),
                       claim.measured);
    out += fmt::format("{:21}difference {}, matters from {}\n", "", DifferenceText(difference),
                       Short(relevant_difference));
    if (!claim.costs.empty()) out += fmt::format("{:21}costs {}\n", "", claim.costs);
  }
  out += "Intervals are paired by seed, and hold together with 95 % (Bonferroni).\n";
  if (experiment.quick) out += "\nQuick: 6 s of motion instead of the paper's 94.";
  return out + "\n" + PaperVerdict(experiment) + "\n";
}

}  // namespace gauntlet::sim
