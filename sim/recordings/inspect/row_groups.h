#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace gauntlet::sim {

/// Watches one column that may tell the rows of several hands, devices or sessions apart, in one
/// pass. It compares the steps of the sensors from row to row with their steps within a group.
class RowGroups {
 public:
  RowGroups(std::size_t column, std::size_t columns);

  std::size_t column() const { return column_; }
  /// `group` is a number or a text's number; `time_s` is NaN in a table without time.
  void Add(double time_s, double group, std::span<const double> values);

  /// Number of different groups; 0 if there are too many to be hands, devices or sessions.
  std::size_t count() const { return is_over_ ? 0 : last_of_.size(); }
  /// True if groups take turns, and these sensors move less within a group than from row to row.
  bool Alternate(std::span<const std::size_t> sensors) const;
  /// True if groups follow one another without a new start of the clock, and these sensors jump
  /// between them.
  bool Jump(std::span<const std::size_t> sensors) const;

 private:
  struct Steps {
    double sum = 0.0;
    double count = 0.0;
    void Add(double step);
    double mean() const;
  };

  std::size_t column_;
  bool is_over_ = false;
  std::size_t rows_ = 0;
  std::size_t changes_ = 0;
  std::size_t returns_ = 0;  // changes to a group that had rows before
  std::optional<double> before_;
  double before_s_ = 0.0;
  Steps interval_s_;
  std::vector<double> last_;
  std::map<double, std::vector<double>> last_of_;  // last row of each group
  // Per column.
  std::vector<Steps> at_changes_;  // from row to row, without a gap in the time
  std::vector<Steps> within_;      // from row to row of one group
  std::vector<Steps> own_;         // from the row before of the same group
};

}  // namespace gauntlet::sim
