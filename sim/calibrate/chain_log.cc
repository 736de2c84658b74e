#include "sim/calibrate/chain_log.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <string_view>

#include "controller/calibration/robust_statistics.h"
#include "sim/base/error.h"
#include "sim/base/nearest_name.h"
#include "sim/base/text.h"
#include "sim/recordings/csv_reader.h"
#include "sim/recordings/table_source.h"
#include "sim/recordings/time_columns.h"

namespace gauntlet::sim {
namespace {

/// A column of a part's command, angle or motor angle; `scale` converts it to degrees.
struct PartColumn {
  std::size_t column = 0;
  std::string part;
  double scale = 1.0;
};

struct ChainColumns {
  std::optional<std::size_t> time;
  double time_scale_s = 1.0;
  std::vector<PartColumn> commands;
  std::vector<PartColumn> angles;  // after pairing: in the order of `commands`
  std::vector<PartColumn> motors;  // after pairing: of parts with a motor angle, by name
};

struct ChainPattern {
  std::string_view before;
  std::string_view after;
  bool is_command;
  double scale;
};
/// Patterns of column names. The first match counts.
constexpr ChainPattern kChainPatterns[] = {{"true_angle_rad.", "", true, kDegPerRad},
                                           {"hand_angle_rad.", "", false, kDegPerRad},
                                           {"", "_command_deg", true, 1.0},
                                           {"", "_command_rad", true, kDegPerRad},
                                           {"", "_deg", false, 1.0},
                                           {"", "_rad", false, kDegPerRad}};

bool AddPart(const std::string& name, std::size_t column, ChainColumns& columns) {
  for (const ChainPattern& pattern : kChainPatterns) {
    const std::size_t around = pattern.before.size() + pattern.after.size();
    if (!name.starts_with(pattern.before) || !name.ends_with(pattern.after)) continue;
    if (name.size() <= around) continue;
    (pattern.is_command ? columns.commands : columns.angles)
        .push_back(
            {column, name.substr(pattern.before.size(), name.size() - around), pattern.scale});
    return true;
  }
  return name.find('.') != std::string::npos;  // another signal of a trace
}

const PartColumn* FindPart(const std::vector<PartColumn>& columns, const std::string& part) {
  const auto found = std::ranges::find(columns, part, &PartColumn::part);
  return found == columns.end() ? nullptr : &*found;
}

void RejectRepeatedParts(const CsvReader& csv, const std::vector<PartColumn>& columns) {
  for (std::size_t i = 0; i < columns.size(); ++i) {
    if (FindPart(columns, columns[i].part) == &columns[i]) continue;
    csv.Fail(columns[i].column + 1, fmt::format("{} appears twice", csv.Quoted(columns[i].part)));
  }
}

/// Sorts the angles in the order of the commands. In a trace, a joint without a channel of its name
/// has no partner, and vice versa.
void PairParts(const CsvReader& csv, ChainColumns& columns) {
  RejectRepeatedParts(csv, columns.commands);
  RejectRepeatedParts(csv, columns.angles);
  std::vector<PartColumn> commands;
  std::vector<PartColumn> angles;
  std::vector<PartColumn> motors;
  std::vector<std::string> names;
  for (const PartColumn& angle : columns.angles) names.push_back(angle.part);
  for (const PartColumn& command : columns.commands) {
    const PartColumn* angle = FindPart(columns.angles, command.part);
    if (angle != nullptr) {
      commands.push_back(command);
      angles.push_back(*angle);
      // A part may have this name itself.
      const std::string motor_name = command.part + "_motor";
      const PartColumn* motor = FindPart(columns.angles, motor_name);
      if (motor != nullptr && FindPart(columns.commands, motor_name) == nullptr) {
        motors.push_back({motor->column, command.part, motor->scale});
      }
    } else if (!csv.header()[command.column].starts_with(kChainPatterns[0].before)) {
      csv.Fail(command.column + 1,
               fmt::format("{} has a command but no angle, add a column {}_deg{}",
                           csv.Quoted(command.part), OneLine(command.part, 60),
                           Suggestion(command.part, names)));
    }
  }
  if (commands.empty()) {
    csv.Fail(1,
             "there is no part with a command and an angle (columns as index_mcp_command_deg and "
             "index_mcp_deg)");
  }
  columns.commands = std::move(commands);
  columns.angles = std::move(angles);
  columns.motors = std::move(motors);
}

ChainColumns FindChainColumns(const CsvReader& csv) {
  if (csv.header().empty()) csv.Fail(1, "the first line must name the columns");
  ChainColumns columns;
  for (std::size_t column = 0; column < csv.column_count(); ++column) {
    const std::string& name = csv.header()[column];
    if (const auto scale_s = TimeScaleS(name)) {
      columns.time = column;
      columns.time_scale_s = *scale_s;
    } else if (!IsSampleNumber(name) && !AddPart(name, column, columns)) {
      csv.Fail(column + 1, fmt::format("unknown column {}, must be a time (as t_s or time_ms), or "
                                       "a part's name with _command_deg, _command_rad, _deg or "
                                       "_rad behind it",
                                       csv.Quoted(name)));
    }
  }
  if (!columns.time) csv.Fail(1, "there is no column of time (as t_s or time_ms)");
  PairParts(csv, columns);
  return columns;
}

/// Valid values of one column and their times.
struct Series {
  std::vector<double> time_s;
  std::vector<double> value;
};

/// Linear interpolation at an even rate, beginning at start_s; constant beyond the ends.
void InterpolateLine(const Series& series, double start_s, double rate_hz,
                     Eigen::Ref<Eigen::VectorXd> result) {
  std::size_t next = 0;
  for (Eigen::Index k = 0; k < result.size(); ++k) {
    const double time_s = start_s + static_cast<double>(k) / rate_hz;
    while (next < series.time_s.size() && series.time_s[next] < time_s) ++next;
    if (next == 0 || next == series.time_s.size()) {
      result[k] = next == 0 ? series.value.front() : series.value.back();
      continue;
    }
    const double before_s = series.time_s[next - 1];
    const double share = (time_s - before_s) / (series.time_s[next] - before_s);
    result[k] = series.value[next - 1] + share * (series.value[next] - series.value[next - 1]);
  }
}

/// Like InterpolateLine(), for a command in steps: takes the value of the nearest row, because the
/// command never had a value in between.
void InterpolateCommand(const Series& series, double start_s, double rate_hz,
                        Eigen::Ref<Eigen::VectorXd> result) {
  if (!FindFrameClock(ChangesOf(series.value))) {
    InterpolateLine(series, start_s, rate_hz, result);
    return;
  }
  std::size_t nearest = 0;
  const auto distance_s = [&](std::size_t row, double time_s) {
    return std::abs(series.time_s[row] - time_s);
  };
  for (Eigen::Index k = 0; k < result.size(); ++k) {
    const double time_s = start_s + static_cast<double>(k) / rate_hz;
    while (nearest + 1 < series.time_s.size() &&
           distance_s(nearest + 1, time_s) <= distance_s(nearest, time_s)) {
      ++nearest;
    }
    result[k] = series.value[nearest];
  }
}

void RejectGap(const CsvReader& csv, const PartColumn& column, const Series& series,
               double longest_gap_s) {
  for (std::size_t i = 1; i < series.time_s.size(); ++i) {
    const double gap_s = series.time_s[i] - series.time_s[i - 1];
    if (gap_s <= longest_gap_s) continue;
    csv.FailInRow(1, column.column + 1,
                  fmt::format("{} has no value for {:.3g} s from {:.6g} s on, must have one every "
                              "{:.3g} s; cut the log there",
                              csv.Quoted(column.part), gap_s, series.time_s[i - 1], longest_gap_s));
  }
}

/// The valid values of all columns: commands, angles, motors.
struct ChainRows {
  std::vector<std::string> parts;
  std::vector<Series> series;
  double count = 0.0;
  double first_s = 0.0;
  double last_s = -std::numeric_limits<double>::infinity();
  double period_s = 0.0;  // usual one
  std::size_t values_missing = 0;
};

/// Reads only the columns of `columns`. Errors: UserError for times that do not rise.
std::vector<double> ReadSeries(const ChainColumns& columns, const std::vector<PartColumn>& all,
                               CsvReader& csv, ChainRows& rows) {
  std::vector<bool> used(csv.column_count(), false);
  used[*columns.time] = true;
  for (const PartColumn& column : all) used[column.column] = true;
  for (std::size_t i = 0; i < used.size(); ++i) {
    if (!used[i]) csv.Ignore(i);
  }
  std::vector<double> steps_s;
  std::vector<double> values(csv.column_count());
  while (csv.NextRow(values)) {
    const double time_s = values[*columns.time] * columns.time_scale_s;
    if (std::isnan(time_s)) csv.Fail(*columns.time + 1, "the time is missing");
    if (time_s <= rows.last_s) {
      csv.Fail(*columns.time + 1,
               fmt::format("the time is {} s, must be above the {} s of the row before", time_s,
                           rows.last_s));
    }
    if (rows.count++ == 0.0) rows.first_s = rows.last_s = time_s;
    if (rows.count > 1.0) steps_s.push_back(time_s - rows.last_s);
    rows.last_s = time_s;
    for (std::size_t i = 0; i < all.size(); ++i) {
      const double value = values[all[i].column] * all[i].scale;
      if (std::isnan(value)) {
        ++rows.values_missing;
        continue;
      }
      rows.series[i].time_s.push_back(time_s);
      rows.series[i].value.push_back(value);
    }
  }
  return steps_s;
}

/// Errors: UserError for fewer than two rows, a column without values, or a long gap.
ChainRows ReadChainRows(const ChainColumns& columns, CsvReader& csv) {
  std::vector<PartColumn> all = columns.commands;
  all.insert(all.end(), columns.angles.begin(), columns.angles.end());
  all.insert(all.end(), columns.motors.begin(), columns.motors.end());
  ChainRows rows;
  rows.series.resize(all.size());
  for (const PartColumn& column : all) rows.parts.push_back(column.part);
  const std::vector<double> steps_s = ReadSeries(columns, all, csv, rows);
  if (steps_s.empty()) csv.Fail(1, "the log has fewer than two rows");
  rows.period_s = controller::MedianOf(steps_s);
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (rows.series[i].value.empty()) {
      csv.FailInRow(1, all[i].column + 1, fmt::format("{} has no values", csv.Quoted(all[i].part)));
    }
    RejectGap(csv, all[i], rows.series[i], std::max(0.1, 10.0 * rows.period_s));
  }
  return rows;
}

}  // namespace

