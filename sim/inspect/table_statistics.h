#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace gauntlet::sim {

/// What one column of numbers is like.
struct ColumnStatistics {
  std::size_t good_rows = 0;  // with a value of at most 1e100
  double low = 0.0;
  double high = 0.0;
  double usual_low = 0.0;  // all but half a percent of the rows lie above it
  double usual_high = 0.0;
  double step = 0.0;           // smallest difference of neighbours that is not 0; 0: it never moves
  double noise = 0.0;          // standard deviation, from the curvature between three rows
  double still_share = 0.0;    // of rows with the value of the row before
  double clipped_share = 0.0;  // of rows at the lowest or highest value, where those are common
  std::size_t longest_still_rows = 0;
  bool is_whole = true;   // only whole numbers
  bool is_rising = true;  // never falls
};

/// How the rows follow each other in time.
struct TimeStatistics {
  double duration_s = 0.0;  // without what lies between two starts of the clock
  double rate_hz = 0.0;
  double short_ms = 0.0;  // one interval in twenty is shorter
  double long_ms = 0.0;   // one in twenty is longer
  std::size_t repeats = 0;
  std::size_t restarts = 0;  // of the clock, or rows that are out of order
  std::size_t gaps = 0;      // of more than five usual intervals
  double longest_gap_s = 0.0;
};

/// Sees a table once, row by row. Memory does not grow with the table: of the rows it keeps every
/// k-th, so that 4,096 to 8,192 stay, for quantiles and pictures.
class TableStatistics {
 public:
  explicit TableStatistics(std::size_t columns);

  /// `time_s` is NaN in a table without time. A value that is missing is NaN; values beyond 1e100
  /// and times beyond 1e12 s count as missing.
  /// Errors: std::logic_error for another number of values than columns.
  void Add(double time_s, std::span<const double> values);

  std::size_t rows() const { return rows_; }
  /// Errors: std::logic_error for a column that the table has not.
  ColumnStatistics Column(std::size_t column) const;
  TimeStatistics Time() const;
  /// Of the rows that were kept, since the first one with a time.
  const std::vector<double>& kept_times_s() const { return times_s_; }
  std::vector<double> KeptValues(std::size_t column) const;
  /// From one row that was kept to the next.
  std::size_t kept_every() const { return every_; }

 private:
  struct Watch {
    std::size_t good_rows = 0, still_rows = 0, run = 0, longest_run = 0;
    double low = 0.0, high = 0.0;
    std::size_t at_low = 0, at_high = 0;
    double before = 0.0, before_that = 0.0;
    double step = 0.0;
    bool is_whole = true, is_rising = true;
  };
  void AddTime(double time_s);
  void Look(Watch& watch, double value);
  void Keep(std::span<const double> values);

  std::vector<Watch> columns_;
  std::vector<double> curvatures_;  // of the row that was added last
  std::size_t rows_ = 0;
  std::size_t every_ = 1;
  std::vector<double> times_s_;
  std::vector<double> values_;           // of the kept rows, one after another
  std::vector<double> kept_curvatures_;  // the same
  std::optional<double> last_s_;
  double window_s_ = 0.0;
  int in_window_ = 0;
  std::vector<double> intervals_s_;  // kept as the rows are
  std::vector<double> window_means_s_;
  std::size_t intervals_ = 0;
  TimeStatistics time_;
  std::vector<double> longest_s_;  // intervals, the longest ones
};

/// The usual interval of rows: the median over windows of 16 intervals of their means, which
/// neither gaps nor rows that come in bunches move.
double UsualInterval(std::span<const double> intervals_s);

}  // namespace gauntlet::sim
