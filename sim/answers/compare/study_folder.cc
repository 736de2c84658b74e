#include "sim/answers/compare/study_folder.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <limits>
#include <optional>
#include <set>
#include <tuple>

#include "controller/number.h"
#include "sim/base/csv_line.h"
#include "sim/base/error.h"
#include "sim/base/json.h"
#include "sim/base/limited_text.h"
#include "sim/base/manifest.h"
#include "sim/base/text.h"
#include "sim/score/score.h"
#include "sim/study/scenario/scenario_reader.h"

namespace gauntlet::sim {
namespace {

constexpr std::array<std::string_view, 3> kKeyColumns = {"seed", "controller", "channel"};
constexpr std::string_view kSummary = "summary";

[[noreturn]] void Fail(const std::string& name, std::size_t row, const std::string& problem) {
  throw UserError({.place = fmt::format("{}:{}", name, row), .problem = problem});
}

[[noreturn]] void Fail(const std::string& name, std::size_t row, std::size_t column,
                       const std::string& problem) {
  throw UserError({.place = fmt::format("{}:{}:{}", name, row, column), .problem = problem});
}

/// The place of `value` in `list`, where it is added if it is new.
template <class Value>
std::size_t PlaceOf(std::vector<Value>& list, const Value& value) {
  const auto found = std::find(list.begin(), list.end(), value);
  const auto place = static_cast<std::size_t>(found - list.begin());
  if (found == list.end()) list.push_back(value);
  return place;
}

/// The metric of each column behind the key columns.
std::vector<std::size_t> PlacesOfMetrics(const std::string& name, std::string_view line) {
  const std::vector<std::string_view> columns = SplitCells(line);
  for (std::size_t i = 0; i < kKeyColumns.size(); ++i) {
    if (i < columns.size() && columns[i] == kKeyColumns[i]) continue;
    Fail(name, 1, fmt::format("must begin with the columns {}", fmt::join(kKeyColumns, ",")));
  }
  std::vector<std::size_t> metrics;
  for (std::size_t i = kKeyColumns.size(); i < columns.size(); ++i) {
    const auto metric = FindMetric(columns[i]);
    if (!metric) {
      Fail(name, 1, i + 1,
           fmt::format("unknown column {}; written by another version?", columns[i]));
    }
    if (std::ranges::find(metrics, *metric) != metrics.end()) {
      Fail(name, 1, i + 1, fmt::format("column {} appears twice", columns[i]));
    }
    metrics.push_back(*metric);
  }
  return metrics;
}

struct Row {
  int seed;
  std::string controller;
  std::string channel;
  std::vector<double> values;  // NaN where the field is empty
};

Row ParseRow(const std::string& name, std::size_t number, std::string_view line,
             const std::vector<std::size_t>& metrics) {
  const std::vector<std::string_view> fields = SplitCells(line);
  const std::size_t field_count = kKeyColumns.size() + metrics.size();
  if (fields.size() != field_count) {
    Fail(name, number, fmt::format("has {} fields, must have {}", fields.size(), field_count));
  }
  constexpr int kMostSeed = std::numeric_limits<int>::max();
  const auto seed = controller::ParseWholeNumber(fields[0], -kMostSeed, kMostSeed);
  if (!seed) {
    Fail(name, number, 1, fmt::format("seed is \"{}\", must be a whole number", fields[0]));
  }
  for (const std::size_t i : {1, 2}) {
    if (const std::string problem = NameProblem(fields[i]); !problem.empty()) {
      Fail(name, number, i + 1, problem);
    }
  }
  Row row{.seed = static_cast<int>(*seed),
          .controller = std::string(fields[1]),
          .channel = std::string(fields[2]),
          .values = std::vector<double>(Metrics().size(), kNaN)};
  for (std::size_t i = kKeyColumns.size(); i < fields.size(); ++i) {
    const std::size_t metric = metrics[i - kKeyColumns.size()];
    const std::optional<double> value =
        fields[i].empty() ? kNaN : controller::ParseNumber(fields[i]);
    if (!value) {
      Fail(name, number, i + 1,
           fmt::format("{} is \"{}\", must be a number, or empty where there is no score",
                       Metrics()[metric].key, fields[i]));
    }
    row.values[metric] = *value;
  }
  return row;
}

}  // namespace

ScoreFile ParseScoresCsv(const std::string& name, std::string_view text) {
  const std::vector<std::string_view> lines = SplitLines(text);
  if (lines.size() < 2) throw UserError({.place = name, .problem = "holds no scores"});
  const std::vector<std::size_t> metrics = PlacesOfMetrics(name, lines[0]);
  ScoreFile file;
  file.has_metric.assign(Metrics().size(), false);
  for (const std::size_t metric : metrics) file.has_metric[metric] = true;
  std::vector<Row> rows;
  std::set<std::tuple<int, std::string, std::string>> seen;
  for (std::size_t i = 1; i < lines.size(); ++i) {
    Row row = ParseRow(name, i + 1, lines[i], metrics);
    if (!seen.insert({row.seed, row.controller, row.channel}).second) {
      Fail(name, i + 1, "seed, controller and channel appear twice");
    }
    PlaceOf(file.seeds, row.seed);
    PlaceOf(file.controllers, row.controller);
    if (row.channel != kSummary) PlaceOf(file.channels, row.channel);
    rows.push_back(std::move(row));
  }
  const std::size_t expected =
      file.seeds.size() * file.controllers.size() * (file.channels.size() + 1);
  if (rows.size() != expected) {
    throw UserError(
        {.place = name,
         .problem = fmt::format("has {} rows, must have {}: one per seed, controller and channel",
                                rows.size(), expected)});
  }
  file.summary.assign(
      file.controllers.size(),
      std::vector<std::vector<double>>(Metrics().size(), std::vector<double>(file.seeds.size())));
  for (const Row& row : rows) {
    if (row.channel != kSummary) continue;
    auto& controller = file.summary[PlaceOf(file.controllers, row.controller)];
    const std::size_t seed = PlaceOf(file.seeds, row.seed);
    for (std::size_t m = 0; m < row.values.size(); ++m) controller[m][seed] = row.values[m];
  }
  return file;
}

bool HoldsComparison(const std::filesystem::path& folder) {
  std::error_code unreadable;
  if (!std::filesystem::is_regular_file(folder / "scores.json", unreadable)) return false;
  const Json scores = Json::parse_or_discard(
      LimitedTextIfAny(folder / "scores.json", kMostScoreBytes).value_or(""));
  return scores.is_object() && scores.contains("seeds");
}

StudyFolder ReadStudyFolder(const std::filesystem::path& folder) {
  const Manifest manifest(folder);
  const std::filesystem::path resolved = manifest.Checked("scenario.resolved.yaml");
  const std::filesystem::path scores = manifest.Checked("scores.csv");
  return {.name = OneLine(folder.string()),
          .scenario = LoadScenario(resolved, {}),
          .scores = ParseScoresCsv(scores.string(), LimitedText(scores, kMostScoreBytes)),
          .checked = manifest.exists()};
}

}  // namespace gauntlet::sim