ChainLog LoadChainLog(const std::filesystem::path& file, const std::string& array) {
  CsvReader csv(file.string(), TableSource(file, array), ProblemHandling::kAllowMissing);
  const ChainColumns columns = FindChainColumns(csv);
  ChainLog log;
  log.name = OneLine(file.string());
  for (const PartColumn& command : columns.commands) log.parts.push_back(command.part);
  log.from_wearer =
      csv.header()[columns.commands.front().column].starts_with(kChainPatterns[0].before);
  const ChainRows rows = ReadChainRows(columns, csv);
  log.values_missing = rows.values_missing;
  log.rate_hz = 1.0 / rows.period_s;
  const double periods = (rows.last_s - rows.first_s) / rows.period_s;
  // Rows in bunches would make up to a million samples of each row.
  constexpr double kMostSamplesPerRow = 20.0;
  if (!(periods <= kMostSamplesPerRow * rows.count)) {
    csv.FailInRow(
        1, *columns.time + 1,
        fmt::format("most rows come {:.3g} s after the one before, but all {} take {:.6g} "
                    "s, must come at an about even rate",
                    rows.period_s, rows.count, rows.last_s - rows.first_s));
  }
  const Eigen::Index samples = std::llround(periods) + 1;
  const Eigen::Index parts = std::ssize(log.parts);
  log.command_deg = Signal(samples, parts);
  log.angle_deg = Signal(samples, parts);
  if (!columns.motors.empty()) log.motor_deg = Signal::Constant(samples, parts, kNaN);
  Signal* const signals[] = {&log.command_deg, &log.angle_deg, &log.motor_deg};
  for (std::size_t i = 0; i < rows.series.size(); ++i) {
    const Eigen::Index part = std::ranges::find(log.parts, rows.parts[i]) - log.parts.begin();
    Signal& signal = *signals[std::min<std::size_t>(i / log.parts.size(), 2)];
    const bool is_command = i < log.parts.size();
    (is_command ? InterpolateCommand : InterpolateLine)(rows.series[i], rows.first_s, log.rate_hz,
                                                        signal.col(part));
  }
  return log;
}

