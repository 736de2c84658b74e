#include "sim/recordings/table_statistics.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <stdexcept>
#include <utility>

#include "controller/calibration/robust_statistics.h"
#include "controller/number.h"
#include "sim/base/quantile.h"

namespace gauntlet::sim {
namespace {

constexpr std::size_t kMostKept = 8192;
constexpr int kWindow = 16;
constexpr std::size_t kMostLong = 4096;
// Limit with finite sums and squares, beyond the values of any glove or clock.
constexpr double kLargest = 1e100;
constexpr double kLatest_s = 1e12;
// A step of an angle that wraps, by as much as a hand may move from row to row besides.
constexpr double kTurn_deg = 360.0;
constexpr double kTurnTolerance_deg = 40.0;

/// Keeps every second row, beginning with the first; `width` values per row.
void Halve(std::vector<double>& values, std::size_t width) {
  std::size_t kept = 0;
  for (std::size_t row = 0; row * width < values.size(); row += 2, ++kept) {
    std::copy_n(values.begin() + static_cast<std::ptrdiff_t>(row * width), width,
                values.begin() + static_cast<std::ptrdiff_t>(kept * width));
  }
  values.resize(kept * width);
}

/// Share of the most frequent value among these.
double CommonestShare(std::vector<double> values) {
  if (values.empty()) return 0.0;
  std::ranges::sort(values);
  std::ptrdiff_t longest = 0;
  for (auto run = values.begin(); run != values.end();) {
    const auto behind = std::upper_bound(run, values.end(), *run);
    longest = std::max(longest, behind - run);
    run = behind;
  }
  return static_cast<double>(longest) / static_cast<double>(values.size());
}

/// Mean of the values within a fifth of their median: times that are rounded have a coarse median.
double MeanNearMedian(const std::vector<double>& values) {
  const double median = controller::MedianOf(values);
  double sum = 0.0, count = 0.0;
  for (const double value : values) {
    if (std::abs(value - median) > 0.2 * std::abs(median)) continue;
    sum += value;
    count += 1.0;
  }
  return sum / count;
}

/// Standard deviation of the means of four neighbours, from quantiles: spikes do not change it.
double SlowDeviation(const std::vector<double>& values) {
  constexpr std::size_t kNeighbours = 4;
  constexpr double kTail = 0.05;
  constexpr double kDeviations = 3.29;  // between the tails of a normal distribution
  std::vector<double> means;
  for (std::size_t i = 0; i + kNeighbours <= values.size(); i += kNeighbours) {
    double sum = 0.0;
    for (std::size_t k = i; k < i + kNeighbours; ++k) sum += values[k];
    means.push_back(sum / kNeighbours);
  }
  if (means.empty()) return 0.0;
  return (Quantile(means, 1.0 - kTail) - Quantile(means, kTail)) / kDeviations;
}

/// Numbers that programs write for a missing value.
bool IsUsualCode(double value) {
  constexpr std::array<double, 11> kCodes = {999.0,   -999.0,       9999.0,       -9999.0,
                                             99999.0, -99999.0,     32767.0,      -32768.0,
                                             65535.0, 2147483647.0, -2147483648.0};
  constexpr double kLeast = 999.0;  // asked of every value: most are below
  return std::abs(value) >= kLeast && std::ranges::find(kCodes, value) != kCodes.end();
}

void AddThinned(std::vector<double>& values, double value) {
  if (values.size() < 4 * kMostKept) values.push_back(value);
}

}  // namespace

double UsualInterval(std::span<const double> intervals_s) {
  std::vector<double> means_s;
  const std::size_t window = std::min<std::size_t>(kWindow, intervals_s.size());
  for (std::size_t i = 0; window > 0 && i + window <= intervals_s.size(); i += window) {
    double sum_s = 0.0;
    for (const double interval_s : intervals_s.subspan(i, window)) sum_s += interval_s;
    means_s.push_back(sum_s / static_cast<double>(window));
  }
  return means_s.empty() ? controller::kNaN : controller::MedianOf(means_s);
}

TableStatistics::TableStatistics(std::size_t columns)
    : columns_(columns), curvatures_(columns), steps_(columns) {}

void TableStatistics::Look(Watch& watch, double value) {
  if (IsUsualCode(value)) {
    ++watch.codes[value];
  } else if (watch.others++ == 0) {
    watch.other_low = watch.other_high = value;
  } else {
    watch.other_low = std::min(watch.other_low, value);
    watch.other_high = std::max(watch.other_high, value);
  }
  if (watch.seen.good_rows == 0) {
    watch.seen.low = watch.seen.high = value;
  } else {
    const double change = value - watch.before;
    if (change == 0.0) {
      ++watch.still_rows;
      watch.longest_run = std::max(watch.longest_run, ++watch.run);
    } else {
      watch.run = 0;
      const double step = std::abs(change);
      if (watch.seen.step == 0.0 || step < watch.seen.step) watch.seen.step = step;
      watch.falls += change < 0.0 ? 1 : 0;
      watch.ones += change == 1.0 ? 1 : 0;
      watch.seen.turns += std::abs(step - kTurn_deg) < kTurnTolerance_deg ? 1 : 0;
    }
  }
  if (value < watch.seen.low) watch.seen.low = value, watch.at_low = 0;
  if (value > watch.seen.high) watch.seen.high = value, watch.at_high = 0;
  watch.at_low += value == watch.seen.low ? 1 : 0;
  watch.at_high += value == watch.seen.high ? 1 : 0;
  watch.seen.is_whole = watch.seen.is_whole && value == std::floor(value);
  watch.before_that = watch.before;
  watch.before = value;
  ++watch.seen.good_rows;
}

void TableStatistics::AddTime(double time_s) {
  const double interval_s = time_s - last_s_.value_or(time_s);
  if (!std::exchange(last_s_, time_s)) return;
  if (interval_s < 0.0) {
    ++time_.restarts;
    return;
  }
  if (interval_s == 0.0) ++time_.repeats;
  time_.duration_s += interval_s;
  ++intervals_;
  if (interval_s > 0.0) {
    if (first_step_ == 0) first_step_ = intervals_, first_step_s_ = time_.duration_s;
    newest_step_ = intervals_;
    newest_step_s_ = time_.duration_s;
  }
  if (intervals_ % every_ == 0) AddThinned(intervals_s_, interval_s);
  window_s_ += interval_s;
  if (++in_window_ == kWindow) {
    AddThinned(window_means_s_, window_s_ / kWindow);
    window_s_ = 0.0;
    in_window_ = 0;
  }
  // Keeps the longest intervals. Gaps among them are known when the usual interval is.
  if (longest_s_.size() < kMostLong || interval_s > longest_s_.front()) {
    if (longest_s_.size() == kMostLong) {
      std::ranges::pop_heap(longest_s_, std::greater<>());
      longest_s_.pop_back();
    }
    longest_s_.push_back(interval_s);
    std::ranges::push_heap(longest_s_, std::greater<>());
  }
}

void TableStatistics::Keep(std::span<const double> values) {
  times_s_.push_back(time_.duration_s);
  values_.insert(values_.end(), values.begin(), values.end());
  kept_curvatures_.insert(kept_curvatures_.end(), curvatures_.begin(), curvatures_.end());
  kept_steps_.insert(kept_steps_.end(), steps_.begin(), steps_.end());
  if (times_s_.size() < kMostKept) return;
  Halve(times_s_, 1);
  Halve(values_, columns_.size());
  Halve(kept_curvatures_, columns_.size());
  Halve(kept_steps_, columns_.size());
  every_ *= 2;
}

void TableStatistics::Add(double time_s, std::span<const double> values) {
  if (values.size() != columns_.size()) throw std::logic_error("a row of another table");
  if (std::abs(time_s) <= kLatest_s) {
    AddTime(time_s);
  } else {
    ++time_.missing;
  }
  for (std::size_t c = 0; c < columns_.size(); ++c) {
    Watch& watch = columns_[c];
    curvatures_[c] = steps_[c] = controller::kNaN;
    if (!(std::abs(values[c]) <= kLargest)) continue;
    const bool is_code = IsUsualCode(values[c]) || IsUsualCode(watch.before);
    if (watch.seen.good_rows >= 1 && !is_code) steps_[c] = values[c] - watch.before;
    if (watch.seen.good_rows >= 2 && !is_code && !IsUsualCode(watch.before_that)) {
      curvatures_[c] = values[c] - 2.0 * watch.before + watch.before_that;
    }
    Look(watch, values[c]);
  }
  if (rows_++ % every_ == 0) Keep(values);
}

std::vector<double> TableStatistics::KeptValues(std::size_t column) const {
  if (column >= columns_.size()) throw std::logic_error("no such column");
  std::vector<double> kept;
  for (std::size_t i = column; i < values_.size(); i += columns_.size()) kept.push_back(values_[i]);
  return kept;
}

ColumnStatistics TableStatistics::Column(std::size_t column) const {
  const Watch& watch = columns_.at(column);
  ColumnStatistics statistics = watch.seen;
  const double steps = static_cast<double>(std::max<std::size_t>(statistics.good_rows, 2) - 1);
  statistics.falling_share = static_cast<double>(watch.falls) / steps;
  statistics.counting_share = static_cast<double>(watch.still_rows + watch.ones) / steps;
  statistics.longest_still_rows = watch.longest_run + 1;
  const double range = watch.other_high - watch.other_low;
  std::vector<double> codes;
  std::size_t in_codes = 0, most = 0;
  double low = watch.other_low, high = watch.other_high;
  for (const auto& [code, count] : watch.codes) {
    const double away = std::max(watch.other_low - code, code - watch.other_high);
    if (range > 0.0 && away > range && 2 * count < statistics.good_rows) {
      codes.push_back(code);
      in_codes += count;
      if (count > most) most = count, statistics.code = code;
    } else {
      low = watch.others == 0 ? code : std::min(low, code);
      high = watch.others == 0 ? code : std::max(high, code);
    }
  }
  if (!codes.empty()) {
    statistics.low = low;
    statistics.high = high;
    statistics.code_share =
        static_cast<double>(in_codes) / static_cast<double>(statistics.good_rows);
  }
  std::vector<double> values = KeptValues(column);
  std::erase_if(values, [&](double value) {
    return !(std::abs(value) <= kLargest) || std::ranges::find(codes, value) != codes.end();
  });
  constexpr double kRareShare = 0.005;
  statistics.usual_low = values.empty() ? statistics.low : Quantile(values, kRareShare);
  statistics.usual_high = values.empty() ? statistics.high : Quantile(values, 1.0 - kRareShare);
  statistics.slow = SlowDeviation(values);
  statistics.commonest_share = CommonestShare(std::move(values));
  const double rows = static_cast<double>(std::max<std::size_t>(statistics.good_rows, 1));
  statistics.still_share = static_cast<double>(watch.still_rows) / rows;
  // The lowest value of noise is rare. The value of a saturated sensor is frequent, also in a short
  // table, of which a single row is a large share.
  constexpr double kCommonShare = 0.01;
  constexpr std::size_t kFewestAtEnd = 5;
  for (const bool is_low : {true, false}) {
    if (is_low ? statistics.low > watch.seen.low : statistics.high < watch.seen.high) continue;
    const std::size_t at_end = is_low ? watch.at_low : watch.at_high;
    const double share = static_cast<double>(at_end) / rows;
    if (at_end < kFewestAtEnd || share < kCommonShare || !(statistics.low < statistics.high))
      continue;
    statistics.clipped_share += share;
  }
  const auto distances = [&](const std::vector<double>& kept) {
    std::vector<double> found;
    for (std::size_t i = column; i < kept.size(); i += columns_.size()) {
      if (std::isfinite(kept[i])) found.push_back(std::abs(kept[i]));
    }
    return found;
  };
  const std::vector<double> changes = distances(kept_steps_);
  const std::vector<double> bends = distances(kept_curvatures_);
  if (!changes.empty()) statistics.change = controller::DeviationFromDistances(changes);
  if (bends.empty()) return statistics;
  // Second differences of white noise with deviation s have the deviation s sqrt(1 + 4 + 1).
  const double bend = controller::DeviationFromDistances(bends);
  statistics.noise = bend / std::sqrt(6.0);
  constexpr double kFarInNoise = 20.0;
  constexpr double kFarInRange = 0.1;
  const double far = std::max({kFarInNoise * bend, kFarInNoise * statistics.step,
                               kFarInRange * (statistics.usual_high - statistics.usual_low)});
  statistics.spike_share =
      static_cast<double>(std::ranges::count_if(bends, [far](double d) { return d > far; })) /
      (3.0 * static_cast<double>(bends.size()));  // a spike bends three rows
  return statistics;
}

TimeStatistics TableStatistics::Time() const {
  TimeStatistics time = time_;
  const double usual_s =
      window_means_s_.empty() ? UsualInterval(intervals_s_) : MeanNearMedian(window_means_s_);
  time.rate_hz = 1.0 / usual_s;
  if (newest_step_ > first_step_) {
    time.mean_rate_hz =
        static_cast<double>(newest_step_ - first_step_) / (newest_step_s_ - first_step_s_);
  }
  constexpr double kTail = 0.05;
  time.short_ms = 1e3 * Quantile(intervals_s_, kTail);
  time.long_ms = 1e3 * Quantile(intervals_s_, 1.0 - kTail);
  constexpr double kGapPerInterval = 5.0;
  for (const double interval_s : longest_s_) {
    if (interval_s <= kGapPerInterval * usual_s) continue;
    ++time.gaps;
    time.longest_gap_s = std::max(time.longest_gap_s, interval_s);
  }
  return time;
}

}  // namespace gauntlet::sim
