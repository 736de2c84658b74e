#include "sim/recordings/inspect/row_groups.h"

#include <algorithm>
#include <cmath>

#include "controller/number.h"

namespace gauntlet::sim {
namespace {

constexpr std::size_t kMostGroups = 4096;
constexpr std::size_t kMostAlternating = 64;

}  // namespace

void RowGroups::Steps::Add(double step) {
  if (!std::isfinite(step)) return;
  sum += std::abs(step);
  count += 1.0;
}

double RowGroups::Steps::mean() const { return count > 0.0 ? sum / count : controller::kNaN; }

RowGroups::RowGroups(std::size_t column, std::size_t columns)
    : column_(column), at_changes_(columns), within_(columns), own_(columns) {}

void RowGroups::Add(double time_s, double group, std::span<const double> values) {
  if (is_over_ || std::isnan(group)) return;
  const auto known = last_of_.find(group);
  if (known == last_of_.end() && last_of_.size() == kMostGroups) {
    is_over_ = true;
    return;
  }
  const bool changes = before_ && *before_ != group;
  const double interval_s = time_s - before_s_;
  constexpr double kGapPerInterval = 5.0;
  // Without a time every row follows the one before.
  const bool follows = std::isnan(interval_s) ||
                       (interval_s >= 0.0 && !(interval_s > kGapPerInterval * interval_s_.mean()));
  for (std::size_t c = 0; before_ && follows && c < values.size(); ++c) {
    (changes ? at_changes_ : within_)[c].Add(values[c] - last_[c]);
  }
  if (known != last_of_.end()) {
    for (std::size_t c = 0; c < values.size(); ++c) own_[c].Add(values[c] - known->second[c]);
  }
  if (before_ && interval_s >= 0.0) interval_s_.Add(interval_s);
  changes_ += changes ? 1 : 0;
  returns_ += changes && known != last_of_.end() ? 1 : 0;
  ++rows_;
  before_ = group;
  before_s_ = time_s;
  last_.assign(values.begin(), values.end());
  last_of_[group] = last_;
}

bool RowGroups::Alternate(std::span<const std::size_t> sensors) const {
  constexpr double kOften = 0.3;  // of the rows
  constexpr double kSmaller = 3.0;
  const bool take_turns = static_cast<double>(returns_) > kOften * static_cast<double>(rows_);
  if (is_over_ || !take_turns || last_of_.size() > kMostAlternating) return false;
  const auto differ = std::ranges::count_if(
      sensors, [this](std::size_t c) { return at_changes_[c].mean() > kSmaller * own_[c].mean(); });
  return 2 * static_cast<std::size_t>(differ) > sensors.size();
}

bool RowGroups::Jump(std::span<const std::size_t> sensors) const {
  constexpr double kOften = 0.1;  // of the rows: groups of fewer rows are no sessions
  constexpr double kLarger = 3.0;
  const bool is_often = static_cast<double>(changes_) > kOften * static_cast<double>(rows_);
  if (is_over_ || is_often) return false;
  const auto jumps = std::ranges::count_if(sensors, [this](std::size_t c) {
    return at_changes_[c].mean() > kLarger * within_[c].mean();
  });
  return 2 * static_cast<std::size_t>(jumps) > sensors.size();
}

}  // namespace gauntlet::sim
