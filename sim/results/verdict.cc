#include "sim/results/verdict.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <nlohmann/json.hpp>
#include <utility>

namespace gauntlet::sim {
namespace {

nlohmann::ordered_json JsonOfRemarks(const std::vector<VerdictRemark>& remarks) {
  auto json = nlohmann::ordered_json::array();
  for (const VerdictRemark& remark : remarks) {
    json.push_back({{"key", remark.key}, {"text", remark.text}});
  }
  return json;
}

}  // namespace

void Verdict::AddReason(std::string key, std::string text) {
  if (!text.empty()) reasons.push_back({.key = std::move(key), .text = std::move(text)});
}

void Verdict::AddWarning(std::string key, std::string text) {
  if (!text.empty()) warnings.push_back({.key = std::move(key), .text = std::move(text)});
}

void Verdict::AddUndecided(const std::vector<std::string>& undecided) {
  if (undecided.empty()) return;
  AddWarning("undecided", fmt::format("It is undecided against {}.", fmt::join(undecided, "; ")));
  alternatives.insert(alternatives.begin(), std::exchange(recommended, {}));
  alternatives.insert(alternatives.end(), undecided.begin(), undecided.end());
}

void Verdict::AddWithoutHand() {
  AddWarning("without_hand", "Without a hand: confirm with physics before it counts.");
}

std::string Verdict::Text() const {
  std::string text;
  for (const auto* remarks : {&reasons, &warnings}) {
    for (const VerdictRemark& remark : *remarks) text += (text.empty() ? "" : " ") + remark.text;
  }
  return text;
}

nlohmann::ordered_json JsonOf(const Verdict& verdict) {
  nlohmann::ordered_json json = {{"version", 1},
                                 {"recommended", nullptr},
                                 {"alternatives", verdict.alternatives},
                                 {"reasons", JsonOfRemarks(verdict.reasons)},
                                 {"warnings", JsonOfRemarks(verdict.warnings)}};
  if (!verdict.recommended.empty()) json["recommended"] = verdict.recommended;
  return json;
}

}  // namespace gauntlet::sim