std::string WhatHysteresisIs(const std::vector<ChainFit>& fits) {
  const bool told_apart = std::ranges::any_of(
      fits, [](const ChainFit& fit) { return std::isfinite(fit.lost_motion_deg.value); });
  if (told_apart) {
    return "Hysteresis is the motor's own (dry friction, dead band) and lost motion, behind the "
           "motor: play of the gear, slack of cables and what cables stretch before they slide, "
           "which look alike, and of which little shows where a load holds the joint on one side. "
           "Without the motor's angle they are told apart by how sharp the joint turns.";
  }
  return "Hysteresis is the sum of dry friction, play of gears and slack of cables; no lost "
         "motion behind the motor is seen in these angles, and a log with the motors' angles, too "
         "(NAME_motor_deg), tells more.";
}

std::string WhatFramesAre(const ChainLog& log, const std::vector<ChainFit>& fits) {
  const auto framed = std::ranges::find_if(
      fits, [](const ChainFit& fit) { return fit.problem.empty() && fit.frames; });
  if (framed == fits.end()) return "";
  const double period_rows = framed->frames->period_rows;
  return fmt::format("Commands step every {:.2f} ms, {}.", 1e3 * period_rows / log.rate_hz,
                     period_rows == std::round(period_rows)
                         ? "with the rows of the log"
                         : "between the rows of the log, where a clock that fits all steps says");
}

