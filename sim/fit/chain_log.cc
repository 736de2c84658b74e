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
#include "sim/recordings/table_source.h"
#include "sim/recordings/time_guess.h"
#include "sim/tables/csv_reader.h"

namespace gauntlet::sim {
namespace {

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
  const std::vector<double> changes = ChangesOf(series.value);
  if (!FindCommandClock(changes) && !StepsOf(changes)) {
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

/// The valid values of all columns of one episode: commands, angles, motors.
struct ChainRows {
  double episode = 0.0;
  std::vector<Series> series;
  std::vector<double> steps_s;  // from row to row
  double count = 0.0;
  double first_s = 0.0;
  double last_s = 0.0;
  std::size_t values_missing = 0;
};

/// Number of the episode of each row: that of its one column, or counted by changes of several
/// columns or by times that begin anew.
class Episodes {
 public:
  explicit Episodes(const ChainColumns& columns)
      : columns_(columns), parts_(columns.episodes.size(), kNaN) {}

  /// True if the row begins another episode than the row before.
  bool Begins(std::span<const double> values, double time_s) {
    constexpr double kAnew = 0.1;  // of the time that has passed
    bool changes = false;
    for (std::size_t i = 0; i < parts_.size(); ++i) {
      const double part = values[columns_.episodes[i].column];
      changes = changes || part != parts_[i];
      parts_[i] = part;
    }
    const bool first = std::isnan(first_s_);
    const bool anew =
        !first && time_s < last_s_ && time_s - first_s_ <= kAnew * (last_s_ - first_s_);
    const bool begins = first || changes || (anew && parts_.empty());
    if (begins) {
      first_s_ = time_s;
      number_ = parts_.size() == 1 ? parts_.front() : first ? 0.0 : number_ + 1.0;
      numbers_.push_back(number_);
    }
    rows_ += 1.0;
    falls_ += !first && time_s < last_s_ ? 1.0 : 0.0;
    last_s_ = time_s;
    return begins;
  }

  double number() const { return number_; }

  /// Errors: UserError for times that fall, and a number that does not exist.
  void Check(const CsvReader& csv, std::optional<int> wanted) const {
    constexpr double kNearlyAlways = 0.9;
    if (falls_ > kNearlyAlways * (rows_ - 1.0)) {
      csv.FailInRow(1, columns_.time.front().column + 1,
                    "the time falls from row to row; sort the rows by it");
    }
    if (!wanted || std::ranges::find(numbers_, *wanted) != numbers_.end()) return;
    const auto [least, most] = std::ranges::minmax(numbers_);
    const std::size_t column =
        columns_.episodes.empty() ? columns_.time.front().column : columns_.episodes.front().column;
    csv.FailInRow(1, column + 1,
                  numbers_.size() == 1
                      ? fmt::format("the log has one episode, {:g}: --episode {} does not exist",
                                    least, *wanted)
                      : fmt::format("the log has {} episodes ({:g} to {:g}): --episode {} does not "
                                    "exist",
                                    numbers_.size(), least, most, *wanted));
  }

 private:
  const ChainColumns& columns_;
  std::vector<double> parts_;  // of the last row, by column
  double rows_ = 0.0;
  double falls_ = 0.0;  // rows whose time is before that of the row before
  double number_ = 0.0;
  double first_s_ = kNaN;
  double last_s_ = kNaN;
  std::vector<double> numbers_;
};

void AddRow(const std::vector<PartColumn>& columns, const std::vector<double>& values,
            double time_s, ChainRows& rows) {
  if (rows.count++ == 0.0) {
    rows.first_s = time_s;
  } else {
    rows.steps_s.push_back(time_s - rows.last_s);
  }
  rows.last_s = time_s;
  for (std::size_t i = 0; i < columns.size(); ++i) {
    const double value = values[columns[i].column];
    if (std::isnan(value)) {
      ++rows.values_missing;
      continue;
    }
    rows.series[i].time_s.push_back(time_s);
    rows.series[i].value.push_back(value);
  }
}

void CheckEpisode(double number, std::size_t column, const CsvReader& csv) {
  constexpr double kMost = 1e9;
  if (number >= 0.0 && number <= kMost && number == std::floor(number)) return;
  csv.Fail(column + 1,
           fmt::format("the episode is {}, must be a whole number of 0 to {:g}", number, kMost));
}

/// Reads only the columns of `columns` and of the parts. Errors: UserError for times that do not
/// rise.
std::vector<ChainRows> ReadRows(const ChainColumns& columns, const std::vector<PartColumn>& parts,
                                std::optional<int> wanted, CsvReader& csv) {
  std::vector<std::size_t> used;
  for (const EpisodeColumn& episode : columns.episodes) {
    used.push_back(episode.column);
    if (episode.is_text) csv.ReadAsTexts(episode.column);
  }
  for (const PartColumn& column : parts) used.push_back(column.column);
  ReadOnly(columns.time, used, csv);
  const std::size_t time_column = columns.time.front().column;
  std::vector<ChainRows> all;
  std::vector<double> values(csv.column_count());
  Episodes episodes(columns);
  double last_s = 0.0;
  while (csv.NextRow(values)) {
    double time_s = 0.0;
    for (const TimeMapping& time : columns.time) time_s += values[time.column] * time.scale_s;
    if (std::isnan(time_s)) csv.Fail(time_column + 1, "the time is missing");
    for (const EpisodeColumn& episode : columns.episodes) {
      CheckEpisode(values[episode.column], episode.column, csv);
    }
    const bool begins = episodes.Begins(values, time_s);
    if (!begins && time_s <= last_s) {
      csv.Fail(time_column + 1,
               fmt::format("the time is {} s, must be above the {} s of the row before", time_s,
                           last_s));
    }
    last_s = time_s;
    if (wanted && episodes.number() != *wanted) continue;
    if (begins) {
      ChainRows& rows = all.emplace_back();
      rows.episode = episodes.number();
      rows.series.resize(parts.size());
    }
    AddRow(parts, values, time_s, all.back());
  }
  episodes.Check(csv, wanted);
  if (all.empty()) csv.Fail(1, "the log has fewer than two rows");
  return all;
}

/// Scale of the columns whose names have no unit. Named angles beyond a turn of 6.28 are degrees.
/// Otherwise the unit is unknown, and `note` says so.
double ScaleWithoutUnit(const ChainColumns& columns, const std::vector<PartColumn>& parts,
                        const std::vector<ChainRows>& episodes, const std::string& wanted,
                        ChainLog& log) {
  double most = 0.0;
  bool any = false;
  for (std::size_t i = 0; i < 2 * columns.commands.size(); ++i) {
    if (parts[i].scale) continue;
    any = true;
    for (const ChainRows& rows : episodes) {
      for (const double value : rows.series[i].value) most = std::max(most, std::abs(value));
    }
  }
  if (!any) return 1.0;
  if (wanted == "rad") return kDegPerRad;
  if (wanted == "deg") return 1.0;
  constexpr double kMostRad = 6.4;
  if (columns.names_angles && most > kMostRad) {
    log.unit_note = fmt::format(
        "The names of the columns have no unit. Angles up to {:.4g} are read as degrees; for "
        "another unit see --unit.",
        most);
    return 1.0;
  }
  log.unit_known = false;
  log.unit_note = fmt::format(
      "The unit of the angles is unknown: the names have none, and values up to {:.4g} may be "
      "degrees, radians or a normalised position. If it is known, say --unit deg or --unit rad.",
      most);
  return 1.0;
}

/// Kinds of the commands, by the rows as they are: what is made of them at an even rate is no exact
/// copy of anything.
std::vector<CommandKind> KindsOf(const std::vector<Series>& series, std::size_t parts,
                                 double rate_hz) {
  std::vector<CommandKind> kinds;
  for (std::size_t i = 0; i < parts; ++i) {
    const Series& command = series[i];
    const Series& angle = series[parts + i];
    kinds.push_back(command.time_s == angle.time_s
                        ? FindCommandKind(command.value, angle.value, rate_hz)
                        : CommandKind::kTarget);
  }
  return kinds;
}

/// The episode at an even rate. `log` has what all episodes share.
/// Errors: UserError for fewer than two rows, a column without values, a long gap or uneven rows.
ChainLog LogOf(const ChainColumns& columns, const std::vector<PartColumn>& parts, double scale,
               const CsvReader& csv, ChainRows rows, ChainLog log) {
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
        1, columns.time.front().column + 1,
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
    (is_command ? InterpolateCommand : InterpolateLine)(rows.series[i], rows.first_s, log.rate_hz,
                                                        signal.col(part));
  }
  return log;
}

}  // namespace

ChainEpisodes LoadChainEpisodes(const std::filesystem::path& file, const ChainLogOptions& options) {
  FoundTable table =
      FindTable(file.string(), TableSource(file, options.array), ProblemHandling::kAllowMissing);
  CsvReader& csv = table.reader;
  const ChainColumns columns = FindChainColumns(table, options.map);
  ChainLog shared;
  shared.name = OneLine(file.string());
  for (const PartColumn& command : columns.commands) shared.parts.push_back(command.part);
  shared.from_wearer = columns.is_trace;
  shared.columns_ignored = columns.ignored;
  std::vector<PartColumn> parts = columns.commands;
  parts.insert(parts.end(), columns.angles.begin(), columns.angles.end());
  parts.insert(parts.end(), columns.motors.begin(), columns.motors.end());
  std::vector<ChainRows> episodes = ReadRows(columns, parts, options.episode, csv);
  const double scale = ScaleWithoutUnit(columns, parts, episodes, options.unit, shared);
  ChainEpisodes result;
  const bool one = episodes.size() == 1;
  std::optional<UserError> first_error;
  for (ChainRows& rows : episodes) {
    const double number = rows.episode;
    try {
      result.logs.push_back(LogOf(columns, parts, scale, csv, std::move(rows), shared));
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
