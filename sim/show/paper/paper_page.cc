#include "sim/show/paper/paper_page.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <span>
#include <string_view>
#include <variant>

#include "controller/filters/paper_noise.h"
#include "paper_html.h"
#include "sim/answers/compare/study_files.h"
#include "sim/results/html_text.h"
#include "sim/results/table_text.h"
#include "sim/show/figure/palette.h"
#include "sim/show/pages/assets.h"
#include "sim/show/pages/score_table.h"

namespace gauntlet::sim {
namespace {

std::string Range(const std::vector<double>& values) {
  const auto [low, high] = std::minmax_element(values.begin(), values.end());
  return fmt::format("{:.2f} to {:.2f}", *low, *high);
}

std::string_view ClassOf(const ResultColumn& column, char mark) {
  if (!column.is_words) return "number";
  return mark == '*' ? "better" : mark == '!' ? "worse" : mark == '~' ? "undecided" : "words";
}

/// "delay [ms]", in one line.
std::string HeadingOf(const ResultColumn& column) {
  std::string heading = column.heading;
  for (char& c : heading) {
    if (c == kBreak || c == kSoftBreak) c = ' ';
  }
  return EscapeHtml(column.unit.empty() ? heading : heading + " [" + column.unit + "]");
}

/// A number with its mark.
std::string TextOf(const ResultColumn& column, const ResultCell& cell) {
  std::string text = cell.text;
  if (!column.is_words && cell.mark != ' ') text += cell.mark;
  return EscapeHtml(text);
}

/// A table whose cells contain the heading of their column. On a phone the cells of a row are below
/// each other, and the table has no head.
std::string TableHtml(const ResultTable& table) {
  std::string head, rows;
  for (const ResultColumn& column : table.columns) {
    head += fmt::format("<th class=\"{}\">{}</th>", ClassOf(column, ' '), HeadingOf(column));
  }
  for (const ResultRow& row : table.rows) {
    rows += "<tr>";
    for (std::size_t i = 0; i < row.size(); ++i) {
      rows += fmt::format("<td class=\"{}\" data-column=\"{}\">{}</td>",
                          ClassOf(table.columns[i], row[i].mark), HeadingOf(table.columns[i]),
                          TextOf(table.columns[i], row[i]));
    }
    rows += "</tr>\n";
  }
  return fmt::format(
      "<table class=\"plain\">\n<thead><tr>{}</tr></thead>\n<tbody>\n{}</tbody></table>", head,
      rows);
}

ResultColumn WordColumn(const std::string& heading) { return ForPeople(heading).Words(); }

/// "-5.21 (-5.80 to -4.62)".
std::string DifferenceText(const MeanInterval& difference) {
  if (std::isnan(difference.low)) return Short(difference.mean);
  return fmt::format("{} ({} to {})", Short(difference.mean), Short(difference.low),
                     Short(difference.high));
}

ResultTable ClaimTable(const PaperExperiment& experiment) {
  ResultTable table{.columns = {WordColumn("Claim"), WordColumn("Measured by"), ForPeople("Before"),
                                ForPeople("After"), ForPeople("Difference (95 % CI)"),
                                WordColumn("Smallest relevant difference"), WordColumn("Answer")}};
  for (const Claim& claim : experiment.claims) {
    const auto& [difference, relevant_difference, judgement] = claim.comparison;
    const std::string costs = claim.costs.empty() ? "" : ". It costs: " + claim.costs;
    table.rows.push_back(
        {ResultCell::Text(claim.claim + costs), ResultCell::Text(claim.measured),
         ResultCell(claim.before), ResultCell(claim.after),
         ResultCell::Text(DifferenceText(difference)),
         ResultCell::Text(Short(relevant_difference) + ": " + claim.relevant_reason),
         ResultCell({}, std::string(AnswerText(judgement)),
                    judgement == Judgement::kBetter  ? '*'
                    : judgement == Judgement::kWorse ? '!'
                                                     : '~')});
  }
  return table;
}

/// The table of comparisons and what its marks mean.
std::string ScoresHtml(const FinishedStudy& finished) {
  std::string html;
  for (const auto& part : AnswerText(finished)) {
    if (const auto* table = std::get_if<ResultTable>(&part)) {
      ResultTable shown = *table;
      shown.columns.front().is_words = true;
      html += TableHtml(shown);
    } else if (const auto* text = std::get_if<std::string>(&part)) {
      html += fmt::format("<p class=\"note\">{}</p>", EscapeHtml(*text));
    }
  }
  return html;
}

ResultTable FilterTable(const std::vector<PaperFilter>& filters) {
  ResultTable table{.columns = {WordColumn("Controller"), WordColumn("One step is"),
                                ForPeople("Passes at once"), ForPeople("Noise left"),
                                ForPeople("Delay at 1 Hz, ms")}};
  for (const PaperFilter& facts : filters) {
    table.rows.push_back(
        {ResultCell(facts.name),
         ResultCell::Text(facts.per_event ? "a command frame, 20 ms" : "a sample, 1 ms"),
         ResultCell::Text(Range(facts.gain)), ResultCell::Text(Range(facts.noise_share)),
         ResultCell::Text(fmt::format("{:.1f}", facts.delay_ms + 0.0))});
  }
  return table;
}

/// R of each channel: the paper's, and that of this glove at rest.
ResultTable NoiseTable(const PaperExperiment& experiment) {
  ResultTable table{.columns = {ForPeople("Channel"), WordColumn("Sensor"),
                                ForPeople("R of the paper, counts2"),
                                ForPeople("R estimated here (95 % CI)"),
                                ForPeople("Passes at once"), ForPeople("Noise left")}};
  const std::vector<double> paper = controller::PaperMeasurementVariance();
  const controller::NoiseEstimate& here = experiment.estimated_noise;
  const auto filter = std::ranges::find(experiment.filters, "paper_kalman", &PaperFilter::name);
  const std::vector<std::string>& names = experiment.finished.result.first_glove->channel_names;
  const std::size_t count = std::min({paper.size(), here.variance.size(), names.size()});
  for (std::size_t c = 0; c < count; ++c) {
    table.rows.push_back(
        {ResultCell::Text(fmt::to_string(c + 1)), ResultCell::Text(names[c]),
         ResultCell::Text(fmt::format("{:.2f}", paper[c])),
         ResultCell::Text(fmt::format("{:.2f} ({:.2f} to {:.2f})", here.variance[c],
                                      here.variance_low[c], here.variance_high[c])),
         ResultCell::Text(fmt::format("{:.2f}", filter->gain[c])),
         ResultCell::Text(fmt::format("{:.2f}", filter->noise_share[c]))});
  }
  return table;
}

/// How many of the paper's 18 variances lie in the interval of what was estimated.
int VariancesInside(const PaperExperiment& experiment) {
  const std::vector<double> paper = controller::PaperMeasurementVariance();
  int inside = 0;
  for (std::size_t c = 0; c < paper.size(); ++c) {
    inside += paper[c] >= experiment.estimated_noise.variance_low[c] &&
              paper[c] <= experiment.estimated_noise.variance_high[c];
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

/// "Fingers move quieter: confirmed; .."
std::string ClaimsOfRow(const PaperExperiment& experiment, std::string_view row) {
  std::string text;
  for (const Claim& claim : experiment.claims) {
    if (claim.row != row) continue;
    if (!text.empty()) text += "; ";
    text += fmt::format("{}: {}", claim.claim, AnswerText(claim.comparison.judgement));
    if (!claim.costs.empty()) text += fmt::format(" (it costs: {})", claim.costs);
  }
  return text;
}

/// "6 confirmed, 1 undecided".
std::string AnswersText(const std::vector<Claim>& claims) {
  std::string text;
  for (const Judgement judgement : {Judgement::kBetter, Judgement::kEqual, Judgement::kUndecided,
                                    Judgement::kWorse, Judgement::kNone}) {
    const auto count = std::ranges::count(
        claims, judgement, [](const Claim& claim) { return claim.comparison.judgement; });
    if (count == 0) continue;
    text += fmt::format("{}{} {}", text.empty() ? "" : ", ", count, AnswerText(judgement));
  }
  return text;
}

using Values = std::map<std::string, std::string, std::less<>>;

/// Values of the study's size and settings, and of all scores (`raw.delay_ms`) and claims (`P16`).
Values ValuesOfStudy(const PaperExperiment& e) {
  const StudyResult& result = e.finished.result;
  const GloveSignal& glove = *result.first_glove;
  const Scenario& scenario = e.finished.study.scenario;
  Values values = {
      {"claims", fmt::to_string(e.claims.size())},
      {"answers", AnswersText(e.claims)},
      {"controllers", fmt::to_string(result.controller_names.size())},
      {"seeds", fmt::to_string(result.seeds.size())},
      {"quick", e.quick ? " · quick: 6 s of motion instead of the paper's 94" : ""},
      {"with", e.set.empty() ? "With Q = I" : "As set here,"},
      {"set",
       e.set.empty() ? "" : fmt::format(" · not as in the paper: {}", fmt::join(e.set, ", "))},
      {"samples", fmt::to_string(glove.counts.rows())},
      {"channels", fmt::to_string(glove.counts.cols())},
      {"least_counts", fmt::to_string(glove.counts.minCoeff())},
      {"most_counts", fmt::to_string(glove.counts.maxCoeff())},
      {"rate_hz", fmt::format("{:g}", glove.rate_hz)},
      {"period_ms", fmt::format("{:g}", scenario.event.period_ms)},
      {"delay_ms", fmt::format("{:g}", scenario.event.delay_ms)}};
  for (const char* row : {"P4", "P16", "P18"}) values[row] = ClaimsOfRow(e, row);
  for (const ControllerSummary& controller : e.finished.summary.controllers) {
    for (std::size_t m = 0; m < Metrics().size(); ++m) {
      values[fmt::format("{}.{}", controller.name, Metrics()[m].key)] =
          Short(controller.summary[m].mean);
    }
  }
  return values;
}

/// Values of all that is measured besides the study.
Values ValuesOfTests(const PaperExperiment& e) {
  const GeneratorTest& test = e.generators;
  const double coupling = LargestCoupling(e.finished.study.hand->transmission());
  const double galton_theory = 1.0 / std::sqrt(2.0 * std::numbers::pi * test.galton_rows);
  Values values = {
      {"coupling", fmt::format("{:.0f}", 100.0 * coupling)},
      {"textbook_difference", fmt::format("{:.1e}", e.one_channel.textbook_difference)},
      {"switching_change", fmt::format("{:g}", e.switching_change)},
      {"variances_inside", fmt::to_string(VariancesInside(e))},
      {"draws", fmt::to_string(test.draws)},
      {"normal_mean", fmt::format("{:.4f}", test.normal_mean)},
      {"normal_deviation", fmt::format("{:.4f}", test.normal_deviation)},
      {"normal_kurtosis", fmt::format("{:.3f}", test.normal_kurtosis)},
      {"galton_rows", fmt::to_string(test.galton_rows)},
      {"galton_distance", fmt::format("{:.4f}", test.galton_distance)},
      {"galton_theory", fmt::format("{:.4f}", galton_theory)},
      {"galton_seen_distance", fmt::format("{:.4f}", test.galton_seen_distance)}};
  for (const PaperFilter& facts : e.filters) {
    values[facts.name + ".noise"] = Range(facts.noise_share);
  }
  return values;
}

std::string FigureHtml(const std::vector<PaperFigure>& figures) {
  std::string html;
  for (const PaperFigure& figure : figures) {
    std::string charts, others;
    for (const PaperChart& chart : figure.charts) (chart.is_extra ? others : charts) += chart.svg;
    if (!others.empty()) {
      others = fmt::format("<details><summary>{}</summary><div class=\"pair\">{}</div></details>",
                           EscapeHtml(figure.extra_title), others);
    }
    html += fmt::format(
        "<figure id=\"{}\"><div class=\"pair\">{}</div>{}<figcaption>{}</figcaption></figure>\n",
        figure.name, charts, others, EscapeHtml(figure.caption));
  }
  return html;
}

/// Verdict of the numbers, in one sentence.
std::string PaperVerdict(const PaperExperiment& experiment) {
  Values values = ValuesOfStudy(experiment);
  values.merge(ValuesOfTests(experiment));
  return FillTemplate(
      "Of {{claims}} claims: {{answers}}. {{with}} the paper's filter leaves "
      "{{paper_kalman.noise}} of the glove's noise and takes jitter from {{raw.jitter_rms_deg}} to "
      "{{paper_kalman.jitter_rms_deg}} deg RMS; a tuned Q takes it to "
      "{{tuned_kalman.jitter_rms_deg}}, with a tracking error of "
      "{{tuned_kalman.tracking_rmse_deg}} against {{paper_kalman.tracking_rmse_deg}} deg RMS.",
      values);
}

}  // namespace

std::string PaperPage(const PaperExperiment& experiment, const std::vector<PaperFigure>& figures) {
  Values values = ValuesOfStudy(experiment);
  values.merge(ValuesOfTests(experiment));
  values["verdict"] = PaperVerdict(experiment);
  values["settings"] = ResolvedScenario(experiment.finished);
  for (auto& [name, value] : values) value = EscapeHtml(value);
  values["title"] = "The paper, measured";
  values["kind"] = "Gauntlet";
  values["sources"] = "";
  values["style"] = PaletteCss() + std::string(assets::kStyle) + std::string(kPaperStyle);
  values["claim_table"] = TableHtml(ClaimTable(experiment));
  values["scores"] = ScoresHtml(experiment.finished);
  values["filters"] = TableHtml(FilterTable(experiment.filters));
  values["noise"] = TableHtml(NoiseTable(experiment));
  values["figures"] = FigureHtml(figures);
  return FillTemplate(kPaperHtml, values);
}

std::string PaperTable(const PaperExperiment& experiment) {
  constexpr std::size_t kWidth = 80;
  constexpr std::size_t kIndent = 21;
  const std::string indent(kIndent, ' ');
  const auto lines = [&](const std::string& text) {
    std::string wrapped = Wrapped(text, kWidth - kIndent);
    for (std::size_t at = 0; (at = wrapped.find('\n', at)) != std::string::npos;) {
      wrapped.insert(++at, indent);
    }
    return wrapped + "\n";
  };
  std::string out = Wrapped(PaperVerdict(experiment), kWidth) + "\n";
  if (experiment.quick) out += "Quick: 6 s of motion instead of the paper's 94.\n";
  if (!experiment.set.empty()) {
    out += Wrapped(fmt::format("Not as in the paper: {}", fmt::join(experiment.set, ", ")), kWidth);
    out += "\n";
  }
  out += "\n";
  for (const Claim& claim : experiment.claims) {
    const auto& [difference, relevant_difference, judgement] = claim.comparison;
    out += fmt::format("{:<{}}{}", AnswerText(judgement), kIndent, lines(claim.claim));
    out += indent + lines(fmt::format("{} -> {}  {}", Short(claim.before), Short(claim.after),
                                      claim.measured));
    out += indent + lines(fmt::format("difference {}, smallest relevant {}",
                                      DifferenceText(difference), Short(relevant_difference)));
    if (!claim.costs.empty()) out += indent + lines("costs " + claim.costs);
  }
  return out + "\nSimultaneous 95 % confidence intervals, paired by seed (Bonferroni).\n";
}

}  // namespace gauntlet::sim
