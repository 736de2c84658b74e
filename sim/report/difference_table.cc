#include "sim/report/difference_table.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "sim/score/score.h"

namespace gauntlet::sim {
namespace {

using Row = std::array<std::string, 7>;

std::string SeedsText(std::vector<int> seeds) {
  std::sort(seeds.begin(), seeds.end());
  const int count = seeds.size();
  if (count == 1) return fmt::format("seed {}", seeds[0]);
  if (seeds.back() - seeds.front() == count - 1) {
    return fmt::format("seeds {} to {}", seeds.front(), seeds.back());
  }
  return fmt::format("seeds {}", fmt::join(seeds, ", "));
}

std::string ValueText(const std::optional<std::string>& value) {
  if (!value) return "(none)";
  return value->empty() ? "\"\"" : *value;
}

void AppendSettings(const std::string& title, const std::vector<SettingDifference>& settings,
                    std::string& out) {
  if (settings.empty()) return;
  out += "\n" + title + "\n";
  for (const SettingDifference& setting : settings) {
    out += fmt::format("  {}: {} -> {}\n", setting.key, ValueText(setting.a), ValueText(setting.b));
  }
}

void AppendNames(const std::string& title, const std::vector<std::string>& names,
                 std::string& out) {
  if (!names.empty()) out += fmt::format("{}: {}\n", title, fmt::join(names, ", "));
}

/// " of the common seeds 1 to 4" where A or B has others besides; these are not compared.
std::string OfCommonSeeds(const StudyFolder& a, const StudyFolder& b,
                          const StudyDifference& difference) {
  const std::size_t common = difference.common_seeds.size();
  if (common == 0 || common == std::max(a.scores.seeds.size(), b.scores.seeds.size())) return "";
  return fmt::format(" of the common {}", SeedsText(difference.common_seeds));
}

std::string MethodText(const StudyDifference& difference) {
  switch (difference.method) {
    case DifferenceMethod::kPaired:
      return "paired by seed, with the 95 % interval of B - A";
    case DifferenceMethod::kUnpaired:
      return "no seed in common, so unpaired, with the 95 % interval of B - A";
    case DifferenceMethod::kPlain:
      return difference.common_seeds.empty()
                 ? "no seed in common and one seed has no interval, so every difference counts, "
                   "also "
                   "by chance"
                 : "one seed has no interval, so every difference counts";
  }
  return "";
}

Row RowOf(const ScoreDifference& score) {
  const MeanInterval& difference = score.difference;
  Row row{score.controller,
          std::string(Metrics()[score.metric].key),
          Short(score.a),
          Short(score.b),
          "-",
          "-",
          std::string(ChangeText(score.change))};
  if (std::isfinite(difference.mean)) row[4] = fmt::format("{:+.3g}", difference.mean);
  if (std::isfinite(difference.low)) {
    row[5] = fmt::format("{:+.3g} to {:+.3g}", difference.low, difference.high);
  }
  return row;
}

std::string Coloured(const std::string& text, ScoreChange change, bool colour) {
  if (!colour || change == ScoreChange::kNone) return text;
  return change == ScoreChange::kBetter ? Good(text) : Warning(text);
}

/// Rows below the names of their controllers, for terminals on which a whole row is too wide.
void AppendByController(const std::vector<Row>& rows, const std::vector<ScoreChange>& changes,
                        const TerminalStyle& style, std::string& out) {
  for (std::size_t first = 1; first < rows.size();) {
    std::size_t end = first;
    std::vector<std::string> scores;
    while (end < rows.size() && rows[end][0] == rows[first][0]) scores.push_back(rows[end++][1]);
    std::vector<TableColumn> columns;
    for (std::size_t c = 2; c < rows[0].size(); ++c) {
      TableColumn& column = columns.emplace_back(TableColumn{.head = {rows[0][c]}, .rows = {}});
      const bool judges = c + 1 == rows[0].size();
      for (std::size_t r = first; r < end; ++r) {
        const char mark = !judges || changes[r] == ScoreChange::kNone ? ' '
                          : changes[r] == ScoreChange::kBetter        ? '*'
                                                                      : '!';
        column.rows.push_back({TableColumn::Line{.text = rows[r][c], .mark = mark}});
      }
    }
    if (first > 1) out += "\n";
    out += TableText(rows[first][0], scores, columns, style);
    first = end;
  }
}

void AppendScores(const StudyDifference& difference, const std::string& of_seeds,
                  const DifferenceTableOptions& options, std::string& out) {
  std::vector<Row> rows = {{"controller", "score", "A", "B", "B - A", "95 % interval", "B is"}};
  std::vector<ScoreChange> changes = {ScoreChange::kNone};
  for (const ScoreDifference& score : difference.scores) {
    if (score.change == ScoreChange::kNone && !options.all) continue;
    rows.push_back(RowOf(score));
    changes.push_back(score.change);
  }
  if (rows.size() == 1) return;
  std::array<std::size_t, std::tuple_size_v<Row>> widths{};
  for (const Row& row : rows) {
    for (std::size_t i = 0; i < row.size(); ++i) widths[i] = std::max(widths[i], Width(row[i]));
  }
  out += fmt::format("\nscores{}, {}:\n", of_seeds, MethodText(difference));
  if (std::accumulate(widths.begin(), widths.end(), 2 * (widths.size() - 1)) >
      options.style.table_width) {
    AppendByController(rows, changes, options.style, out);
    return;
  }
  for (std::size_t r = 0; r < rows.size(); ++r) {
    for (std::size_t i = 0; i + 1 < rows[r].size(); ++i) {
      out += Padded(rows[r][i], widths[i], i >= 2) + "  ";
    }
    out += Coloured(rows[r].back(), changes[r], options.style.colour) + "\n";
  }
}

std::string Count(std::size_t count, const std::string& what) {
  return fmt::format("{} {}{}", count, what, count == 1 ? "" : "s");
}

std::string VerdictOf(const StudyDifference& difference, const std::string& of_seeds) {
  const std::size_t names =
      difference.controllers_only_in_a.size() + difference.controllers_only_in_b.size() +
      difference.channels_only_in_a.size() + difference.channels_only_in_b.size();
  const std::size_t changed = difference.ChangedScores();
  if (difference.Same()) {
    return fmt::format("A and B have the same settings, and {}{} without a difference{}.",
                       Count(difference.scores.size(), "score"), of_seeds,
                       difference.method == DifferenceMethod::kPlain ? "" : " beyond chance");
  }
  std::string text = fmt::format("A and B differ in {} and in {} of {}{}",
                                 Count(difference.settings.size(), "setting"), changed,
                                 Count(difference.scores.size(), "score"), of_seeds);
  if (names > 0) text += fmt::format("; {} in one of them only", names);
  if (changed > 0 && difference.method != DifferenceMethod::kPlain) {
    text += "; by chance alone about 1 score in 20 leaves its interval";
  }
  return text + ".";
}

}  // namespace

std::string DifferenceTable(const StudyFolder& a, const StudyFolder& b,
                            const StudyDifference& difference,
                            const DifferenceTableOptions& options) {
  std::string out;
  const std::size_t width = std::max(Width(a.name), Width(b.name));
  for (const auto& [letter, folder] : {std::pair("A", &a), std::pair("B", &b)}) {
    out += fmt::format("{}: {}  {}, {}, Gauntlet {}\n", letter, Padded(folder->name, width, false),
                       folder->scenario.name, SeedsText(folder->scores.seeds),
                       folder->scenario.made_with.gauntlet_version);
  }
  AppendSettings("settings, A -> B:", difference.settings, out);
  AppendSettings("versions, A -> B:", difference.versions, out);
  std::string names;
  AppendNames("controllers only in A", difference.controllers_only_in_a, names);
  AppendNames("controllers only in B", difference.controllers_only_in_b, names);
  AppendNames("channels only in A", difference.channels_only_in_a, names);
  AppendNames("channels only in B", difference.channels_only_in_b, names);
  AppendNames("scores that only A knows", difference.metrics_only_in_a, names);
  AppendNames("scores that only B knows", difference.metrics_only_in_b, names);
  if (!names.empty()) out += "\n" + names;
  const std::string of_seeds = OfCommonSeeds(a, b, difference);
  AppendScores(difference, of_seeds, options, out);
  return out + "\n" + VerdictOf(difference, of_seeds) + "\n";
}

}  // namespace gauntlet::sim
