#include "sim/video/score_board.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string_view>

#include "sim/base/error.h"

namespace gauntlet::sim {
namespace {

using nlohmann::json;

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

bool Holds(const json& names, std::string_view name) {
  return std::ranges::any_of(names, [&](const json& one) { return one == name; });
}

/// The difference to the best and half of the interval that decides, as the table shows them.
std::string DetailOf(const json& difference, bool as_good, const Column& column) {
  if (!difference.at("mean").is_number()) return "best";
  const double half =
      0.5 * (difference.at("high").get<double>() - difference.at("low").get<double>());
  return fmt::format("+{:.{}f} ± {:.{}f}: {}", difference.at("mean").get<double>(), column.decimals,
                     half, column.decimals,
                     as_good ? "equivalent" : difference.at("verdict").get<std::string>());
}

ScoreBoardCell CellOf(const json& controller, const Column& column, bool one_run) {
  const json& score = controller.at("summary").at(column.metric);
  const json& mean = score.is_object() ? score.at("mean") : score;  // a run has the value itself
  if (!mean.is_number()) return {.value = "–", .detail = {}};
  ScoreBoardCell cell = {
      .value = fmt::format("{:.{}f}{}", mean.get<double>(), column.decimals, column.unit),
      .detail = {}};
  if (one_run) return cell;
  const bool as_good = Holds(controller.at("as_good_as_best"), column.metric);
  cell.detail = DetailOf(controller.at("difference_to_best").at(column.metric), as_good, column);
  if (Holds(controller.at("worse_than_baseline"), column.metric)) {
    cell.tone = ScoreBoardCell::Tone::kWorseThanBaseline;
  } else if (as_good) {
    cell.tone = ScoreBoardCell::Tone::kAsGoodAsBest;
  }
  return cell;
}

struct Replicates {
  std::size_t count = 0;
  bool are_blocks = false;
};

Replicates ReplicatesIn(const json& scores) {
  if (!scores.contains("seeds")) return {.count = 1};
  const json blocks = scores.value("blocks", json::object()).value("replicates", json::array());
  if (!blocks.empty()) return {.count = blocks.size(), .are_blocks = true};
  return {.count = scores.at("seeds").size()};
}

std::string RemarkOf(const json& scores, bool one_run) {
  if (one_run) return "One run: no confidence interval.";
  const std::string baseline =
      scores.at("baseline").is_string()
          ? "  Red: worse than " + scores.at("baseline").get<std::string>() + "."
          : "";
  const Replicates replicates = ReplicatesIn(scores);
  return fmt::format(
      "{} {} {}.  Green: best or equivalent.{}  Differences to the best, ± 95 % confidence "
      "interval.",
      replicates.are_blocks ? "Intervals from" : "Mean over", replicates.count,
      replicates.are_blocks ? "blocks of the recording" : "seeds", baseline);
}

}  // namespace

ScoreBoard ReadScoreBoard(const std::filesystem::path& file,
                          const std::vector<std::string>& controllers) {
  try {
    std::ifstream stream(file);
    const json scores = json::parse(stream);
    const bool one_run = ReplicatesIn(scores).count < 2;
    ScoreBoard verdict = {.columns = {}, .rows = {}, .remark = RemarkOf(scores, one_run)};
    for (const Column& column : kColumns) verdict.columns.emplace_back(column.title);
    for (const std::string& name : controllers) {
      const json& all = scores.at("controllers");
      const auto found =
          std::ranges::find_if(all, [&](const json& one) { return one.at("name") == name; });
      if (found == all.end())
        throw UserError({.place = file.string(), .problem = "has no controller " + name});
      ScoreBoardRow row = {.controller = name, .cells = {}};
      for (const Column& column : kColumns) row.cells.push_back(CellOf(*found, column, one_run));
      verdict.rows.push_back(std::move(row));
    }
    return verdict;
  } catch (const json::exception&) {
    throw UserError({.place = file.string(), .problem = "is no scores.json of Gauntlet"});
  }
}

}  // namespace gauntlet::sim
