#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace gauntlet::sim {

/// Two senders whose rows take turns in one table.
struct Senders {
  std::size_t column = 0;   // the clock, or the first sensor with two levels
  int every = 2;            // rows of the second sender: every n-th
  double older_s = 0.0;     // age of its rows; negative: newer; 0: by the levels alone
  std::size_t sensors = 0;  // with two levels
};
/// "two senders: every 2nd row is 0.04 s older; record one of them".
std::string TextOf(const Senders& senders);

/// Splits the times of one clock into two that rise, in one pass.
class ClockPair {
 public:
  void Add(double time_s);

  struct Second {
    int every = 0;
    double older_s = 0.0;  // negative: newer
    /// The rows may also be those of one sender in another order.
    bool may_be_order = false;
  };
  /// The second clock, if two of them take turns with a period.
  std::optional<Second> Find() const;

 private:
  static constexpr std::size_t kMostEvery = 10;
  struct Clock {
    std::optional<double> last_s;
    std::size_t last_row = 0;
    std::size_t rows = 0;
    double steps_s = 0.0;                               // sum
    std::array<std::size_t, kMostEvery + 1> gaps = {};  // number of rows from its row before
  };
  std::array<Clock, 2> clocks_;
  std::size_t rows_ = 0;
  std::size_t misfits_ = 0;             // rows before both clocks
  std::size_t before_ = 0;              // clock of the row before
  std::array<double, 2> older_s_ = {};  // sum over changes to a clock: age against the row before
  std::array<double, 2> changes_to_ = {};
};

/// Watches the clock and the sensors for two senders while a table is read.
class SenderWatch {
 public:
  explicit SenderWatch(std::size_t columns);

  /// `time_s` is NaN in a table without a clock.
  void Add(double time_s, std::span<const double> values);

  /// `clock`: the column of the time. `sensors`: their columns, and the ranges of their usual
  /// values.
  std::optional<Senders> Find(std::size_t clock,
                              std::span<const std::pair<std::size_t, double>> sensors) const;

 private:
  struct Steps {
    double sum = 0.0;
    double count = 0.0;
    void Add(double step);
    double mean() const;
  };
  ClockPair clock_;
  std::vector<double> before_, before_that_;
  std::vector<Steps> to_before_, to_before_that_;
};

/// Watches one column that may tell the rows of several hands, devices or sessions apart.
class RowGroups {
 public:
  explicit RowGroups(std::size_t column) : column_(column) {}

  std::size_t column() const { return column_; }
  /// `group` is a number or a text's number.
  void Add(double group);

  /// Number of different groups; 0 if there are too many to be hands, devices or sessions.
  std::size_t count() const;
  /// True if groups take turns from row to row.
  bool Alternate() const;

 private:
  std::size_t column_;
  double rows_ = 0.0;
  double returns_ = 0.0;  // changes to a group that had rows before
  std::optional<double> before_;
  std::set<double> groups_;
};

}  // namespace gauntlet::sim
