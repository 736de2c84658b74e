#include "sim/recordings/clipping.h"

#include <algorithm>
#include <cmath>

namespace gauntlet::sim {
namespace {

constexpr double kShortestClipped_s = 0.1;

/// Rows with the same value, one after another.
struct Run {
  RowRange rows;
  std::size_t count = 0;  // of rows that are not missing
  double value = 0.0;
};

std::vector<Run> Runs(std::span<const double> value) {
  std::vector<Run> runs;
  for (std::size_t i = 0; i < value.size(); ++i) {
    if (!std::isfinite(value[i])) continue;
    if (runs.empty() || runs.back().value != value[i]) {
      runs.push_back({.rows = {i, i}, .value = value[i]});
    }
    runs.back().rows.end = i + 1;
    ++runs.back().count;
  }
  return runs;
}

}  // namespace

std::vector<RowRange> FindClipped(std::span<const double> time_s, std::span<const double> value) {
  const std::vector<Run> runs = Runs(value);
  if (runs.size() < 2) return {};
  const auto [lowest, highest] = std::ranges::minmax_element(runs, {}, &Run::value);
  const double low = lowest->value;
  const double high = highest->value;
  std::size_t longest_elsewhere = 1;
  for (const Run& run : runs) {
    const bool at_an_end = run.value == low || run.value == high;
    if (!at_an_end) longest_elsewhere = std::max(longest_elsewhere, run.count);
  }
  std::vector<RowRange> clipped;
  for (const Run& run : runs) {
    if (run.value != low && run.value != high) continue;
    const double seconds = time_s[run.rows.end - 1] - time_s[run.rows.begin];
    if (run.count > longest_elsewhere && seconds >= kShortestClipped_s) clipped.push_back(run.rows);
  }
  return clipped;
}

}  // namespace gauntlet::sim
