#include "sim/fit/fit_tables.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "sim/results/table_text.h"

namespace gauntlet::sim {

std::string FixedText(double value, int digits) {
  if (!std::isfinite(value)) return "-";
  std::string text = fmt::format("{:.{}f}", value, digits);
  // No minus before a zero.
  return text.find_first_of("123456789") == std::string::npos && text.front() == '-'
             ? text.substr(1)
             : text;
}

std::string RangeText(const std::vector<double>& values, int digits) {
  const auto [low, high] = std::ranges::minmax(values);
  const std::string first = FixedText(low, digits), last = FixedText(high, digits);
  return first == last ? first : first + " to " + last;
}

std::string FirstNames(std::vector<std::string> names) {
  constexpr std::size_t kMost = 3;
  if (names.size() > kMost + 1) {
    const std::size_t others = names.size() - kMost;
    names.resize(kMost);
    names.push_back(fmt::format("{} others", others));
  }
  return Listed(std::move(names));
}

bool HasNoDelay(double low_ms, double high_ms, double rate_hz) {
  constexpr double kNoDelay_rows = 0.1;
  const double row_ms = 1e3 / rate_hz;
  return low_ms < kNoDelay_rows * row_ms && high_ms - low_ms <= row_ms;
}

ResultCell FixedCell(double value, int digits) { return {{value}, FixedText(value, digits)}; }

ResultCell IntervalCell(const ChainEstimate& estimate, int digits) {
  ResultCell cell({estimate.value, estimate.low, estimate.high}, FixedText(estimate.value, digits));
  if (std::isfinite(estimate.low)) {
    cell.text += fmt::format(" {}({:.{}f}..{:.{}f})", kSoftBreak, estimate.low, digits,
                             estimate.high, digits);
  }
  return cell;
}

ResultColumn IntervalColumn(const std::string& key, const std::string& heading,
                            const std::string& unit) {
  return {key,
          heading,
          unit,
          {{"value", key}, {"ci95_low", key + "_low"}, {"ci95_high", key + "_high"}}};
}

}  // namespace gauntlet::sim
