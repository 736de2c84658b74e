#include "sim/score/priority.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "controller/number.h"
#include "controller/settings.h"
#include "sim/base/nearest_name.h"
#include "sim/base/text.h"
#include "sim/score/score.h"

namespace gauntlet::sim {
namespace {

using controller::SettingError;

std::string Trimmed(std::string text) {
  text.erase(0, std::min(text.find_first_not_of(' '), text.size()));
  text.erase(text.find_last_not_of(' ') + 1);
  return text;
}

}  // namespace

std::size_t FindScore(const std::string& name, const std::string& key) {
  if (const std::optional<std::size_t> metric = FindMetric(name)) return *metric;
  std::vector<std::string> known;
  for (const Metric& metric : Metrics()) known.emplace_back(metric.key);
  throw SettingError(key, Shown(name) + " is not a score" + Suggestion(name, known));
}

Constraint ParseConstraint(const std::string& text, const std::string& key) {
  const std::size_t sign = text.find_first_of("<>");
  if (sign == std::string::npos || sign + 1 >= text.size() || text[sign + 1] != '=') {
    throw SettingError(key, Shown(text) + " must be SCORE<=NUMBER or SCORE>=NUMBER");
  }
  const std::string number = Trimmed(text.substr(sign + 2));
  const std::size_t metric = FindScore(Trimmed(text.substr(0, sign)), key);
  const std::optional<double> bound = controller::ParseNumber(number);
  if (!bound) {
    throw SettingError(key, fmt::format("{}: \"{}\" must be a number", Shown(text), Shown(number)));
  }
  return {.metric = metric, .at_most = text[sign] == '<', .bound = *bound};
}

std::string Constraint::Text() const {
  return fmt::format("{}{}{}", Metrics()[metric].key, at_most ? "<=" : ">=", bound);
}

std::vector<std::string> TextsOf(const std::vector<Constraint>& bounds) {
  std::vector<std::string> texts;
  for (const Constraint& bound : bounds) texts.push_back(bound.Text());
  return texts;
}

const std::vector<PrimaryScore>& PrimaryScores() {
  static const std::vector<PrimaryScore> kScores = {{"tracking", MetricIndex("tracking_rmse_deg")},
                                                    {"delay", MetricIndex("delay_ms")},
                                                    {"jitter", MetricIndex("jitter_rms_deg")}};
  return kScores;
}

bool IsPrimary(std::size_t metric) {
  return std::ranges::count(PrimaryScores(), metric, &PrimaryScore::metric) > 0;
}

Priority ParsePriority(const std::string& text) {
  Priority priority{.metric = PrimaryScores().front().metric, .bounds = {}};
  bool has_word = false;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find(',', begin), text.size());
    const std::string part = Trimmed(text.substr(begin, end - begin));
    begin = end + 1;
    const auto score = std::ranges::find(PrimaryScores(), part, &PrimaryScore::word);
    if (score != PrimaryScores().end() && !has_word) {
      priority.metric = score->metric;
      has_word = true;
    } else if (part.find_first_of("<>") != std::string::npos) {
      priority.bounds.push_back(ParseConstraint(part, "priority"));
    } else {
      std::vector<std::string> words;
      for (const PrimaryScore& known : PrimaryScores()) words.emplace_back(known.word);
      const std::string nearest = NearestName(part, words);
      throw SettingError("priority",
                         Shown(text) +
                             " must be tracking, delay or jitter, and bounds like "
                             "jitter_rms_deg<=0.1 behind commas" +
                             (nearest.empty() ? "" : " (did you mean " + nearest + "?)"));
    }
  }
  return priority;
}

}  // namespace gauntlet::sim
