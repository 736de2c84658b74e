#include "sim/answers/tune/tune_memo.h"

#include <bit>
#include <cstdint>
#include <utility>
#include <vector>

#include "sim/base/error.h"
#include "sim/base/hash.h"
#include "sim/base/json.h"
#include "sim/base/limited_text.h"
#include "sim/base/output_file.h"
#include "sim/study/elsewhere.h"
#include "sim/study/scenario/scenario_reader.h"
#include "sim/study/study.h"
#include "sim/study/study_identity.h"

namespace gauntlet::sim {
namespace {

/// A number to the last bit, also where JSON has none.
Json BitsOf(double value) { return std::bit_cast<std::int64_t>(value); }
double FromBits(const Json& bits) { return std::bit_cast<double>(bits.get<std::int64_t>()); }

Json ToJson(const TunedSetting& setting) {
  Json json = Json::object();
  json["values"] = Json(setting.values);
  json["scores"] = Json::array();
  for (const MeanInterval& score : setting.scores) {
    Json of_score = Json::array();
    for (const double number : {score.mean, score.low, score.high, score.level, score.motion_share,
                                score.degrees_of_freedom}) {
      of_score.push_back(BitsOf(number));
    }
    of_score.push_back(score.count);
    json["scores"].push_back(std::move(of_score));
  }
  json["minimised"] = Json::array();
  for (const double value : setting.minimised) json["minimised"].push_back(BitsOf(value));
  json["motions"] = Json(setting.motions);
  json["met"] = static_cast<int>(setting.met);
  json["problem"] = setting.problem;
  return json;
}

TunedSetting FromJson(const Json& json) {
  TunedSetting setting;
  setting.values = json.at("values").get<std::vector<std::string>>();
  for (const Json& score : json.at("scores")) {
    const auto number = [&score](std::size_t place) { return FromBits(score[place]); };
    setting.scores.push_back({.mean = number(0),
                              .low = number(1),
                              .high = number(2),
                              .count = score[6].get<int>(),
                              .level = number(3),
                              .motion_share = number(4),
                              .degrees_of_freedom = number(5)});
  }
  for (const Json& bits : json.at("minimised")) setting.minimised.push_back(FromBits(bits));
  for (const Json& motion : json.at("motions")) setting.motions.push_back(motion.get<int>());
  setting.met = static_cast<Met>(json.at("met").get<int>());
  setting.problem = json.at("problem").get<std::string>();
  return setting;
}

std::string IdentityOfTune(const TunePlan& plan) {
  Scenario scenario = ParseScenario(plan.scenario);
  KeepControllers({plan.controller}, scenario);
  const StudyIdentity identity = IdentityOf(PrepareStudy(plan.scenario, std::move(scenario)));
  Hash hash;
  hash.Add(identity.hash);
  for (const std::string& settings : identity.controller_settings) hash.Add(settings);
  return hash.Text();
}

}  // namespace

TuneMemo::TuneMemo(const TunePlan& plan) : identity_(IdentityOfTune(plan)) {}

std::optional<TunedSetting> TuneMemo::Find(const std::string& question) const {
  const auto found = known_.find(question);
  if (found == known_.end()) return std::nullopt;
  return found->second;
}

void TuneMemo::Keep(const std::string& question, const TunedSetting& setting) {
  known_.emplace(question, setting);
}

void TuneMemo::Write(const std::filesystem::path& file) const {
  Json json = Json::object();
  json["identity"] = identity_;
  json["settings"] = Json::array();
  for (const auto& [question, setting] : known_) {
    json["settings"].push_back(Json::array());
    json["settings"].back().push_back(question);
    json["settings"].back().push_back(ToJson(setting));
  }
  WriteOutputFile(file, json.dump());
}

void TuneMemo::Add(const std::filesystem::path& file) {
  try {
    const Json json = Json::parse(LimitedText(file, kMostScoreBytes));
    if (json.at("identity").get<std::string>() != identity_) throw RunError(kOtherBuild);
    for (const Json& entry : json.at("settings")) {
      Keep(entry[0].get<std::string>(), FromJson(entry[1]));
    }
  } catch (const JsonError&) {
    throw RunError(kOtherBuild);
  }
}

}  // namespace gauntlet::sim
