#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "sim/recordings/channel_values.h"
#include "sim/recordings/column_map.h"
#include "sim/tables/table_layout.h"
#include "sim/tables/text_lines.h"

namespace gauntlet::sim {

/// The beginning of a stream: the shape of its table, as FindTable() finds it, and the rows that it
/// took to find it.
struct StreamHead {
  TableLayout layout;
  std::vector<std::string> names;  // as the stream has them; empty: no line of names
  bool lacks_first_name = false;   // of a column of row numbers, as data frames write it
  std::vector<TextLine> rows;
};

/// False for empty lines and comments.
bool IsRow(std::string_view line);

/// Reads up to the first row, so that a live stream gets its answer at once. Without a map a first
/// line of numbers is the header. If a column may be the time (see MayBeTime, or a clock) and none
/// is by its name, as many rows are read as tell the rate.
/// Errors: UserError for an empty stream.
StreamHead ReadHead(TextLines& lines, bool has_map);

/// Choices of a person about the columns of a stream.
struct StreamColumns {
  std::string map = {};                 // column map; empty: columns as their names say
  std::vector<std::string> asked = {};  // channels to filter; empty: all
  std::string time_unit = {};           // of a column of numbers that is the time; empty: found
  std::string hand = {};                // left or right; empty: all rows, which are of one hand
};

/// The table that runs through `gauntlet filter`, line by line: which columns are the time, which
/// make channels, and which pass through.
///
/// Without a map every column but the time is a channel, in its own unit. With one (see
/// ReadColumnMap) the channels are those of the map, in degrees, each in the place of the first
/// column that it is made of and called `NAME_deg`; all other columns pass through, and a first
/// line of numbers is a row. StreamColumns::asked has channels, without a map columns by names or
/// numbers from 1.
///
/// Errors: UserError `standard input:row:column: ...`, or of the map; also for rows of both hands
/// of which none is chosen.
class StreamTable {
 public:
  StreamTable(const StreamHead& head, const StreamColumns& given);

  /// The line that comes out first, with its end; empty if the stream has no header.
  std::string_view header() const { return header_; }
  /// Number of channels to filter.
  std::size_t channel_count() const { return filtered_.size(); }
  /// Unit of the channels: deg of a map; empty: their own.
  std::string_view unit() const { return has_map_ ? "deg" : ""; }
  bool has_time() const { return !time_.empty(); }
  const std::vector<TimeMapping>& time() const { return time_; }
  /// Seconds per unit of Time().
  double time_scale_s() const { return time_.front().scale_s; }
  std::size_t time_column() const { return time_.front().column; }

  /// Cuts the next line, the row `row` from 1, into cells. It must outlive their use.
  void Read(std::string_view line, std::size_t row);
  /// True if the line is to be left out.
  bool IsOfOtherHand();
  /// NaN if it is not to be read.
  double Time() const;
  /// The cell that Time() begins with.
  std::string_view TimeText() const { return fields_[time_column()]; }
  /// Facts of the map that a person should know, a sentence each.
  const std::vector<std::string>& remarks() const { return remarks_; }
  /// True if values of channels depend on the times of the rows.
  bool needs_time() const { return channels_.needs_time(); }
  /// Value of a channel to filter; NaN if a part of it is missing. `time_s`: of the row.
  double Value(std::size_t channel, double time_s) { return ValueOf(filtered_[channel], time_s); }
  /// The row, with these values of the channels to filter, and its end.
  std::string_view Written(std::span<const double> values, double time_s);

  [[noreturn]] static void Fail(std::size_t row, const std::string& problem);
  [[noreturn]] static void Fail(std::size_t row, std::size_t column, const std::string& problem);

 private:
  /// Cell of the rows that come out: a channel, or a column that passes through.
  struct OutputCell {
    std::size_t column = 0;
    std::optional<std::size_t> channel = {};
  };

  void ChooseColumns(const StreamHead& head, const StreamColumns& given);
  void ApplyMap(const StreamHead& head, const std::string& map,
                const std::vector<std::string>& asked);
  /// The channels of a map and the columns that pass through; returns the names of the channels.
  std::vector<std::string> AddMappedChannels(const ColumnMap& map);
  void KeepAsked(const std::vector<std::string>& names, const std::vector<std::string>& asked);
  void AddChannel(std::size_t column, std::vector<ChannelValues::Parts>& channels);
  std::string Plain(std::string_view field) const;
  double ValueOf(std::size_t channel, double time_s);
  void WriteNumber(std::size_t channel, double value);

  bool has_map_ = false;
  char separator_ = ',';
  std::size_t columns_ = 0;
  std::vector<TimeMapping> time_;  // its sum
  std::optional<HandRows> hand_;   // without a side until a row names it
  bool hand_is_chosen_ = false;
  ChannelValues channels_;
  std::vector<std::size_t> filtered_;  // of the channels
  std::vector<OutputCell> output_;
  std::string header_;
  std::vector<std::string> remarks_;

  std::size_t row_ = 0;
  std::vector<std::string_view> fields_;
  std::vector<double> values_;  // of the columns that make channels
  std::string text_;
};

}  // namespace gauntlet::sim
