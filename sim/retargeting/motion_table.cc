#include "sim/retargeting/motion_table.h"

#include <fmt/core.h>

#include <cmath>
#include <optional>

#include "sim/base/error.h"
#include "sim/recordings/csv_reader.h"
#include "sim/recordings/table_source.h"
#include "sim/recordings/time_columns.h"

namespace gauntlet::sim {

MotionTable LoadMotionTable(const std::filesystem::path& file, double rate_hz,
                            const std::function<bool(std::string_view column)>& is_wanted) {
  CsvReader csv(file.string(), TableSource(file), ProblemHandling::kAllowMissing);
  if (csv.header().empty()) csv.FailInRow(1, 1, "must be a header with the names of the columns");
  MotionTable table;
  table.file = file.string();
  std::vector<std::size_t> places;
  std::optional<std::size_t> time;
  double scale_s = 1.0;
  for (std::size_t i = 0; i < csv.column_count(); ++i) {
    const std::string& name = csv.header()[i];
    const std::optional<double> is_time = TimeScaleS(name);
    if (is_wanted(name)) {
      places.push_back(i);
      table.columns.push_back(name);
    } else if (is_time && !time && rate_hz == 0.0) {
      time = i;
      scale_s = *is_time;
    } else {
      csv.Ignore(i);
      if (!is_time && !IsSampleNumber(name)) table.ignored.push_back(name);
    }
  }
  if (!time && rate_hz == 0.0) {
    csv.FailInRow(1, 1, "has no column of time (as time_s); --rate tells the rows per second");
  }
  std::vector<double> row(csv.column_count());
  std::vector<double> values;
  while (csv.NextRow(row)) {
    const double time_s =
        time ? scale_s * row[*time] : static_cast<double>(table.time_s.size()) / rate_hz;
    if (!std::isfinite(time_s)) csv.Fail(*time + 1, "the time is missing");
    if (!table.time_s.empty() && !(time_s > table.time_s.back())) {
      csv.Fail(*time + 1, fmt::format("the time is {} s, must be above the {} s of the row before",
                                      time_s, table.time_s.back()));
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
