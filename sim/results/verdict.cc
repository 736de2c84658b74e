#include "sim/results/verdict.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <iterator>
#include <string_view>
#include <utility>

#include "sim/base/json.h"

namespace gauntlet::sim {
namespace {

/// Key of what the answer rests on, which stands behind its reasons.
constexpr std::string_view kAssumed = "assumed";

Json JsonOfRemarks(const std::vector<VerdictRemark>& remarks) {
  auto json = Json::array();
  for (const VerdictRemark& remark : remarks) {
    json.push_back({{"key", remark.key}, {"text", remark.text}});
  }
  return json;
}

}  // namespace

void Verdict::AddReason(std::string key, std::string text) {
  if (!text.empty()) reasons.push_back({.key = std::move(key), .text = std::move(text)});
}

void Verdict::AddHeadline(std::string key, std::string beginning, const std::string& rest) {
  AddReason(std::move(key), beginning + rest);
  headline = std::move(beginning);
}

void Verdict::AddWarning(std::string key, std::string text) {
  if (!text.empty()) warnings.push_back({.key = std::move(key), .text = std::move(text)});
}

void Verdict::AddUndecided(const std::vector<std::string>& undecided, const std::string& cure,
                           const std::string& noun) {
  if (undecided.empty()) return;
  constexpr std::size_t kMostNames = 3;
  std::string others = undecided.front();
  for (std::size_t i = 1; i < std::min(kMostNames, undecided.size()); ++i) {
    others += "; " + undecided[i];
  }
  if (undecided.size() > kMostNames) {
    others += fmt::format("; {} others", undecided.size() - kMostNames);
  }
  if (!noun.empty() && undecided.size() > 1) {
    others = fmt::format("{} other {}s", undecided.size(), noun);
  }
  AddHeadline("undecided", "No recommendation",
              fmt::format(", as it is undecided against {}. {}", others, cure));
  alternatives.insert(alternatives.begin(), std::exchange(recommended, {}));
  alternatives.insert(alternatives.end(), undecided.begin(), undecided.end());
}

void Verdict::AddWithoutHand() {
  AddWarning("without_hand",
             "Filters only: confirm the result with the hand model (gauntlet compare).");
}

std::vector<std::string> Verdict::Answer() const {
  std::vector<std::string> sentences;
  for (const VerdictRemark& reason : reasons) sentences.push_back(reason.text);
  for (const VerdictRemark& warning : warnings) {
    if (warning.key == kAssumed) sentences.push_back(warning.text);
  }
  return sentences;
}

std::vector<std::string> Verdict::Doubts() const {
  std::vector<std::string> sentences;
  for (const VerdictRemark& warning : warnings) {
    if (warning.key != kAssumed) sentences.push_back(warning.text);
  }
  return sentences;
}

std::string Verdict::Headline() const {
  if (!headline.empty()) return headline + ".";
  if (reasons.empty()) return "";
  const std::string& first = reasons.front().text;
  return first.substr(0, std::min(first.find(". "), first.size() - 1) + 1);
}

std::string Verdict::Text() const {
  std::vector<std::string> sentences = Answer();
  std::ranges::move(Doubts(), std::back_inserter(sentences));
  return fmt::format("{}", fmt::join(sentences, " "));
}

Json JsonOf(const Verdict& verdict) {
  Json json = {{"version", 1},
               {"recommended", nullptr},
               {"alternatives", verdict.alternatives},
               {"reasons", JsonOfRemarks(verdict.reasons)},
               {"warnings", JsonOfRemarks(verdict.warnings)}};
  if (!verdict.recommended.empty()) json["recommended"] = verdict.recommended;
  return json;
}

}  // namespace gauntlet::sim
