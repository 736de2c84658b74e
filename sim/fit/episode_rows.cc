#include "sim/fit/episode_rows.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "controller/assert.h"
#include "controller/calibration/robust_statistics.h"
#include "sim/base/error.h"
#include "sim/base/signal.h"
#include "sim/base/text.h"
#include "sim/fit/command_clock.h"
#include "sim/recordings/table_source.h"
#include "sim/tables/file_format.h"

namespace gauntlet::sim {
namespace {

/// Linear interpolation at an even rate, beginning at start_s; constant beyond the ends.
void InterpolateLine(const ColumnSeries& series, double start_s, double rate_hz,
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

/// The value of the nearest row.
void SetToNearest(const ColumnSeries& series, double start_s, double rate_hz,
                  Eigen::Ref<Eigen::VectorXd> result) {
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

/// Adds a row before each gap's end: a command holds until the next one is sent.
void HoldOverGaps(ColumnSeries& series) {
  if (series.time_s.size() < 3) return;
  std::vector<double> steps_s;
  for (std::size_t i = 1; i < series.time_s.size(); ++i) {
    steps_s.push_back(series.time_s[i] - series.time_s[i - 1]);
  }
  const double period_s = controller::MedianOf(steps_s);
  constexpr double kGap = 3.0;
  ColumnSeries held;
  for (std::size_t i = 0; i < series.time_s.size(); ++i) {
    if (i > 0 && series.time_s[i] - series.time_s[i - 1] > kGap * period_s) {
      held.time_s.push_back(series.time_s[i] - period_s);
      held.value.push_back(series.value[i - 1]);
    }
    held.time_s.push_back(series.time_s[i]);
    held.value.push_back(series.value[i]);
  }
  series = std::move(held);
}

void CheckEpisode(double number, std::size_t column, const CsvReader& csv) {
  constexpr double kMost = 1e9;
  if (number >= 0.0 && number <= kMost && number == std::floor(number)) return;
  csv.Fail(column + 1,
           fmt::format("the episode is {}, must be a whole number of 0 to {:g}", number, kMost));
}

}  // namespace

EpisodeReader::Inputs EpisodeReader::Open(const std::filesystem::path& file,
                                          const ChainLogOptions& options) {
  const bool is_given = !options.command.empty() && !options.state.empty();
  if (is_given && options.command == options.state) {
    throw UserError({.place = "--command " + options.command,
                     .problem = "is the topic of the states, must be another"});
  }
  TopicPair topics{options.command, options.state, is_given};
  if (!is_given) {
    OpenedTable opened = OpenTable(file, options.array);
    const std::string name = OneLine(file.string());
    if (opened.table && options.command.empty() && options.state.empty()) {
      return {.table = *std::move(opened.table), .commands = {}, .topics = {}};
    }
    if (opened.table || !HasTopics(opened.format)) {
      throw UserError({.place = name,
                       .problem = "has no two topics for --command and --state: they are for a bag "
                                  "or for MCAP"});
    }
    topics = FindTopicPair(name, opened.topics, options.command, options.state);
  }
  TableInput states = TableSource(file, topics.state);
  TableInput commands = TableSource(file, topics.command);
  return {.table = std::move(states), .commands = std::move(commands), .topics = std::move(topics)};
}

EpisodeReader::EpisodeReader(const std::filesystem::path& file, const ChainLogOptions& options)
    : EpisodeReader(file, options, Open(file, options)) {}

EpisodeReader::EpisodeReader(const std::filesystem::path& file, const ChainLogOptions& options,
                             Inputs inputs)
    : table_(FindTable(file.string(), std::move(inputs.table), ProblemHandling::kAllowMissing)),
      wanted_(options.episode),
      rate_hz_(options.rate_hz),
      values_(table_.reader.column_count()),
      first_s_(kNaN),
      last_s_(kNaN) {
  if (inputs.commands) {
    commands_.emplace(
        FindTable(file.string(), *std::move(inputs.commands), ProblemHandling::kAllowMissing));
    columns_ = PairTopics(*commands_, table_, inputs.topics, remarks_);
  } else {
    columns_ = FindChainColumns(table_, options.map, options.rate_hz, options.time_unit);
  }
  marks_.assign(columns_.episodes.size(), kNaN);
  parts_ = columns_.commands;
  parts_.insert(parts_.end(), columns_.angles.begin(), columns_.angles.end());
  parts_.insert(parts_.end(), columns_.motors.begin(), columns_.motors.end());
  std::vector<std::size_t> used;
  for (const EpisodeColumn& episode : columns_.episodes) {
    used.push_back(episode.column);
    if (episode.is_text) table_.reader.ReadAsTexts(episode.column);
  }
  for (std::size_t i = commands_ ? columns_.commands.size() : 0; i < parts_.size(); ++i) {
    used.push_back(parts_[i].column);
  }
  ReadOnly(columns_.time, used, table_.reader);
}

/// Also counts the episodes: the number is that of their one column, or grows with changes of
/// several columns or with times that begin anew.
bool EpisodeReader::BeginsEpisode() {
  constexpr double kAnew = 0.1;  // of the time that has passed
  bool changes = false;
  for (std::size_t i = 0; i < marks_.size(); ++i) {
    const double mark = values_[columns_.episodes[i].column];
    CheckEpisode(mark, columns_.episodes[i].column, table_.reader);
    changes = changes || mark != marks_[i];
    marks_[i] = mark;
  }
  const double time_s = row_->time_s;
  const bool first = std::isnan(first_s_);
  const bool anew = !first && time_s < last_s_ && time_s - first_s_ <= kAnew * (last_s_ - first_s_);
  rows_ += 1.0;
  falls_ += !first && time_s < last_s_ ? 1.0 : 0.0;
  if (!first && !changes && !(anew && marks_.empty())) return false;
  first_s_ = time_s;
  numbers_.push_back(marks_.size() == 1 ? marks_.front() : first ? 0.0 : numbers_.back() + 1.0);
  return true;
}

/// Reads a row into `values_` and `row_`.
bool EpisodeReader::NextRow() {
  CsvReader& csv = table_.reader;
  row_.reset();
  if (!csv.NextRow(values_)) return false;
  row_.emplace();
  row_->time_s = columns_.time.empty() ? rows_ / rate_hz_ : TimeOfRow(columns_.time, values_);
  if (std::isnan(row_->time_s)) csv.Fail(TimeColumn() + 1, "the time is missing");
  row_->begins = BeginsEpisode();
  row_->episode = numbers_.back();
  if (!row_->begins && row_->time_s <= last_s_) {
    csv.Fail(TimeColumn() + 1, fmt::format("the time is {} s, must be above the {} s of the row "
                                           "before",
                                           row_->time_s, last_s_));
  }
  last_s_ = row_->time_s;
  return true;
}

void EpisodeReader::AddRow(EpisodeRows& rows) const {
  const double time_s = row_->time_s;
  if (rows.count++ == 0.0) {
    rows.first_s = time_s;
  } else {
    rows.steps_s.push_back(time_s - rows.last_s);
  }
  rows.last_s = time_s;
  bool is_whole = true;
  for (std::size_t i = commands_ ? columns_.commands.size() : 0; i < parts_.size(); ++i) {
    const double value = values_[parts_[i].column];
    if (std::isnan(value)) {
      rows.rows_missing += std::exchange(is_whole, false) ? 1 : 0;
      ++rows.values_missing;
      continue;
    }
    rows.series[i].time_s.push_back(time_s);
    rows.series[i].value.push_back(value);
  }
}

void EpisodeReader::CheckAll() const {
  const CsvReader& csv = table_.reader;
  constexpr double kNearlyAlways = 0.9;
  if (rows_ > 1.0 && falls_ > kNearlyAlways * (rows_ - 1.0)) {
    csv.FailInRow(1, TimeColumn() + 1, "the time falls from row to row; sort the rows by it");
  }
  if (numbers_.empty()) csv.Fail(1, "the log has fewer than two rows");
  if (!wanted_ || std::ranges::find(numbers_, *wanted_) != numbers_.end()) return;
  const auto [least, most] = std::ranges::minmax(numbers_);
  const std::size_t column =
      columns_.episodes.empty() ? TimeColumn() : columns_.episodes.front().column;
  csv.FailInRow(
      1, column + 1,
      numbers_.size() == 1
          ? fmt::format("the log has one episode, {:g}: --episode {} does not exist", least,
                        *wanted_)
          : fmt::format("the log has {} episodes ({:g} to {:g}): --episode {} does not exist",
                        numbers_.size(), least, most, *wanted_));
}

/// All rows of the topic of the commands.
void EpisodeReader::ReadCommands(EpisodeRows& rows) {
  CsvReader& csv = commands_->reader;
  const std::vector<TimeMapping> time = TimeByName(csv.name(), commands_->layout);
  std::vector<std::size_t> used;
  for (const PartColumn& command : columns_.commands) used.push_back(command.column);
  ReadOnly(time, used, csv);
  std::vector<double> values(csv.column_count());
  double last_s = -HUGE_VAL;
  while (csv.NextRow(values)) {
    const double time_s = TimeOfRow(time, values);
    if (!(time_s > last_s)) continue;  // sent twice
    last_s = time_s;
    for (std::size_t i = 0; i < columns_.commands.size(); ++i) {
      const double value = values[columns_.commands[i].column];
      if (std::isnan(value)) continue;
      rows.series[i].time_s.push_back(time_s);
      rows.series[i].value.push_back(value);
    }
  }
  for (std::size_t i = 0; i < columns_.commands.size(); ++i) {
    HoldOverGaps(rows.series[i]);
    const std::vector<double>& times_s = rows.series[i].time_s;
    if (times_s.empty()) continue;
    if (times_s.front() > rows.last_s || times_s.back() < rows.first_s) {
      csv.Fail(columns_.commands[i].column + 1,
               fmt::format("the commands of {} are not from the time of the states: do the topics "
                           "have two clocks?",
                           csv.Quoted(columns_.commands[i].part)));
    }
  }
}

bool EpisodeReader::Next(EpisodeRows& rows) {
  if (!row_ && !NextRow()) {
    CheckAll();
    return false;
  }
  while (wanted_ && row_->episode != *wanted_) {
    if (NextRow()) continue;
    CheckAll();
    return false;
  }
  rows = EpisodeRows();
  rows.episode = row_->episode;
  rows.series.resize(parts_.size());
  do {
    AddRow(rows);
  } while (NextRow() && !row_->begins);
  if (commands_) ReadCommands(rows);
  return true;
}

void ToEvenRows(const ColumnSeries& series, bool is_command, double start_s, double rate_hz,
                const Eigen::Ref<Eigen::VectorXd>& result) {
  GAUNTLET_ASSERT(!series.value.empty() && rate_hz > 0.0);
  const std::vector<double> changes = is_command ? ChangesOf(series.value) : std::vector<double>();
  const bool has_steps = is_command && (FindCommandClock(changes) || StepsOf(changes));
  (has_steps ? SetToNearest : InterpolateLine)(series, start_s, rate_hz, result);
}

UnitOfLog UnitOf(const ChainColumns& columns, double most, const std::string& wanted) {
  const auto has_unit = [](const PartColumn& column) { return column.scale.has_value(); };
  if (std::ranges::all_of(columns.commands, has_unit) &&
      std::ranges::all_of(columns.angles, has_unit)) {
    return {};
  }
  if (wanted == "rad") return {.scale = kDegPerRad};
  if (wanted == "deg") return {};
  constexpr double kMostRad = 6.4;
  if (columns.names_angles && most > kMostRad) {
    return {.note = fmt::format("The names of the columns have no unit. Angles up to {:.4g} are "
                                "read as degrees; for another unit see --unit.",
                                most)};
  }
  return {.is_known = false,
          .note = fmt::format(
              "The unit of the angles is unknown: the names have none, and values up to {:.4g} may "
              "be degrees, radians or a normalised position. If it is known, say --unit deg or "
              "--unit rad.",
              most)};
}

}  // namespace gauntlet::sim
