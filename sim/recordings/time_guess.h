#pragma once

#include <string>
#include <vector>

#include "sim/recordings/column_map.h"
#include "sim/tables/table_layout.h"

namespace gauntlet::sim {

/// A column with the time, or with a part of it.
struct TimePart {
  std::size_t column = 0;
  std::string unit = {};  // as in a column map
};

struct TimeGuess {
  std::vector<TimePart> parts;  // empty: no time columns
  std::string why;
  bool is_assumed = false;       // the unit is a guess against the name, or by an unusual rate
  bool is_named = true;          // false: found by its values alone
  bool unit_is_guessed = false;  // by the size of its steps
};

/// Guesses the time columns by their names and first rows. `unit`: of a column of numbers, if a
/// person gave it; empty: by its name, or by its values.
TimeGuess GuessTime(const TableLayout& layout, const std::string& unit = {});
/// The time as a column map has it.
TimeGuess TimeOfMap(const std::vector<TimeMapping>& time);
/// The time of a table whose columns are known by their names: that of GuessTime(), unless it is
/// found by its values alone or its unit is assumed. Else the first column with a name of
/// TimeScaleS(). Empty: none.
std::vector<TimeMapping> TimeByName(const TableLayout& layout);
/// Seconds per unit of a part; 1 for dates.
double SecondsPer(const std::string& time_unit);

}  // namespace gauntlet::sim
