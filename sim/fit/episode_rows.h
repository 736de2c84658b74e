#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "sim/fit/chain_columns.h"
#include "sim/recordings/time_guess.h"
#include "sim/tables/csv_reader.h"
#include "sim/tables/table.h"
#include "sim/tables/table_layout.h"

namespace gauntlet::sim {

struct ChainLogOptions {
  std::string array = {};           // of a file with several, see ListArrays()
  std::string map = {};             // column map with command, angle, motor; empty: by names
  std::string unit = {};            // of columns whose names have none: deg or rad
  std::optional<int> episode = {};  // the only one to read, of a log with several
  double rate_hz = 0.0;             // of even rows without a time; 0: by the time
  std::string time_unit = {};       // of a column of numbers; empty: see TimeByName()
  std::string command = {};         // topics of a file of messages; empty: see FindTopicPair()
  std::string state = {};
};

/// Valid values of one column and their times.
struct ColumnSeries {
  std::vector<double> time_s;
  std::vector<double> value;
};

/// The rows of one episode as they are in the file.
struct EpisodeRows {
  double episode = 0.0;
  std::vector<ColumnSeries> series;  // of all commands, then of all angles, then of the motors
  std::vector<double> steps_s;       // from row to row
  double count = 0.0;
  double first_s = 0.0;
  double last_s = 0.0;
  std::size_t values_missing = 0;
  std::size_t rows_missing = 0;  // with a missing value
};

/// A row of a log, the first of an episode or not.
struct LogRow {
  bool begins = false;
  double episode = 0.0;
  double time_s = 0.0;
};

/// Reads a log of commands and angles, of any format of TableSource with a header and a time (see
/// TimeByName), episode by episode. An episode begins where a column of ChainColumns::episodes
/// changes, or where times begin anew. Of two topics (see FindTopicPair()) commands have their own
/// times; they are one episode.
class EpisodeReader {
 public:
  /// Errors: UserError as of TableSource(), TimeByName(), FindChainColumns() and PairTopics().
  EpisodeReader(const std::filesystem::path& file, const ChainLogOptions& options);

  const ChainColumns& columns() const { return columns_; }
  /// The columns of EpisodeRows::series.
  const std::vector<PartColumn>& parts() const { return parts_; }
  const CsvReader& csv() const { return table_.reader; }
  /// Sentences on what is assumed.
  const std::vector<std::string>& remarks() const { return remarks_; }

  /// The next episode; false at the end. Errors: UserError `file:row:column: ...` for times that do
  /// not rise, and at the end for a log without rows, and for a chosen episode that is not there.
  bool Next(EpisodeRows& rows);

 private:
  struct Inputs {
    TableInput table;
    std::optional<TableInput> commands;
    TopicPair topics;
  };
  static Inputs Open(const std::filesystem::path& file, const ChainLogOptions& options);
  EpisodeReader(const std::filesystem::path& file, const ChainLogOptions& options, Inputs inputs);
  void ReadCommands(EpisodeRows& rows);
  bool NextRow();
  bool BeginsEpisode();
  /// Column of the time, or the first, for messages.
  std::size_t TimeColumn() const {
    return columns_.time.empty() ? 0 : columns_.time.front().column;
  }
  void AddRow(EpisodeRows& rows) const;
  void CheckAll() const;

  FoundTable table_;                         // of two topics, that of the states
  std::optional<FoundTable> commands_ = {};  // that of the commands
  std::vector<std::string> remarks_ = {};
  ChainColumns columns_;
  std::vector<PartColumn> parts_;
  std::optional<int> wanted_;
  double rate_hz_;
  std::vector<double> values_;        // of the row
  std::optional<LogRow> row_;         // read, but given by no Next() yet
  std::vector<double> marks_;         // of the last row, by columns of episodes
  std::vector<double> numbers_ = {};  // of all episodes
  double first_s_;
  double last_s_;
  double rows_ = 0.0;
  double falls_ = 0.0;  // rows whose time is before that of the row before
};

/// The values of a column at an even rate from `start_s` on, constant beyond its ends: by straight
/// lines, but a command in steps (see FindCommandClock() and StepsOf()) by the nearest row, because
/// it never had a value in between. Precondition: the column has values.
void ToEvenRows(const ColumnSeries& series, bool is_command, double start_s, double rate_hz,
                const Eigen::Ref<Eigen::VectorXd>& result);

/// Scale of the columns whose names have no unit, and what is known of it.
struct UnitOfLog {
  double scale = 1.0;
  bool is_known = true;   // false: the unit of the file
  std::string note = {};  // how the unit is known, or that it is not; empty: from the names
};
/// `most`: the largest absolute value of the commands and angles whose names have no unit. Named
/// angles beyond a turn of 6.28 are degrees. Otherwise the unit is unknown, unless `wanted` has it.
UnitOfLog UnitOf(const ChainColumns& columns, double most, const std::string& wanted);

}  // namespace gauntlet::sim