std::vector<std::optional<FrameClock>> FramesOf(const ChainLog& log) {
  const auto parts = static_cast<std::size_t>(log.command_deg.cols());
  if (const auto of_all = FindFrameClock(ChangesOf(log.command_deg))) return {parts, of_all};
  std::vector<std::optional<FrameClock>> frames;
  for (Eigen::Index part = 0; part < log.command_deg.cols(); ++part) {
    const std::span column(log.command_deg.col(part).data(),
                           static_cast<std::size_t>(log.command_deg.rows()));
    frames.push_back(FindFrameClock(ChangesOf(column)));
    if (!frames.back() && log.held) frames.back() = FrameClock();
  }
  return frames;
}

std::vector<ChainFit> FitChains(const ChainLog& log) {
  std::vector<ChainFit> fits;
  const std::vector<std::optional<FrameClock>> frames = FramesOf(log);
  const auto column = [](const Signal& signal, Eigen::Index part) {
    return std::span<const double>(signal.col(part).data(),
                                   static_cast<std::size_t>(signal.rows()));
  };
  const int parts = std::ssize(log.parts);
  for (Eigen::Index part = 0; part < parts; ++part) {
    const std::span<const double> command_deg = column(log.command_deg, part);
    const std::span<const double> angle_deg = column(log.angle_deg, part);
    ChainFit& fit =
        fits.emplace_back(FitChain(command_deg, angle_deg, log.rate_hz, parts, frames[part]));
    if (log.motor_deg.size() == 0 || std::isnan(log.motor_deg(0, part))) continue;
    AddMotor(command_deg, column(log.motor_deg, part), angle_deg, log.rate_hz, fit, parts);
  }
  const bool any = std::ranges::any_of(fits, [](const ChainFit& f) { return f.problem.empty(); });
  if (!any) {
    throw UserError({.place = log.name, .key = log.parts.front(), .problem = fits[0].problem});
  }
  return fits;
}

}  // namespace gauntlet::sim
