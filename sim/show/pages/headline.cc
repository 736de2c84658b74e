#include "sim/show/pages/headline.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>

#include "sim/results/html_text.h"
#include "sim/results/table_text.h"
#include "sim/score/priority.h"
#include "sim/score/score.h"

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

std::string Item(const Summary& summary, std::size_t metric, std::size_t c, std::size_t baseline) {
  const Comparison& comparison = summary.Of(metric, c, baseline);
  const double mean = summary.controllers[c].summary[metric].mean;
  const double of_baseline = summary.controllers[baseline].summary[metric].mean;
  const SignedText text(Metrics()[metric], of_baseline);
  const bool differs =
      comparison.judgement == Judgement::kBetter || comparison.judgement == Judgement::kWorse;
  std::string large(JudgementWord(comparison.judgement));
  std::string interval;
  if (differs && text.can_be_told()) {
    large = text.Of(comparison.difference.mean);
    interval = "; 95 % CI " + text.Between(comparison.difference.low, comparison.difference.high);
  }
  const char* kind = !differs                                     ? ""
                     : comparison.judgement == Judgement::kBetter ? " class=\"good\""
                                                                  : " class=\"warn\"";
  return fmt::format("<li{}><span>{}</span> <b>{}</b> <small>{}, {} {} {}{}</small></li>\n", kind,
                     EscapeHtml(Metrics()[metric].name), large, Short(mean),
                     EscapeHtml(summary.controllers[baseline].name), Short(of_baseline),
                     EscapeHtml(Metrics()[metric].unit), interval);
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

std::string HeadlineDifferences(const Summary& summary) {
  const std::optional<std::size_t> c = Recommended(summary);
  if (!c || !summary.baseline || *c == *summary.baseline) return "";
  std::string items;
  for (const PrimaryScore& score : PrimaryScores()) {
    if (summary.Of(score.metric, *c, *summary.baseline).judgement == Judgement::kNone) continue;
    items += Item(summary, score.metric, *c, *summary.baseline);
  }
  return items.empty() ? "" : fmt::format("<ul class=\"gains\">\n{}</ul>", items);
}

}  // namespace gauntlet::sim
