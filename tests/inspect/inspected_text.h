#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <string_view>

#include "sim/base/error.h"
#include "sim/recordings/inspect/inspection.h"
#include "sim/recordings/inspect/starter_files.h"
#include "sim/recordings/recording_reader.h"
#include "sim/recordings/table_source.h"

namespace gauntlet::sim {

/// Inspection of any text, and the files that are made of it.
struct InspectedText {
  std::optional<Inspection> inspection;  // none: refused with a UserError
  std::string scenario;                  // empty: a question is open
  std::string problem;                   // anything that must not be; empty: nothing
};

/// The first disagreement between the parts of an inspection, or number that is not finite.
inline std::string ProblemOf(const Inspection& inspection) {
  const std::size_t columns = inspection.layout.columns;
  if (columns == 0 || inspection.rows == 0) return "a table without columns or rows";
  if (inspection.columns.size() != columns || inspection.layout.names.size() != columns ||
      inspection.picture_values.size() != columns) {
    return "another number of columns";
  }
  for (const auto& row : inspection.layout.rows) {
    if (row.size() != columns) return "a row of another length";
  }
  const TimeStatistics& time = inspection.time;
  for (const double number :
       {time.rate_hz, time.duration_s, time.short_ms, time.long_ms, time.longest_gap_s}) {
    if (!std::isfinite(number)) return "a time that is not finite";
  }
  if (!(time.rate_hz > 0.0)) return fmt::format("a rate of {} Hz", time.rate_hz);
  if (time.repeats + time.restarts >= inspection.rows) return "more steps of time than rows";
  const std::size_t drawn = inspection.picture_time_s.size();
  if (!std::ranges::is_sorted(inspection.picture_time_s)) return "a picture out of order";
  for (std::size_t c = 0; c < columns; ++c) {
    const InspectedColumn& column = inspection.columns[c];
    const ColumnStatistics& is = column.statistics;
    const bool is_number = column.kind == CellKind::kNumber;
    if (inspection.picture_values[c].size() != (is_number ? drawn : 0)) return "a picture's gap";
    if (is.good_rows > inspection.rows) return "more values than rows";
    if (is.good_rows == 0) continue;
    for (const double number :
         {is.low, is.high, is.usual_low, is.usual_high, is.step, is.noise, is.still_share}) {
      if (!std::isfinite(number)) return fmt::format("column {}: not finite", c + 1);
    }
    const bool in_order =
        is.low <= is.usual_low && is.usual_low <= is.usual_high && is.usual_high <= is.high;
    const bool are_shares = is.still_share >= 0.0 && is.still_share <= 1.0 &&
                            is.clipped_share >= 0.0 && is.clipped_share <= 1.0;
    if (!in_order || !are_shares) return fmt::format("column {}: impossible statistics", c + 1);
    if (!column.channel.empty() && !column.time_unit.empty()) return "a sensor that is a time";
  }
  return "";
}

/// Inspects `text` as a file of `folder`; the map that is written of it has to open it again.
inline InspectedText InspectText(std::string_view text, const std::filesystem::path& folder) {
  const std::filesystem::path file = folder / "recording.csv";
  const std::filesystem::path map = folder / "map.csv";
  std::ofstream(file, std::ios::binary) << text;
  InspectedText result;
  try {
    const Inspection& inspection = result.inspection.emplace(Inspect(file, {}));
    result.problem = ProblemOf(inspection);
    if (!inspection.question.empty() && inspection.question.find('\n') != std::string::npos) {
      result.problem = "a question of several lines";
    }
    std::ofstream(map) << StarterMap(inspection);
    if (!inspection.question.empty()) return result;
    result.scenario = StarterScenario(inspection, file.string(), map.string());
    const RecordingReader again(file.string(), TableSource(file),
                                {.map = map.string(),
                                 .rate_hz = inspection.has_time ? 0.0 : inspection.time.rate_hz,
                                 .skipped_lines = inspection.layout.skipped_lines,
                                 .handling = ProblemHandling::kRepair});
  } catch (const UserError& error) {
    if (result.inspection) result.problem = error.what();
    if (std::string_view(error.what()).find('\n') != std::string_view::npos) {
      result.problem = "an error of several lines";
    }
  }
  return result;
}

}  // namespace gauntlet::sim
