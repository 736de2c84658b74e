#pragma once

#include <string>
#include <vector>

namespace gauntlet::sim {

/// A row of a CSV table; what would be read as its structure stands in quotes (RFC 4180).
std::string CsvLine(const std::vector<std::string>& fields);

/// As text that reads back to the same; empty for what is not finite.
std::string NumberOrNothing(double value);

}  // namespace gauntlet::sim
