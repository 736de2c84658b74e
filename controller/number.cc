#include "controller/number.h"

#include <cstdlib>
#include <string>

namespace gauntlet::controller {

std::optional<double> ParseNumber(std::string_view text) {
  if (text.starts_with('+') && !text.starts_with("+-")) text.remove_prefix(1);
  const char* const end = text.data() + text.size();
  double value = 0.0;
  if (text.empty() || ReadNumber(text.data(), end, value) != end) return std::nullopt;
  return value;
}

std::optional<std::int64_t> ParseWholeNumber(std::string_view text, std::int64_t low,
                                             std::int64_t high) {
  const std::optional<double> number = ParseNumber(text);
  const bool is_whole = number && *number == std::trunc(*number);
  if (!is_whole || *number < static_cast<double>(low) || *number > static_cast<double>(high)) {
    return std::nullopt;
  }
  return static_cast<std::int64_t>(*number);
}

std::optional<double> ParseNumberOfProgram(std::string_view text) {
  if (text.starts_with('+')) text.remove_prefix(1);
  const char* const end = text.data() + text.size();
  double value = 0.0;
  const auto [rest, error] = std::from_chars(text.data(), end, value);
  if (rest != end || error == std::errc::invalid_argument) return std::nullopt;
  if (error == std::errc()) return value;
  // from_chars() does not say on which side; strtod() gives 0 or infinity, with the sign.
  return std::strtod(std::string(text).c_str(), nullptr);
}

}  // namespace gauntlet::controller
