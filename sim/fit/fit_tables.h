#pragma once

#include <string>
#include <vector>

#include "sim/fit/chain_fit.h"
#include "sim/results/result_table.h"

namespace gauntlet::sim {

/// Number with so many digits behind the point; "-" where it is not finite.
std::string FixedText(double value, int digits);
/// "46.0", or "46.0 to 132.6". Precondition: values.
std::string RangeText(const std::vector<double>& values, int digits);

/// "a, b and c", "a, b, c and 3 others"
std::string FirstNames(std::vector<std::string> names);

/// True for a delay [ms] whose interval is known within a row and goes below a tenth of one: no
/// hand follows its command so fast.
bool HasNoDelay(double low_ms, double high_ms, double rate_hz);

ResultCell FixedCell(double value, int digits);
/// "46.0 (44.1..47.9)"
ResultCell IntervalCell(const ChainEstimate& estimate, int digits);
/// Column of IntervalCell().
ResultColumn IntervalColumn(const std::string& key, const std::string& heading,
                            const std::string& unit);

}  // namespace gauntlet::sim
