#include "sim/recordings/time_columns.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <utility>

namespace gauntlet::sim {
namespace {

constexpr std::array<std::pair<std::string_view, double>, 5> kTimeColumns = {
    {{"t_s", 1.0}, {"time", 1.0}, {"time_s", 1.0}, {"time_ms", 1e-3}, {"time_us", 1e-6}}};

/// `lower` is in small letters.
bool IsSame(std::string_view name, std::string_view lower) {
  return std::ranges::equal(name, lower, {}, [](unsigned char c) { return std::tolower(c); });
}

}  // namespace

std::optional<double> TimeScaleS(std::string_view name) {
  for (const auto& [known, scale_s] : kTimeColumns) {
    if (IsSame(name, known)) return scale_s;
  }
  return std::nullopt;
}

bool IsSampleNumber(std::string_view name) { return IsSame(name, "k"); }

}  // namespace gauntlet::sim
