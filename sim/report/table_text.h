#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "sim/base/text.h"  // Width, for those who align
#include "sim/study/statistics.h"

namespace gauntlet::sim {

/// A score with three significant digits, which is what the intervals usually allow; "-" for NaN.
std::string Short(double value);

/// `text` filled up with spaces, on its left if it belongs on the right.
std::string Padded(const std::string& text, std::size_t width, bool right);

/// A mean and half of its interval, `4.96±0.12`; "-" where there is none.
std::string IntervalText(const MeanInterval& interval);

/// Rows of equally many fields, each column as wide as its widest, on the right.
std::string AlignedTable(const std::vector<std::vector<std::string>>& rows);

/// Colours of a terminal: what is good, and what to look at.
std::string Good(const std::string& text);
std::string Warning(const std::string& text);

}  // namespace gauntlet::sim
