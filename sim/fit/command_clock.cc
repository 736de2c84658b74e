#include "sim/fit/command_clock.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <numeric>

#include "controller/assert.h"
#include "controller/calibration/robust_statistics.h"

namespace gauntlet::sim {
namespace {

using Eigen::Index;

/// A row with a changed command (the first row of a frame), and the frame's number.
struct Change {
  double row = 0.0;
  double size = 0.0;
  double frame = 0.0;
};

std::vector<Change> ChangesIn(std::span<const double> sizes) {
  std::vector<Change> changes;
  for (std::size_t row = 0; row < sizes.size(); ++row) {
    if (sizes[row] > 0.0) changes.push_back({.row = static_cast<double>(row), .size = sizes[row]});
  }
  return changes;
}

double RowsOf(std::span<const Change> changes) {
  GAUNTLET_ASSERT(!changes.empty());
  return changes.back().row - changes.front().row;
}

/// Shortest arc of the period that contains the phases of all changes.
struct Arc {
  double begin_rows = 0.0;
  double rows = 0.0;
};

Arc ArcOf(std::span<const Change> changes, double period_rows) {
  GAUNTLET_ASSERT(!changes.empty() && period_rows > 0.0);
  std::vector<double> phases;
  phases.reserve(changes.size() + 1);
  for (const Change& change : changes) phases.push_back(std::fmod(change.row, period_rows));
  std::ranges::sort(phases);
  phases.push_back(phases.front() + period_rows);
  double widest = 0.0;  // widest gap between two phases
  double begin = 0.0;
  for (std::size_t i = 1; i < phases.size(); ++i) {
    if (phases[i] - phases[i - 1] <= widest) continue;
    widest = phases[i] - phases[i - 1];
    begin = phases[i];
  }
  return {.begin_rows = begin, .rows = period_rows - widest};
}

/// Jitter tolerance [rows]: share min(1, period - 1). Frames that are further from their clock
/// appear in rows that do not belong to them. For periods of two rows and more it is a share of a
/// row.
double ShareOf(double share, double period_rows) {
  return share * std::min(1.0, period_rows - 1.0);
}
/// Largest spread of the changes beyond one row, as a share in ShareOf().
constexpr double kJitter = 0.25;

/// Clock with this period and the given frame numbers. Each frame is sent between its row and the
/// row before. open_rows: by how much all frames can be shifted; if negative, the missing amount.
CommandClock ClockOfPeriod(std::span<const Change> changes, double period_rows) {
  double after = -1e300;
  double by = 1e300;
  for (const Change& change : changes) {
    const double row = change.row - change.frame * period_rows;
    after = std::max(after, row - 1.0);
    by = std::min(by, row);
  }
  return {
      .period_rows = period_rows, .first_row = 0.5 * (after + by), .open_rows = 0.5 * (by - after)};
}

/// The clock near `period_rows` with the largest open_rows, found by ternary search because
/// open_rows is concave over the period. None if a frame exceeds the jitter tolerance.
std::optional<CommandClock> BestClock(std::vector<Change> changes, double period_rows) {
  const Arc arc = ArcOf(changes, period_rows);
  const double middle = arc.begin_rows + 0.5 * arc.rows;
  for (Change& change : changes) change.frame = std::round((change.row - middle) / period_rows);
  const double width = 2.0 / (changes.back().frame - changes.front().frame);
  double low = period_rows - width;
  double high = period_rows + width;
  for (int i = 0; i < 60; ++i) {
    const double third = (high - low) / 3.0;
    const bool rises = ClockOfPeriod(changes, low + third).open_rows <
                       ClockOfPeriod(changes, high - third).open_rows;
    (rises ? low : high) = rises ? low + third : high - third;
  }
  const CommandClock clock = ClockOfPeriod(changes, 0.5 * (low + high));
  if (clock.open_rows < -0.5 * ShareOf(kJitter, clock.period_rows)) return std::nullopt;
  return clock;
}

/// True if the changes may be quantisation steps of a smooth command. Such steps have equal sizes,
/// or are larger where the command is fast and no row repeats a value.
bool MayBeRounded(std::span<const Change> changes, double period_rows) {
  GAUNTLET_ASSERT(changes.size() >= 2);
  constexpr double kAsLarge = 1.2;
  constexpr double kSmaller = 0.6;
  constexpr double kTooFew = 10.0;
  const double shorter = std::floor(period_rows);
  double least = changes[1].size;
  double sum = 0.0;
  double sums[2] = {0.0, 0.0};  // after floor(period) rows, and after one row more
  double count[2] = {0.0, 0.0};
  for (std::size_t i = 1; i < changes.size(); ++i) {
    least = std::min(least, changes[i].size);
    sum += changes[i].size;
    const double gap = changes[i].row - changes[i - 1].row;
    if (gap != shorter && gap != shorter + 1.0) continue;
    const int longer = gap == shorter ? 0 : 1;
    sums[longer] += changes[i].size;
    ++count[longer];
  }
  if (sum < kAsLarge * least * static_cast<double>(changes.size() - 1)) return true;
  if (count[0] < kTooFew || count[1] < kTooFew) return false;
  return sums[1] / count[1] < kSmaller * sums[0] / count[0];
}

/// -ln P(no row has a change) for this number of random changes. There are about 10^7
/// distinguishable clocks, so at kLeastSurprise one of them fits by chance with a probability of
/// 10^-6.
double SurpriseOf(std::span<const Change> changes) {
  const double rows = RowsOf(changes);
  return -std::log1p(-static_cast<double>(changes.size() - 1) / rows) * rows;
}
constexpr double kLeastSurprise = 30.0;

/// Share of the rows that are further from the middle of the changed rows than all changes. Random
/// changes would also fall into these rows. A period of 3/2 or 4/3 has no such rows.
double ShareWithoutFrame(const Arc& arc, double period_rows, double first_row, double rows) {
  constexpr double kRounding = 1e-6;
  const double half = std::max(0.5 * arc.rows, 0.5 - kRounding) + 0.5 * kRounding;
  const double middle = arc.begin_rows + 0.5 * arc.rows;
  const auto count = static_cast<Index>(rows);
  Index without = 0;
  for (Index i = 0; i < count; ++i) {
    const double row = first_row + static_cast<double>(i);
    if (std::abs(std::remainder(row - middle, period_rows)) > half) ++without;
  }
  return static_cast<double>(without) / rows;
}

/// None if chance or a slow motion may explain the clock.
std::optional<CommandClock> SurprisingClock(const std::vector<Change>& changes,
                                            double period_rows) {
  std::optional<CommandClock> clock = BestClock(changes, period_rows);
  if (!clock || MayBeRounded(changes, clock->period_rows)) return std::nullopt;
  const double share = ShareWithoutFrame(ArcOf(changes, clock->period_rows), clock->period_rows,
                                         changes.front().row, RowsOf(changes));
  if (!(share * SurpriseOf(changes) >= kLeastSurprise)) return std::nullopt;
  clock->open_rows = std::max(clock->open_rows, 0.0);
  return clock;
}

/// Range of changes [begin, end), and range of periods.
struct Search {
  std::size_t begin;
  std::size_t end;
  double low_rows;
  double high_rows;
};

/// Step between two tried periods, as a share in ShareOf().
constexpr double kPeriodStep = 0.1;

/// True if all changes may have this period, or one that differs by half a step.
bool MayBear(std::span<const Change> changes, double period_rows) {
  constexpr double kManyRows = 200.0;
  const Arc arc = ArcOf(changes, period_rows);
  if (arc.rows > 1.0 + ShareOf(kJitter + kPeriodStep, period_rows)) return false;
  const double without = ShareWithoutFrame(arc, period_rows, changes.front().row,
                                           std::max(RowsOf(changes), kManyRows));
  return without > 0.5 * (1.0 - 1.0 / period_rows);  // half the share for exact frames
}

/// The longest period that explains all changes. A period that explains a part of them is refined
/// with as many changes more on each side: more changes determine the period better.
std::optional<CommandClock> LongestPeriod(const std::vector<Change>& changes,
                                          const Search& search) {
  const std::span part(changes.begin() + static_cast<std::ptrdiff_t>(search.begin),
                       changes.begin() + static_cast<std::ptrdiff_t>(search.end));
  double period = search.high_rows;
  while (period > search.low_rows) {
    const double step = ShareOf(kPeriodStep, period) * period / RowsOf(part);
    if (MayBear(part, period)) {
      const auto found =
          part.size() == changes.size()
              ? SurprisingClock(changes, period)
              : LongestPeriod(changes, {.begin = search.begin - std::min(search.begin, part.size()),
                                        .end = std::min(search.end + part.size(), changes.size()),
                                        .low_rows = std::max(period - 0.5 * step, search.low_rows),
                                        .high_rows = period + 0.5 * step});
      if (found) return found;
    }
    period -= step;
  }
  return std::nullopt;
}

/// First of `count` consecutive changes that span the fewest rows.
std::size_t DensestPart(const std::vector<Change>& changes, std::size_t count) {
  std::size_t densest = 0;
  for (std::size_t i = 0; i + count <= changes.size(); ++i) {
    const auto rows = [&](std::size_t first) {
      return changes[first + count - 1].row - changes[first].row;
    };
    if (rows(i) < rows(densest)) densest = i;
  }
  return densest;
}

std::optional<CommandClock> ClockBetweenRows(const std::vector<Change>& changes) {
  constexpr std::size_t kFirstPart = 32;
  constexpr double kLeastPeriod_rows = 1.04;
  constexpr double kChanging = 0.9;  // least share of frames with a change in the densest part
  if (changes.size() < kFirstPart) return std::nullopt;
  const std::size_t begin = DensestPart(changes, kFirstPart);
  const double rows = changes[begin + kFirstPart - 1].row - changes[begin].row;
  const double gaps = static_cast<double>(kFirstPart - 1);
  return LongestPeriod(changes, {.begin = begin,
                                 .end = begin + kFirstPart,
                                 .low_rows = std::max(kLeastPeriod_rows, kChanging * rows / gaps),
                                 .high_rows = (rows + 2.0) / gaps});
}

/// Clock with frames at every n-th row, n >= 2; none if changes come at other distances.
std::optional<CommandClock> ClockAtRows(std::span<const Change> changes) {
  constexpr Index kLeastChanges = 20;  // fewer may have this distance by chance
  if (std::ssize(changes) < kLeastChanges) return std::nullopt;
  const double first = changes.front().row;
  std::int64_t rows = 0;
  for (const Change& change : changes) rows = std::gcd(rows, std::llround(change.row - first));
  if (rows < 2) return std::nullopt;
  return CommandClock{.period_rows = static_cast<double>(rows), .first_row = first};
}

}  // namespace

double CommandClock::SentAt(Index row) const {
  const double middle = static_cast<double>(row) - 0.5;
  const double frame = std::round((middle - first_row) / period_rows);
  return std::clamp(first_row + frame * period_rows, middle - 0.5, middle + 0.5);
}

std::vector<double> ChangesOf(std::span<const double> command_deg) {
  constexpr double kStill = 1e-6;  // of the travel; rounding errors
  std::vector<double> changes(command_deg.size(), 0.0);
  if (command_deg.empty()) return changes;
  const auto [least, most] = std::ranges::minmax(command_deg);
  for (std::size_t k = 1; k < changes.size(); ++k) {
    const double change = std::abs(command_deg[k] - command_deg[k - 1]);
    if (change > kStill * (most - least)) changes[k] = change / (most - least);
  }
  return changes;
}

std::vector<double> ChangesOf(const Signal& command_deg) {
  std::vector<double> sum(static_cast<std::size_t>(command_deg.rows()), 0.0);
  for (Index part = 0; part < command_deg.cols(); ++part) {
    const auto column = command_deg.col(part);
    const std::vector<double> changes = ChangesOf(std::span(column.data(), sum.size()));
    std::ranges::transform(sum, changes, sum.begin(), std::plus());
  }
  return sum;
}

std::optional<CommandClock> FindCommandClock(std::span<const double> changes) {
  const std::vector<Change> found = ChangesIn(changes);
  if (const auto at_rows = ClockAtRows(found)) return at_rows;
  return ClockBetweenRows(found);
}

std::optional<CommandClock> StepsOf(std::span<const double> changes) {
  constexpr double kMostChanging = 0.1;  // of the rows
  constexpr double kLeastStep = 0.05;    // of the travel, for half of the steps
  constexpr std::size_t kFewSteps = 8;   // fewer may have an even distance by chance
  constexpr double kKnown_rows = 0.4;
  const std::vector<Change> steps = ChangesIn(changes);
  std::vector<double> sizes;
  for (const Change& change : steps) sizes.push_back(change.size);
  if (sizes.empty() || std::ssize(sizes) > kMostChanging * std::ssize(changes)) return std::nullopt;
  if (controller::MedianOf(std::move(sizes)) < kLeastStep) return std::nullopt;
  if (steps.size() >= kFewSteps) {
    const auto clock = BestClock(steps, RowsOf(steps) / static_cast<double>(steps.size() - 1));
    if (clock && 0.0 <= clock->open_rows && clock->open_rows < kKnown_rows) return clock;
  }
  return CommandClock{.period_rows = 1.0, .first_row = 0.5, .open_rows = 0.5};
}

}  // namespace gauntlet::sim
