#include "sim/show/pages/headline.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>

#include "sim/answers/compare/comparison_verdict.h"
#include "sim/answers/sweep/sweep_result.h"
#include "sim/results/html_text.h"
#include "sim/results/table_text.h"
#include "sim/score/priority.h"
#include "sim/score/score.h"
#include "sim/score/statistics/result_cells.h"

namespace gauntlet::sim {
namespace {

std::optional<std::size_t> Recommended(const Summary& summary) {
  const auto& controllers = summary.controllers;
  const auto named =
      std::ranges::find(controllers, summary.answer.verdict.recommended, &ControllerSummary::name);
  if (named == controllers.end()) return std::nullopt;
  return static_cast<std::size_t>(named - controllers.begin());
}

/// A difference with its sign, in a unit that says most: delays in ms, other scores in percent of
/// the baseline's.
class SignedText {
 public:
  SignedText(const Metric& metric, double baseline)
      : unit_(metric.unit == "ms" ? "ms" : "%"),
        factor_(metric.unit == "ms" ? 1.0 : 100.0 / baseline) {}

  bool can_be_told() const { return std::isfinite(factor_); }
  std::string Of(double difference) const { return Number(difference) + " " + unit_; }
  std::string Between(double low, double high) const {
    return fmt::format("{} to {} {}", Number(low), Number(high), unit_);
  }

 private:
  std::string Number(double difference) const {
    const double rounded = std::round(difference * factor_);
    return fmt::format("{}{:.0f}", rounded < 0.0 ? "−" : "+", std::abs(rounded));
  }

