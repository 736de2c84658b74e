#include "sim/show/video/score_board.h"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>

#include "sim/base/error.h"
#include "sim/base/json.h"
#include "sim/base/limited_text.h"
#include "sim/show/figure/palette.h"

namespace gauntlet::sim {
namespace {

/// A column: a metric, and how its numbers are written.
struct Column {
  const char* title;
  const char* metric;
  int decimals;
  const char* unit;
};

constexpr Column kColumns[] = {{"tracking error", "tracking_rmse_deg", 2, "°"},
                               {"delay", "delay_ms", 0, " ms"},
                               {"jitter", "jitter_rms_deg", 3, "°"}};

/// Adds the difference to the baseline, half of its interval if it has one, and its judgement.
void AddDifference(const Json& difference, const Column& column, ScoreBoardCell& cell) {
  if (!difference.at("verdict").is_string()) return;
  const std::string verdict = difference.at("verdict").get<std::string>();
  cell.detail = fmt::format("{:+.{}f}", difference.at("mean").get<double>(), column.decimals);
  if (difference.at("low").is_number()) {
    const double half =
        0.5 * (difference.at("high").get<double>() - difference.at("low").get<double>());
    cell.detail += fmt::format(" ± {:.{}f}", half, column.decimals);
  }
  cell.detail += ": " + (verdict == "equal" ? "equivalent" : verdict);
  if (verdict == "better") cell.tone = ScoreBoardCell::Tone::kBetter;
  if (verdict == "worse") cell.tone = ScoreBoardCell::Tone::kWorse;
}

/// `has_baseline`: the board shows what the differences are to.
ScoreBoardCell CellOf(const Json& controller, const Column& column, bool has_baseline) {
  const Json& score = controller.at("summary").at(column.metric);
  const Json& mean = score.is_object() ? score.at("mean") : score;  // a run has the value itself
  if (!mean.is_number()) return {.value = "–", .detail = {}};
  ScoreBoardCell cell = {
      .value = fmt::format("{:.{}f}{}", mean.get<double>(), column.decimals, column.unit),
      .detail = {}};
  if (has_baseline && controller.contains("difference_to_baseline")) {
    AddDifference(controller.at("difference_to_baseline").at(column.metric), column, cell);
  }
  return cell;
}

struct Replicates {
  std::size_t count = 0;
  bool are_blocks = false;
};

Replicates ReplicatesIn(const Json& scores) {
  if (!scores.contains("seeds")) return {.count = 1};
  const Json blocks = scores.value("blocks", Json::object()).value("replicates", Json::array());
  if (!blocks.empty()) return {.count = blocks.size(), .are_blocks = true};
  return {.count = scores.at("seeds").size()};
}

/// `baseline`: of the board; may be empty.
std::string RemarkOf(const Json& scores, const std::string& baseline) {
  const Replicates replicates = ReplicatesIn(scores);
  if (replicates.count < 2) return "One run: no confidence interval.";
  std::string from =
      fmt::format("{} {} {}.", replicates.are_blocks ? "Intervals from" : "Mean over",
                  replicates.count, replicates.are_blocks ? "blocks of the recording" : "seeds");
  if (baseline.empty()) return from;
  return fmt::format(
      "{}  Differences to {}, ± 95 % confidence interval.  Green: better.  Red: worse.", from,
      baseline);
}

/// The sentences of the verdict, without its warnings.
std::string AnswerOf(const Json& scores) {
  std::string text;
  for (const Json& reason :
       scores.value("verdict", Json::object()).value("reasons", Json::array())) {
    if (!text.empty()) text += ' ';
    text += reason.at("text").get<std::string>();
  }
  return text;
}

Json JsonIn(const std::filesystem::path& file) {
  return Json::parse(LimitedText(file, kMostScoreBytes));
}

[[noreturn]] void FailOf(const std::filesystem::path& file) {
  throw UserError({.place = file.string(), .problem = "is no scores.json of Gauntlet"});
}

}  // namespace

Excerpt SlowMotionOf(const DecisiveSecond& second) {
  constexpr double kSpeed = 0.25;
  return {.from_s = second.from_s, .to_s = second.to_s, .speed = kSpeed};
}

VideoPlan ReadVideoPlan(const std::filesystem::path& file) {
  try {
    const Json scores = JsonIn(file);
    VideoPlan plan;
    std::vector<std::string> names;
    for (const Json& controller : scores.at("controllers")) {
      names.push_back(controller.at("name").get<std::string>());
    }
    const Json baseline = scores.value("baseline", Json());
    // Older versions wrote no order.
    for (const std::string& name : scores.value("order", names).get<std::vector<std::string>>()) {
      const auto of = std::ranges::find_if(scores.at("controllers"),
                                           [&](const Json& one) { return one.at("name") == name; });
      if (of == scores.at("controllers").end()) FailOf(file);
      plan.controllers.push_back(
          {.name = name, .role = of->value("role", "").get<std::string>(), .series = 0});
    }
    std::vector<std::size_t> places(plan.controllers.size());
    std::iota(places.begin(), places.end(), std::size_t{0});
    const auto first = std::ranges::find_if(
        plan.controllers, [&](const auto& controller) { return baseline == controller.name; });
    const std::vector<std::size_t> series =
        SeriesOf(places, static_cast<std::size_t>(first - plan.controllers.begin()));
    for (const std::size_t i : places) plan.controllers[i].series = series[i];
    plan.shown = scores.value("shown", Json::array()).get<std::vector<std::string>>();
    const Json second = scores.value("decisive_second", Json());
    if (second.is_object()) {
      plan.again = SlowMotionOf(
          {.from_s = second.at("from_s").get<double>(), .to_s = second.at("to_s").get<double>()});
    }
    return plan;
  } catch (const JsonError&) {
    FailOf(file);
  }
}

ScoreBoard ReadScoreBoard(const std::filesystem::path& file,
                          const std::vector<std::string>& controllers) {
  try {
    const Json scores = JsonIn(file);
    const Json name_of_baseline = scores.value("baseline", Json());
    const auto baseline = std::ranges::find_if(
        controllers, [&](const std::string& name) { return name_of_baseline == name; });
    const bool has_baseline = baseline != controllers.end() && ReplicatesIn(scores).count > 1;
    ScoreBoard verdict = {.answer = AnswerOf(scores),
                          .columns = {},
                          .rows = {},
                          .remark = RemarkOf(scores, has_baseline ? *baseline : "")};
    for (const Column& column : kColumns) verdict.columns.emplace_back(column.title);
    for (const std::string& name : controllers) {
      const Json& all = scores.at("controllers");
      const auto found =
          std::ranges::find_if(all, [&](const Json& one) { return one.at("name") == name; });
      if (found == all.end())
        throw UserError({.place = file.string(), .problem = "has no controller " + name});
      ScoreBoardRow row = {.controller = name, .cells = {}};
      for (const Column& column : kColumns)
        row.cells.push_back(CellOf(*found, column, has_baseline));
      verdict.rows.push_back(std::move(row));
    }
    return verdict;
  } catch (const JsonError&) {
    FailOf(file);
  }
}

}  // namespace gauntlet::sim
