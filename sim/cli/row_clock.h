#pragma once

#include <limits>
#include <vector>

namespace gauntlet::sim {

/// The rate of a stream's rows, by the times that stand in them.
///
/// An interval counts that is between half and one and a half of the median of the first ones: a
/// row that is lost does not, and the mean of the others is right also where times are rounded.
class RowClock {
 public:
  /// So many rows tell the rate of a stream that has not ended.
  static constexpr int kRowsForRate = 21;

  /// `scale_s`: seconds per unit of the times.
  explicit RowClock(double scale_s) : scale_s_(scale_s) {}

  /// The time of the next row. False, and nothing changed, if it is not a number above the last.
  bool Add(double time);
  int rows() const { return rows_; }
  /// Rate of all rows so far; NaN for fewer than two.
  double RateHz() const;

 private:
  void Count(double interval_s);
  void CountUsual(double interval_s);

  double scale_s_;
  int rows_ = 0;
  double last_ = -std::numeric_limits<double>::infinity();
  std::vector<double> first_intervals_s_;
  double usual_s_ = 0.0;  // the median of them
  double sum_s_ = 0.0;    // of intervals near it
  double counted_ = 0.0;  // how many
};

}  // namespace gauntlet::sim
