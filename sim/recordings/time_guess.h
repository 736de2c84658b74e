#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "sim/recordings/column_map.h"
#include "sim/tables/table_layout.h"

namespace gauntlet::sim {

/// A column of time in a unit as in a column map.
TimeMapping TimeIn(std::size_t column, std::string_view unit);
/// The unit of a column of time, as in a column map.
std::string UnitOfTime(const TimeMapping& time);
/// Time of a row by the values of all columns [s]; NaN if a part of it is missing, 0 without any.
double TimeOfRow(std::span<const TimeMapping> time, std::span<const double> row);

struct TimeGuess {
  std::vector<TimeMapping> parts;  // empty: no time columns
  std::string why;
  std::string question = {};              // that is open while there are no parts; empty: none
  std::optional<std::size_t> asked = {};  // the column that the question is about
  bool is_named = true;                   // false: found by its values alone
  bool unit_is_assumed = false;           // s, of a first column without a name
};

inline constexpr std::string_view kPastMidnight = "the clock goes past midnight: 24 h are added";
/// Clocks without a date go on over midnight: 24 h are added where one falls by nearly as much.
class MidnightClock {
 public:
  MidnightClock() = default;  // of times that are no clocks: they stay as they are
  explicit MidnightClock(bool has_clock) : has_clock_(has_clock) {}
  explicit MidnightClock(const std::vector<TimeMapping>& time);
  double Add(double time_s);
  int midnights() const { return midnights_; }

 private:
  bool has_clock_ = false;
  double last_s_ = 0.0;
  int midnights_ = 0;
};

/// Finds the time columns by their names and first rows. A column of numbers has the unit `unit`,
/// if a person gave it, that of its name, or that of a date that it counts from. `t`, `time` and
/// the like are in s where that is the rate of a glove. So is, but assumed, a first column without
/// a name. All others are a question.
TimeGuess GuessTime(const TableLayout& layout, const std::string& unit = {});
/// The time as a column map has it.
TimeGuess TimeOfMap(const std::vector<TimeMapping>& time);
/// The time of a table whose columns are known by their names: that of GuessTime(), unless it is
/// found by its values alone. Else the first column with a name of TimeScaleS(). Empty: none.
/// `unit`: of a column of numbers, as a person gave it (--time-unit); empty: found. With it, a time
/// may be found by its values.
/// Errors: UserError in `file` for a column of time whose unit is a question, and for a unit
/// without a time.
std::vector<TimeMapping> TimeByName(const std::string& file, const TableLayout& layout,
                                    const std::string& unit = {});
/// Columns of whole numbers, or with the name of a time, that rise in the first rows as this time
/// does, in s, ms or us: clocks beside it, as millis() behind the clock of a serial monitor.
std::vector<std::size_t> ClocksBeside(const std::vector<TimeMapping>& time,
                                      const TableLayout& layout);
/// Columns of numbers of rows, labels and other times, by their names, and ClocksBeside().
std::vector<std::size_t> ColumnsAside(const std::vector<TimeMapping>& time,
                                      const TableLayout& layout);
/// Makes a reader pass over all columns but those of the time and `used`.
void ReadOnly(const std::vector<TimeMapping>& time, const std::vector<std::size_t>& used,
              CsvReader& reader);
/// Seconds per unit of a column of time; 1 for dates.
double SecondsPer(std::string_view time_unit);

}  // namespace gauntlet::sim
