#pragma once

#include <cstddef>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "sim/base/channels.h"
#include "sim/recordings/channel_values.h"
#include "sim/recordings/column_map.h"
#include "sim/recordings/column_scale.h"
#include "sim/recordings/time_guess.h"
#include "sim/tables/csv_reader.h"
#include "sim/tables/missing.h"

namespace gauntlet::sim {

/// Facts that reading a recording needs besides the file.
struct RecordingFormat {
  std::string map;         // column map; empty: the header's names
  std::string array = {};  // of a file with arrays, see ListArrays(); empty: by their sizes
  double rate_hz = 0.0;    // rows per second of a file without time; 0: the file has a time column
  int skipped_lines = 0;   // at the beginning of the file, as headers of a sensor's software
  std::string_view rate_key = "file_rate_hz";  // what messages call it
  ProblemHandling handling = ProblemHandling::kStrict;
  double longest_gap_ms = 100.0;  // a longer one is a problem
  // For columns in counts: one for all channels, or one for each of KnownChannels().
  std::vector<NominalCounts> nominal = {NominalCounts{}};
  double repair_budget_percent = 5.0;  // of rows: more repairs are a mistake. See LoadRecording
  bool keeps_to_range = true;          // an angle beyond the joint's range is a problem
};

/// True if no hand and no bad calibration reaches the angle: further outside the joint's range than
/// half of it. NaN is not.
bool IsFarBeyondRange(const Channel& joint, double angle_rad);

/// Reads a recording row by row, in one pass and with flat memory: angles [rad] at times [s] that
/// rise strictly. A missing value is NaN.
///
/// Faults found: everything that CsvReader finds; time that stands still (the row is left out; one
/// that also repeats all values was written twice: a repair leaves it out and counts none),
/// that goes back by up to a second (left out) or by more (a new start of the clock: time goes on),
/// gaps, a wild time (left out: one row far ahead or far back, while the next row goes on from the
/// row before it; or the last row of the file, if it is more than a second away), and angles
/// further outside the joint's range than half of that range (see IsFarBeyondRange) or outside it
/// at all (both only counted; a tenth of a degree is rounding). Strict reading stops at the
/// first of them; repair counts them. Errors: UserError `file:row:column: ...` in one line.
class RecordingReader {
 public:
  RecordingReader(std::string name, TableInput input, const RecordingFormat& format);

  /// False at the end. `angle_rad` has one place per channel of KnownChannels().
  bool NextRow(double& time_s, std::span<double> angle_rad);

  const std::vector<bool>& has_channel() const { return has_channel_; }
  /// The channels that are in counts of a glove.
  const std::vector<OwnCounts>& own_counts() const { return own_counts_; }
  /// True if the clock started anew before the last row.
  bool restarted() const { return restarted_; }
  /// Line of the last row, from 1.
  std::size_t row() const { return row_; }
  /// Notes a problem that was found in an earlier row of a channel; in a strict reading a
  /// UserError.
  void Report(RecordingProblem problem, std::size_t row, std::size_t channel,
              const std::string& message);
  /// One line per problem: what, how often, and the first row.
  std::vector<std::string> Remarks() const;
  /// The problem that needs a repair most often; none if none does.
  std::optional<RecordingProblem> MostFrequentRepair() const;
  /// Share of the rows read so far that needed a repair.
  double RepairedShare() const;
  /// The problem found most often, as such a line without the file; empty if there is none.
  std::string MostFrequentProblem() const;

 private:
  struct Count {
    std::size_t rows = 0;
    std::size_t first_row = 0;
    std::map<std::size_t, std::size_t> rows_of_channel = {};  // of a problem of single channels
  };
  void ReportHere(RecordingProblem problem, std::size_t column, const std::string& message);
  std::string Remark(RecordingProblem problem, const Count& count) const;
  Count& Note(RecordingProblem problem, std::size_t row);
  void CheckRange(std::size_t channel, double angle_rad);
  bool ReadRow();
  bool FixTime(double& time_s);
  bool IsWildTime(double step_s);
  void AddChannels(const RecordingFormat& format);

  ProblemHandling handling_;
  std::map<RecordingProblem, Count> problems_;
  std::vector<std::string> notes_;  // about the header, for a repair
  std::unique_ptr<CsvReader> csv_;
  ColumnMap map_;
  std::vector<std::size_t> channels_;  // that the map gives, in the order of their last columns
  ChannelValues angles_;               // of them [rad]
  bool keeps_to_range_ = true;
  std::vector<bool> has_channel_;
  std::vector<OwnCounts> own_counts_;
  std::vector<double> values_;
  std::vector<double> last_values_;  // of the last row that was taken
  std::size_t doubled_rows_ = 0;
  std::size_t row_ = 0;
  std::vector<double> next_values_;  // of the row behind, if it was needed
  std::size_t next_row_ = 0;
  bool has_next_ = false;
  double row_period_s_ = 0.0;
  double longest_gap_s_ = 0.0;
  double last_time_s_ = 0.0;
  double last_step_s_ = 0.0;
  double clock_offset_s_ = 0.0;
  MidnightClock midnight_;
  std::size_t good_rows_ = 0;
  bool restarted_ = false;
  std::size_t repaired_rows_ = 0;
  std::size_t last_repaired_row_ = 0;  // in the file
};

}  // namespace gauntlet::sim
