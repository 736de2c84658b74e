#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <span>
#include <vector>

namespace gauntlet::sim {

/// Statistics of one column of numbers. Numbers that stand for a missing value count in good_rows
/// and code_share alone: usual codes, as -9999 and 32767, that are further from all other values of
/// the column than these are from each other.
struct ColumnStatistics {
  std::size_t good_rows = 0;  // with a value of at most 1e100
  double low = 0.0;
  double high = 0.0;
  double usual_low = 0.0;  // 0.5 % quantile of the rows
  double usual_high = 0.0;
  double step = 0.0;    // smallest nonzero difference of neighbours; 0: constant
  double noise = 0.0;   // standard deviation, from second differences
  double change = 0.0;  // standard deviation of steps from row to row
  double slow = 0.0;    // standard deviation of means of four kept rows; of noise alone half of it
  double spike_share = 0.0;    // rows far from both neighbours, on one side of them
  double still_share = 0.0;    // rows equal to the row before
  double clipped_share = 0.0;  // rows at the lowest or highest value, if frequent
  std::size_t longest_still_rows = 0;
  double commonest_share = 0.0;  // rows with the most frequent value
  double falling_share = 0.0;    // steps to a lower value
  double counting_share = 0.0;   // steps of 0 or 1
  std::size_t turns = 0;         // steps of about 360
  bool is_whole = true;          // only whole numbers
  double code = 0.0;             // the most frequent number that stands for a missing value
  double code_share = 0.0;       // rows with such a number
};

/// Statistics of the rows' times.
struct TimeStatistics {
  double duration_s = 0.0;  // without jumps between two starts of the clock
  double rate_hz = 0.0;
  double mean_rate_hz = 0.0;  // from the first step of the clock to the last; 0 with fewer than two
  double short_ms = 0.0;      // 5 % quantile of the intervals
  double long_ms = 0.0;       // 95 % quantile
  std::size_t missing = 0;    // rows without a time
  std::size_t repeats = 0;
  std::size_t restarts = 0;  // of the clock, or rows out of order
  std::size_t gaps = 0;      // intervals of more than five usual ones
  double longest_gap_s = 0.0;
};

/// Statistics of a table in one pass. Memory does not grow with the table: it keeps every k-th row,
/// 4,096 to 8,192 in total, for quantiles and pictures.
class TableStatistics {
 public:
  explicit TableStatistics(std::size_t columns);

  /// `time_s` is NaN in a table without time, a missing value is NaN. Values beyond 1e100 and times
  /// beyond 1e12 s count as missing.
  /// Errors: std::logic_error if the number of values differs from the number of columns.
  void Add(double time_s, std::span<const double> values);

  std::size_t rows() const { return rows_; }
  /// Errors: std::logic_error if there is no such column.
  ColumnStatistics Column(std::size_t column) const;
  TimeStatistics Time() const;
  /// Times of the kept rows since the first row with a time.
  const std::vector<double>& kept_times_s() const { return times_s_; }
  std::vector<double> KeptValues(std::size_t column) const;
  /// Distance of the kept rows.
  std::size_t kept_every() const { return every_; }

 private:
  struct Watch {
    ColumnStatistics seen;  // as far as one pass tells it
    std::size_t still_rows = 0, run = 0, longest_run = 0;
    std::size_t at_low = 0, at_high = 0;
    double before = 0.0, before_that = 0.0;
    std::map<double, std::size_t> codes = {};  // rows of each usual code
    double other_low = 0.0, other_high = 0.0;  // of all other values
    std::size_t others = 0;
    std::size_t falls = 0, ones = 0;
  };
  void AddTime(double time_s);
  void Look(Watch& watch, double value);
  void Keep(std::span<const double> values);

  std::vector<Watch> columns_;
  std::vector<double> curvatures_;  // of the newest row
  std::vector<double> steps_;       // likewise
  std::size_t rows_ = 0;
  std::size_t every_ = 1;
  std::vector<double> times_s_;
  std::vector<double> values_;           // of the kept rows, row by row
  std::vector<double> kept_curvatures_;  // likewise
  std::vector<double> kept_steps_;       // likewise
  std::optional<double> last_s_;
  double window_s_ = 0.0;
  int in_window_ = 0;
  std::vector<double> intervals_s_;  // every k-th, like rows
  std::vector<double> window_means_s_;
  std::size_t intervals_ = 0;
  TimeStatistics time_;
  // Number of the interval, and duration, at the first and the newest step of the clock.
  std::size_t first_step_ = 0, newest_step_ = 0;
  double first_step_s_ = 0.0, newest_step_s_ = 0.0;
  std::vector<double> longest_s_;  // the longest intervals
};

/// The usual interval of rows: the median of the means over windows of 16 intervals. Gaps and rows
/// in bunches do not change it.
double UsualInterval(std::span<const double> intervals_s);

}  // namespace gauntlet::sim
