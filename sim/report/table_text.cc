#include "sim/report/table_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace gauntlet::sim {

std::string Short(double value) {
  if (!std::isfinite(value)) return "-";
  const double size = std::abs(value);
  const int decimals = size >= 99.95 ? 0 : size >= 9.995 ? 1 : size >= 0.9995 ? 2 : 3;
  return fmt::format("{:.{}f}", value, decimals);
}

std::string Padded(const std::string& text, std::size_t width, bool right) {
  const std::string space(width > Width(text) ? width - Width(text) : 0, ' ');
  return right ? space + text : text + space;
}

std::string IntervalText(const MeanInterval& interval) {
  if (std::isnan(interval.mean)) return "-";
  if (std::isnan(interval.high)) return fmt::format("{:.3g}", interval.mean);
  return fmt::format("{:.3g}±{:.2g}", interval.mean, interval.high - interval.mean);
}

std::string AlignedTable(const std::vector<std::vector<std::string>>& rows) {
  std::vector<std::size_t> widths(rows.front().size());
  for (const auto& row : rows) {
    for (std::size_t c = 0; c < row.size(); ++c) widths[c] = std::max(widths[c], Width(row[c]));
  }
  std::string text;
  for (const auto& row : rows) {
    for (std::size_t c = 0; c < row.size(); ++c) {
      text += (c == 0 ? "" : "  ") + std::string(widths[c] - Width(row[c]), ' ') + row[c];
    }
    text += "\n";
  }
  return text;
}

std::string Good(const std::string& text) { return "\033[1;32m" + text + "\033[0m"; }
std::string Warning(const std::string& text) { return "\033[33m" + text + "\033[0m"; }

}  // namespace gauntlet::sim
