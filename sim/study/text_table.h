#pragma once

#include <string>
#include <vector>

#include "sim/study/statistics.h"

namespace gauntlet::sim {

/// A mean and half of its interval, `4.96±0.12`; "-" where there is none.
std::string IntervalText(const MeanInterval& interval);

/// Rows of equally many fields, each column as wide as its widest, on the right.
std::string AlignedTable(const std::vector<std::vector<std::string>>& rows);

/// A row of a CSV table; what would be read as its structure stands in quotes (RFC 4180).
std::string CsvLine(const std::vector<std::string>& fields);

/// As text that reads back to the same; empty for what is not finite.
std::string NumberOrNothing(double value);

}  // namespace gauntlet::sim
