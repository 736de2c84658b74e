#pragma once

#include <cstddef>
#include <string>

#include "sim/base/text.h"  // Width, for those who align

namespace gauntlet::sim {

/// A score with three significant digits, which is what the intervals usually allow; "-" for NaN.
std::string Short(double value);

/// `text` filled up with spaces, on its left if it belongs on the right.
std::string Padded(const std::string& text, std::size_t width, bool right);

/// Colours of a terminal: what is good, and what to look at.
std::string Good(const std::string& text);
std::string Warning(const std::string& text);

}  // namespace gauntlet::sim
