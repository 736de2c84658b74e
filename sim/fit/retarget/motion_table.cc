#include "sim/fit/retarget/motion_table.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "sim/base/error.h"
#include "sim/recordings/column_map.h"
#include "sim/recordings/table_source.h"
#include "sim/recordings/time_guess.h"
#include "sim/tables/table_layout.h"
#include "sim/tables/time_columns.h"

namespace gauntlet::sim {

MotionTable LoadMotionTable(const std::filesystem::path& file, const FingertipFormat& format,
                            const std::function<bool(std::string_view column)>& is_wanted) {
  const double rate_hz = format.rate_hz;
  FoundTable found =
      FindTable(file.string(), StoredTable(file, format.array), ProblemHandling::kAllowMissing);
  CsvReader& csv = found.reader;
  const std::vector<std::string>& names = found.layout.names;
  if (!found.layout.has_header) {
    csv.FailInRow(1, 1, "must be a header with the names of the columns");
  }
  MotionTable table;
  table.file = file.string();
  std::vector<TimeMapping> time;
  if (rate_hz == 0.0) time = TimeByName(csv.name(), found.layout, format.time_unit);
  std::erase_if(time, [&](const TimeMapping& part) { return is_wanted(names[part.column]); });
  if (time.empty() && rate_hz == 0.0) {
    csv.FailInRow(1, 1, "has no column of time (as time_s); --rate tells the rows per second");
  }
  std::vector<std::size_t> places;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const auto part = std::ranges::find(time, i, &TimeMapping::column);
    if (part != time.end()) {
      if (part->is_text) csv.ReadAsTime(i);
    } else if (is_wanted(names[i])) {
      places.push_back(i);
      table.columns.push_back(names[i]);
    } else {
      csv.Ignore(i);
      if (!TimeScaleS(names[i]) && !IsSampleNumber(names[i])) table.ignored.push_back(names[i]);
    }
  }
  MidnightClock midnight(time);
  std::vector<double> row(names.size());
  std::vector<double> values;
  while (csv.NextRow(row)) {
    const double time_s = midnight.Add(
        time.empty() ? static_cast<double>(table.time_s.size()) / rate_hz : TimeOfRow(time, row));
    if (!std::isfinite(time_s)) csv.Fail(time.front().column + 1, "the time is missing");
    if (!table.time_s.empty() && !(time_s > table.time_s.back())) {
      csv.Fail(time.front().column + 1,
               fmt::format("the time is {} s, must be above the {} s of the row before", time_s,
                           table.time_s.back()));
    }
    table.time_s.push_back(time_s);
    for (const std::size_t place : places) values.push_back(row[place]);
  }
  if (table.time_s.empty()) throw UserError({.place = table.file, .problem = "has no rows"});
  using RowMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  table.values = Eigen::Map<const RowMatrix>(values.data(), std::ssize(table.time_s),
                                             std::ssize(table.columns));
  return table;
}

}  // namespace gauntlet::sim
