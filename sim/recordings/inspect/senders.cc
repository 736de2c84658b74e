#include "sim/recordings/inspect/senders.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "sim/base/signal.h"

namespace gauntlet::sim {
namespace {

constexpr std::size_t kMostGroups = 64;

std::string Ordinal(int number) {
  return fmt::format("{}{}", number, number == 2 ? "nd" : number == 3 ? "rd" : "th");
}

}  // namespace

std::string TextOf(const Senders& senders) {
  const std::string what = senders.older_s != 0.0
                               ? fmt::format("is {:.3g} s {}", std::abs(senders.older_s),
                                             senders.older_s > 0.0 ? "older" : "newer")
                               : fmt::format("has another level in {} sensors", senders.sensors);
  return fmt::format("two senders: every {} row {}; record one of them", Ordinal(senders.every),
                     what);
}

void ClockPair::Add(double time_s) {
  if (!std::isfinite(time_s)) return;
  ++rows_;
  // The clock that the time follows after the shortest step; a new one if it goes back.
  std::size_t best = 2;
  for (std::size_t i = 0; i < clocks_.size(); ++i) {
    const std::optional<double>& last_s = clocks_[i].last_s;
    if (!last_s || time_s < *last_s) continue;
    if (best == 2 || time_s - *last_s < time_s - *clocks_[best].last_s) best = i;
  }
  if (best == 2 && !clocks_[0].last_s) best = 0;
  if (best == 2 && !clocks_[1].last_s) best = 1;
  if (best == 2) {  // a restart, or rows in disorder
    ++misfits_;
    best = *clocks_[0].last_s - time_s < *clocks_[1].last_s - time_s ? 0 : 1;
    clocks_[best].last_s = time_s;
  }
  Clock& clock = clocks_[best];
  if (clock.rows > 0) {
    clock.steps_s += time_s - *clock.last_s;
    ++clock.gaps[std::min(rows_ - clock.last_row, kMostEvery)];
  }
  if (rows_ > 1 && best != before_) {
    changes_to_[best] += 1.0;
    older_s_[best] += *clocks_[before_].last_s - time_s;
  }
  ++clock.rows;
  clock.last_s = time_s;
  clock.last_row = rows_;
  before_ = best;
}

std::optional<ClockPair::Second> ClockPair::Find() const {
  constexpr std::size_t kFewestRows = 60;
  constexpr double kRare = 0.01;
  constexpr double kMostly = 0.7;
  constexpr double kChangesPerRow = 1.5;  // a row alone between those of the other sender: 2
  const std::size_t second = clocks_[1].rows <= clocks_[0].rows ? 1 : 0;
  const Clock& clock = clocks_[second];
  const auto rows = static_cast<double>(clock.rows);
  if (rows_ < kFewestRows || clock.rows * kMostEvery < rows_ ||
      static_cast<double>(misfits_) > kRare * static_cast<double>(rows_) ||
      changes_to_[0] + changes_to_[1] < kChangesPerRow * rows) {
    return std::nullopt;
  }
  const auto every = std::max_element(clock.gaps.begin(), clock.gaps.end() - 1);
  if (static_cast<double>(*every) < kMostly * rows) return std::nullopt;
  const double step_s = clock.steps_s / rows;
  const double older_s = older_s_[second] / changes_to_[second];
  if (!(step_s > 0.0) || older_s == 0.0) return std::nullopt;
  // Rows that have changed places are older by half a step of two senders.
  const double share = std::abs(older_s) / step_s;
  const int number = static_cast<int>(every - clock.gaps.begin());
  return Second{.every = number,
                .older_s = older_s,
                .may_be_order = number == 2 ? std::abs(share - 0.5) < 0.2 : share < 1.0};
}

SenderWatch::SenderWatch(std::size_t columns)
    : before_(columns, kNaN),
      before_that_(columns, kNaN),
      to_before_(columns),
      to_before_that_(columns) {}

void SenderWatch::Steps::Add(double step) {
  if (!std::isfinite(step)) return;
  sum += std::abs(step);
  count += 1.0;
}

double SenderWatch::Steps::mean() const { return count > 0.0 ? sum / count : kNaN; }

void SenderWatch::Add(double time_s, std::span<const double> values) {
  clock_.Add(time_s);
  for (std::size_t c = 0; c < values.size(); ++c) {
    to_before_[c].Add(values[c] - before_[c]);
    to_before_that_[c].Add(values[c] - before_that_[c]);
    before_that_[c] = std::exchange(before_[c], values[c]);
  }
}

std::optional<Senders> SenderWatch::Find(
    std::size_t clock, std::span<const std::pair<std::size_t, double>> sensors) const {
  constexpr double kSmaller = 3.0;
  constexpr double kFar = 0.2;  // of the range: hum at half the rate alternates by less
  std::vector<std::size_t> alternating;
  std::size_t moving = 0;
  for (const auto& [column, range] : sensors) {
    const double step = to_before_[column].mean();
    if (!(range > 0.0) || !(step > 0.0)) continue;
    ++moving;
    if (step > kFar * range && step > kSmaller * to_before_that_[column].mean()) {
      alternating.push_back(column);
    }
  }
  const bool have_levels = alternating.size() > 1 && 2 * alternating.size() > moving;
  const std::size_t with_levels = have_levels ? alternating.size() : 0;
  const std::optional<ClockPair::Second> found = clock_.Find();
  if (found && (have_levels || !found->may_be_order)) {
    return Senders{
        .column = clock, .every = found->every, .older_s = found->older_s, .sensors = with_levels};
  }
  if (!have_levels) return std::nullopt;
  return Senders{.column = alternating.front(), .sensors = with_levels};
}

void RowGroups::Add(double group) {
  if (std::isnan(group) || groups_.size() > kMostGroups) return;
  const bool is_known = !groups_.insert(group).second;
  returns_ += is_known && group != before_ ? 1.0 : 0.0;
  before_ = group;
  ++rows_;
}

std::size_t RowGroups::count() const { return groups_.size() > kMostGroups ? 0 : groups_.size(); }

bool RowGroups::Alternate() const {
  constexpr double kOften = 0.3;  // of the rows
  return count() > 1 && returns_ > kOften * rows_;
}

}  // namespace gauntlet::sim
