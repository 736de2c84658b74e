#pragma once

#include <string>
#include <vector>

#include "sim/inspect/table_layout.h"

namespace gauntlet::sim {

/// A column that tells the time, or a part of it.
struct TimePart {
  std::size_t column = 0;
  std::string unit = {};  // as in a column map
};

struct TimeGuess {
  std::vector<TimePart> parts;  // empty: there is no time
  std::string why;
};

/// Which columns are the time, by their names and their first rows.
TimeGuess GuessTime(const TableLayout& layout);
/// Seconds per unit of a part; 1 for dates.
double SecondsPer(const std::string& time_unit);

}  // namespace gauntlet::sim
