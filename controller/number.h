#pragma once

#include <charconv>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <string_view>
#include <system_error>

#include "controller/export.h"

namespace gauntlet::controller {

/// Stands where there is no number: a missing sample, an angle that is not measured.
inline constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

/// The number that the whole text is: decimal digits with an optional sign, point and exponent, as
/// `-2.5e-3`. Nothing for any other text: blanks, hexadecimal digits, inf, nan, and what is beyond
/// the range of a double. The locale does not matter.
GAUNTLET_API std::optional<double> ParseNumber(std::string_view text);

/// As ParseNumber(), for a whole number from `low` to `high`, at most 2^53 from 0: `12` or `1e3`.
GAUNTLET_API std::optional<std::int64_t> ParseWholeNumber(std::string_view text, std::int64_t low,
                                                          std::int64_t high);

/// As ParseNumber(), for what programs write in tables: besides, inf, infinity and nan in any case
/// of the letters; infinite beyond the range of a double and 0 below it.
GAUNTLET_API std::optional<double> ParseNumberOfProgram(std::string_view text);

/// The number at the beginning of a text, without a plus sign, for a reader that looks for its end:
/// the place behind it, or null if there is none.
inline const char* ReadNumber(const char* begin, const char* end, double& value) {
  const auto [rest, error] = std::from_chars(begin, end, value);
  return error == std::errc() && std::isfinite(value) ? rest : nullptr;
}

}  // namespace gauntlet::controller
