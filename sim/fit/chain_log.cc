#include "sim/fit/chain_log.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <mutex>
#include <optional>
#include <thread>

#include "controller/calibration/robust_statistics.h"
#include "sim/base/error.h"
#include "sim/base/text.h"
#include "sim/base/threads.h"
#include "sim/fit/chain_columns.h"
#include "sim/fit/episode_rows.h"
#include "sim/tables/csv_reader.h"

namespace gauntlet::sim {
namespace {

void RejectGap(const CsvReader& csv, const PartColumn& column, const ColumnSeries& series,
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

/// The largest absolute value of the commands and angles whose names have no unit.
double MostWithoutUnit(const std::vector<PartColumn>& parts, std::size_t used,
                       const std::vector<EpisodeRows>& episodes) {
  double most = 0.0;
  for (std::size_t i = 0; i < used; ++i) {
    if (parts[i].scale) continue;
    for (const EpisodeRows& rows : episodes) {
      for (const double value : rows.series[i].value) most = std::max(most, std::abs(value));
    }
  }
  return most;
}

/// Kinds of the commands, by the rows as they are: what is made of them at an even rate is no exact
/// copy of anything.
std::vector<CommandKind> KindsOf(const std::vector<ColumnSeries>& series, std::size_t parts,
                                 double rate_hz) {
  std::vector<CommandKind> kinds;
  for (std::size_t i = 0; i < parts; ++i) {
    const ColumnSeries& command = series[i];
    const ColumnSeries& angle = series[parts + i];
    kinds.push_back(command.time_s == angle.time_s
                        ? FindCommandKind(command.value, angle.value, rate_hz)
                        : CommandKind::kTarget);
  }
  return kinds;
}

/// The episode at an even rate. `log` has what all episodes share.
/// Errors: UserError for fewer than two rows, a column without values, a long gap or uneven rows.
ChainLog LogOf(const ChainColumns& columns, const std::vector<PartColumn>& parts, double scale,
               const CsvReader& csv, EpisodeRows rows, ChainLog log) {
  if (rows.steps_s.empty()) csv.FailInRow(1, 1, "the log has fewer than two rows");
  const double period_s = controller::MedianOf(rows.steps_s);
  double last_s = -std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < parts.size(); ++i) {
    if (rows.series[i].value.empty()) {
      csv.FailInRow(1, parts[i].column + 1,
                    fmt::format("{} has no values", csv.Quoted(parts[i].part)));
    }
    last_s = std::max(last_s, rows.series[i].time_s.back());
    RejectGap(csv, parts[i], rows.series[i], std::max(0.1, 10.0 * period_s));
  }
  log.values_missing = rows.values_missing;
  log.rate_hz = 1.0 / period_s;
  const double periods = (last_s - rows.first_s) / period_s;
  // Rows in bunches would make up to a million samples of each row.
  constexpr double kMostSamplesPerRow = 20.0;
  if (!(periods <= kMostSamplesPerRow * rows.count)) {
    csv.FailInRow(
        1, columns.time.empty() ? 1 : columns.time.front().column + 1,
        fmt::format("most rows come {:.3g} s after the one before, but all {} take {:.6g} "
                    "s, must come at an about even rate",
                    period_s, rows.count, last_s - rows.first_s));
  }
  const Eigen::Index samples = std::llround(periods) + 1;
  const Eigen::Index count = std::ssize(log.parts);
  log.command_deg = Signal(samples, count);
  log.angle_deg = Signal(samples, count);
  if (!columns.motors.empty()) log.motor_deg = Signal::Constant(samples, count, kNaN);
  log.kinds = KindsOf(rows.series, log.parts.size(), log.rate_hz);
  Signal* const signals[] = {&log.command_deg, &log.angle_deg, &log.motor_deg};
  for (std::size_t i = 0; i < parts.size(); ++i) {
    for (double& value : rows.series[i].value) {
      value = parts[i].scale.value_or(scale) * value + parts[i].offset_deg;
    }
    const Eigen::Index part = std::ranges::find(log.parts, parts[i].part) - log.parts.begin();
    Signal& signal = *signals[std::min<std::size_t>(i / log.parts.size(), 2)];
    const bool is_command = i < log.parts.size();
    ToEvenRows(rows.series[i], is_command, rows.first_s, log.rate_hz, signal.col(part));
  }
  return log;
}

}  // namespace

ChainEpisodes LoadChainEpisodes(const std::filesystem::path& file, const ChainLogOptions& options) {
  EpisodeReader reader(file, options);
  const ChainColumns& columns = reader.columns();
  const std::vector<PartColumn>& parts = reader.parts();
  std::vector<EpisodeRows> episodes;
  for (EpisodeRows rows; reader.Next(rows);) episodes.push_back(std::move(rows));
  const UnitOfLog unit =
      UnitOf(columns, MostWithoutUnit(parts, 2 * columns.commands.size(), episodes), options.unit);
  ChainLog shared;
  shared.name = OneLine(file.string());
  for (const PartColumn& command : columns.commands) shared.parts.push_back(command.part);
  shared.from_wearer = columns.is_trace;
  shared.columns_ignored = columns.ignored;
  shared.unit_known = unit.is_known;
  shared.unit_note = unit.note;
  for (const std::string& remark : reader.remarks()) {
    shared.unit_note += (shared.unit_note.empty() ? "" : " ") + remark;
  }
  ChainEpisodes result;
  const bool one = episodes.size() == 1;
  std::optional<UserError> first_error;
  for (EpisodeRows& rows : episodes) {
    const double number = rows.episode;
    try {
      result.logs.push_back(
          LogOf(columns, parts, unit.scale, reader.csv(), std::move(rows), shared));
      if (!one || options.episode) result.logs.back().episode = static_cast<int>(number);
    } catch (const UserError& error) {
      result.left_out.push_back(fmt::format("episode {:g}: {}", number, error.problem()));
      if (!first_error) first_error = error;
    }
  }
  if (result.logs.empty()) throw UserError(*first_error);
  return result;
}

double ValueAt(std::span<const double> values, double row) {
  const auto last = static_cast<double>(values.size() - 1);
  const auto before = static_cast<std::size_t>(std::clamp(row, 0.0, last));
  const std::size_t behind = std::min(before + 1, values.size() - 1);
  return std::lerp(values[before], values[behind],
                   std::clamp(row - static_cast<double>(before), 0.0, 1.0));
}

std::string FileNameOf(const ChainLog& log) {
  std::filesystem::path file = log.name;
  if (!file.has_filename()) file = file.parent_path();  // a folder with a slash behind it
  const bool is_trace = file.filename() == "trace.h5";
  return (is_trace ? file.parent_path().filename() / file.filename() : file.filename()).string();
}

std::string RemarksOf(const ChainLog& log, const ChainFit& fit) {
  std::string text;
  for (const std::string& remark : fit.remarks) text += (text.empty() ? "" : "; ") + remark;
  const auto unit = text.find("{unit}");
  if (unit != std::string::npos) text.replace(unit, 6, log.unit_known ? "deg" : "units");
  return text;
}

std::string WhatHysteresisIs(const std::vector<ChainFit>& fits) {
  const bool told_apart = std::ranges::any_of(
      fits, [](const ChainFit& fit) { return std::isfinite(fit.lost_motion_deg.value); });
  if (told_apart) {
    return "Hysteresis is the motor's own (dry friction, dead band) and lost motion, behind the "
           "motor: backlash of the gear, slack of cables and stretch of cables before they slide, "
           "which look alike, and of which little shows where a load holds the joint on one side. "
           "Without the motor's angle they are told apart by how sharp the joint turns.";
  }
  return "Hysteresis is the sum of dry friction, backlash of gears and slack of cables; no lost "
         "motion behind the motor is seen in these angles, and a log with the motors' angles, too "
         "(NAME_motor_deg), tells more.";
}

std::string WhatFramesAre(const ChainLog& log, const std::vector<ChainFit>& fits) {
  const auto framed = std::ranges::find_if(
      fits, [](const ChainFit& fit) { return fit.problem.empty() && fit.frames; });
  if (framed == fits.end()) return "";
  const double period_rows = framed->frames->period_rows;
  if (framed->frames->open_rows >= 0.5) {
    return fmt::format("The times of the command's steps are known within {:.1f} ms.",
                       500.0 / log.rate_hz);
  }
  return fmt::format("Commands step every {:.2f} ms, {}.", 1e3 * period_rows / log.rate_hz,
                     period_rows == std::round(period_rows)
                         ? "with the rows of the log"
                         : "between the rows of the log, where a clock that fits all steps says");
}

std::vector<std::optional<CommandClock>> FramesOf(const ChainLog& log) {
  const auto parts = static_cast<std::size_t>(log.command_deg.cols());
  if (const auto of_all = FindCommandClock(ChangesOf(log.command_deg))) return {parts, of_all};
  std::vector<std::optional<CommandClock>> frames;
  for (std::size_t part = 0; part < parts; ++part) {
    const std::vector<double> changes = ChangesOf(ColumnOf(log.command_deg, part));
    frames.push_back(FindCommandClock(changes));
    if (!frames.back()) frames.back() = StepsOf(changes);
    if (!frames.back() && log.held) frames.back() = CommandClock();
  }
  return frames;
}

std::vector<ChainFit> FitChains(const ChainLog& log, const ChainProgress& progress,
                                ChainDetail detail) {
  const std::vector<std::optional<CommandClock>> frames = FramesOf(log);
  const int parts = std::ssize(log.parts);
  std::vector<ChainFit> fits(log.parts.size());
  std::mutex mutex;
  int done = 0;
  const auto fit_part = [&](std::size_t i) {
    const auto part = static_cast<Eigen::Index>(i);
    const std::span<const double> command_deg = ColumnOf(log.command_deg, i);
    const std::span<const double> angle_deg = ColumnOf(log.angle_deg, i);
    if (!log.kinds.empty() && log.kinds[i] != CommandKind::kTarget) {
      fits[i].problem = ProblemOf(log.kinds[i], log.rate_hz);
    } else {
      fits[i] = FitChain(command_deg, angle_deg, log.rate_hz, parts, frames[i], detail);
    }
    if (log.motor_deg.size() > 0 && !std::isnan(log.motor_deg(0, part))) {
      AddMotor(command_deg, ColumnOf(log.motor_deg, i), angle_deg, log.rate_hz, fits[i], parts);
    }
    const std::lock_guard lock(mutex);
    if (progress) progress(++done, parts);
  };
  ForEachOnThreads(std::max(1U, std::thread::hardware_concurrency()), fits.size(), fit_part);
  const bool any = std::ranges::any_of(fits, [](const ChainFit& f) { return f.problem.empty(); });
  if (!any) {
    throw UserError({.place = log.name, .key = log.parts.front(), .problem = fits[0].problem});
  }
  return fits;
}

}  // namespace gauntlet::sim