  std::string unit_;
  double factor_;
};

std::string ItemOf(const HeadNumber& number, const std::string& link) {
  const char* css = number.judgement == Judgement::kBetter  ? " class=\"good\""
                    : number.judgement == Judgement::kWorse ? " class=\"warn\""
                                                            : "";
  const std::string note =
      number.note.empty() ? "" : fmt::format(" <small>{}</small>", EscapeHtml(number.note));
  const std::string name = link.empty() ? EscapeHtml(number.name)
                                        : fmt::format("<a href=\"{}\">{}</a>", EscapeHtml(link),
                                                      EscapeHtml(number.name));
  return fmt::format("<li{}><span>{}</span> <b>{}</b>{}</li>\n", css, name,
                     EscapeHtml(number.value), note);
}

std::string Paragraph(const char* css, const std::string& text) {
  return text.empty() ? "" : fmt::format("<p class=\"{}\">{}</p>\n", css, EscapeHtml(text));
}

}  // namespace

std::string Headline(const Summary& summary) {
  const std::string& name = summary.answer.verdict.recommended;
  if (summary.one_run) return "One run: no recommendation.";
  if (name.empty()) return "No recommendation.";
  if (!summary.baseline) return fmt::format("Use {}.", name);
  const std::string& baseline = summary.controllers[*summary.baseline].name;
  return name == baseline ? fmt::format("Keep {}.", name)
                          : fmt::format("Use {} in place of {}.", name, baseline);
}

std::vector<HeadNumber> HeadlineDifferences(const Summary& summary) {
  const std::optional<std::size_t> c = Recommended(summary);
  if (!c || !summary.baseline || *c == *summary.baseline) return {};
  const ControllerSummary& baseline = summary.controllers[*summary.baseline];
  std::vector<HeadNumber> numbers;
  std::vector<std::size_t> primary;
  const auto add = [&](std::size_t metric) {
    numbers.push_back(NumberOf(metric, summary.Of(metric, *c, *summary.baseline),
                               summary.controllers[*c].summary[metric].mean,
                               baseline.summary[metric].mean, baseline.name));
  };
  for (const auto& [word, metric] : PrimaryScores()) {
    primary.push_back(metric);
    if (summary.Of(metric, *c, *summary.baseline).judgement != Judgement::kNone) add(metric);
  }
  const std::vector<std::size_t> shown = ShownMetrics(summary);
  const auto price = std::ranges::find_if(shown, [&](std::size_t metric) {
    return std::ranges::count(primary, metric) == 0 &&
           summary.controllers[*c].AgainstBaseline(metric) == Judgement::kWorse;
  });
  if (price != shown.end()) add(*price);
  return numbers;
}

void SetAnswer(const Verdict& verdict, PageHead& head) {
  head.headline = verdict.Headline();
  head.answer = fmt::format("{}", fmt::join(verdict.Answer(), " "));
  if (head.answer.starts_with(head.headline)) {
    head.answer.erase(0, std::min(head.headline.size() + 1, head.answer.size()));
  }
  head.warnings = verdict.Doubts();
}

void SetAnswer(const std::string& text, PageHead& head) {
  SetAnswer(Verdict{.reasons = {{.key = "answer", .text = text}}}, head);
}

HeadNumber NumberOf(std::size_t metric, const MeanInterval& score, const std::string& note) {
  HeadNumber number{.name = ScoreName(metric), .value = ScoreValue(metric, score.mean)};
  number.note = note;
  const MeanInterval shown = ShownInterval(score, score.mean);
  if (std::isfinite(shown.low) && shown.low < shown.high) {
    number.note += fmt::format("{}95 % CI {} to {}", note.empty() ? "" : "; ", Short(shown.low),
                               Short(shown.high));
  }
  return number;
}

std::vector<HeadNumber> NumbersOf(const std::vector<std::size_t>& metrics,
                                  const std::vector<MeanInterval>& scores,
                                  const std::string& note) {
  std::vector<HeadNumber> numbers;
  for (const auto& [word, metric] : PrimaryScores()) {
    const std::size_t place = PlaceOfMetric(metrics, metric);
    if (place == metrics.size() || !std::isfinite(scores[place].mean)) continue;
    numbers.push_back(NumberOf(metric, scores[place], note));
  }
  if (numbers.empty() && !metrics.empty()) {
    numbers.push_back(NumberOf(metrics.front(), scores.front(), note));
  }
  return numbers;
}

HeadNumber NumberOf(std::size_t metric, const Comparison& comparison, double value, double baseline,
                    const std::string& name) {
  const SignedText text(Metrics()[metric], baseline);
  const bool differs =
      comparison.judgement == Judgement::kBetter || comparison.judgement == Judgement::kWorse;
  HeadNumber number{.name = ScoreName(metric),
                    .value = std::string(JudgementWord(comparison.judgement)),
                    .note = fmt::format("{}, {} {} {}", Short(value), name, Short(baseline),
                                        Metrics()[metric].unit),
                    .judgement = comparison.judgement};
  if (differs && text.can_be_told()) {
    number.value = text.Of(comparison.difference.mean);
    number.note +=
        "; 95 % CI " + text.Between(comparison.difference.low, comparison.difference.high);
  }
  return number;
}

std::string HtmlOf(const PageHead& head) {
  std::string items, warnings;
  for (const HeadNumber& number : head.numbers) items += ItemOf(number, head.of_numbers);
  for (const std::string& warning : head.warnings) warnings += Paragraph("note warn", warning);
  return fmt::format(
      "<header>\n{}<h1 id=\"title\">{}</h1>\n{}{}{}{}<ul class=\"problems\" id=\"problems\" "
      "hidden></ul>\n{}{}</header>\n",
      Paragraph("kind", head.kind), EscapeHtml(head.title), Paragraph("question", head.question),
      Paragraph("headline", head.headline),
      items.empty() ? "" : fmt::format("<ul class=\"gains\">\n{}</ul>\n", items),
      Paragraph("verdict", head.answer),
      warnings.empty() ? "" : fmt::format("<div class=\"doubts\">\n{}</div>\n", warnings),
      Paragraph("facts", head.facts));
}

}  // namespace gauntlet::sim
