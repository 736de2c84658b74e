#include "sim/study/text_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "sim/base/text.h"

namespace gauntlet::sim {
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

std::string CsvLine(const std::vector<std::string>& fields) {
  std::string line;
  for (std::size_t i = 0; i < fields.size(); ++i) {
    if (i > 0) line += ',';
    if (fields[i].find_first_of(",\"\n\r") == std::string::npos) {
      line += fields[i];
      continue;
    }
    line += '"';
    for (const char c : fields[i]) line += c == '"' ? "\"\"" : std::string(1, c);
    line += '"';
  }
  return line + "\n";
}

std::string NumberOrNothing(double value) {
  return std::isfinite(value) ? fmt::format("{}", value) : "";
}

}  // namespace gauntlet::sim
