#include "sim/study/csv_line.h"

#include <fmt/format.h>

#include <cmath>

namespace gauntlet::sim {

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
