#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "sim/tables/csv_reader.h"
#include "sim/tables/table_layout.h"

namespace gauntlet::sim {

struct Profile;

/// How the numbers of a recording's columns become joint angles.
enum class RecordedUnit {
  kDegrees,
  kRadians,
  kCounts,  // of the nominal sensor and a converter
  kShare,   // of the joint's range: 0 its lower end, 1 its upper end
};

/// Two values of a column whose angles the map gives.
struct RawPoints {
  double low = 0.0;
  double high = 0.0;
};

/// Contribution of a column to a channel: weight * unit(scale * value + offset). The angle of a
/// channel is the sum over its mappings.
struct ColumnMapping {
  std::size_t column = 0;  // from 0
  int channel = 0;
  RecordedUnit unit = RecordedUnit::kDegrees;
  double scale = 1.0;                    // sign included
  double offset = 0.0;                   // in the unit
  int bits = 0;                          // of the converter that counts are of; 0: the scenario's
  bool in_counts = false;                // of a glove's converter
  std::optional<RawPoints> points = {};  // of a map with two known values
  double weight = 1.0;
  double wraps_at = 0.0;     // the column's values jump by this; 0: they do not
  double envelope_ms = 0.0;  // window of the Envelope of the values; 0: the values themselves
  std::string assumed = {};  // what of this row is a guess, as in the map; empty: nothing
};

/// Bits of the widest converter.
inline constexpr int kMostMapBits = 24;

/// The name of a map's row for all columns: `all,confirmed` confirms what the map assumes.
inline constexpr std::string_view kAllOfMap = "all";

/// Contribution of a column to the time, which is the sum over its columns.
struct TimeMapping {
  std::size_t column = 0;
  double scale_s = 1.0;  // seconds per unit
  bool is_text = false;  // of dates and clocks: see SecondsOfText
};

/// Rows of one hand in a table with the rows of both.
struct HandRows {
  std::size_t column = 0;  // of texts: left, right, L, R, ..
  std::string side;        // left or right
};

/// Which column is what.
struct ColumnMap {
  std::vector<TimeMapping> time;  // empty: the file has none
  std::vector<ColumnMapping> channels;
  std::optional<HandRows> hand = {};  // none: all rows
  bool is_confirmed = false;          // by a person: nothing is assumed
};

/// left or right, by a word of a text; empty for others.
std::string HandInText(std::string_view text);
/// Makes a reader pass over the rows of the other hand.
void KeepHand(const HandRows& hand, CsvReader& reader);

/// Which joints a map assumes, and what of them, in one sentence; empty if nothing is assumed.
std::string AssumptionsOf(const ColumnMap& map);

/// From the names in the file's header: a column of time (see TimeByName) or the name of a channel
/// with the unit as a suffix (`index_mcp_rad`), without one in `unit`: deg, rad, counts or share.
/// `k`, the sample's number in a trace, is passed over. In a strict reading every column must be
/// known; otherwise the unknown ones are reported and left out.
/// Errors: UserError at the place in the recording.
ColumnMap MapByHeader(const CsvReader& recording, ProblemHandling handling,
                      std::vector<std::string>& left_out, std::string_view unit = "deg");

/// The column of texts that name a hand in each of the first rows; none if there is no such one.
std::optional<std::size_t> HandColumn(const TableLayout& layout);

/// From a map file, or from a profile by its name or file: a text table like a recording (see
/// CsvReader), with a header `column,channel` and any of the other keys.
/// docs/reference/column-maps.md has the language with examples. Columns that the map does not
/// name are left out. Errors: UserError `map:row:column: ...`.
ColumnMap ReadColumnMap(const std::filesystem::path& map, const CsvReader& recording);

/// The columns of a table, as a map names them.
struct RecordingColumns {
  std::string name;                      // of the file, for messages
  std::vector<std::string> header = {};  // empty if the file has none
  std::size_t count = 0;
  bool may_choose_rows = false;  // of one hand
};

/// Column map as for a CsvReader, of columns that are given by name.
ColumnMap ReadColumnMap(const std::filesystem::path& map, const RecordingColumns& recording);
/// The map of a profile, likewise; columns that the recording does not have are left out.
ColumnMap MapOfProfile(const Profile& profile, const RecordingColumns& recording);

/// A column of a log of commands and angles: angle [deg] = scale * value + offset_deg.
struct PartMapping {
  std::size_t column = 0;
  std::string role;  // command, angle or motor
  std::string part;  // joint or motor; empty in a log of one
  double scale = 1.0;
  double offset_deg = 0.0;
};

/// Which column of a log is what.
struct LogMap {
  std::vector<TimeMapping> time;  // empty: not by the map
  std::vector<PartMapping> parts;
};

/// From a map file as ReadColumnMap() reads it, with the channels `command`, `angle` and `motor`,
/// and the name of the part in the key `joint`. Errors: UserError `map:row:column: ...`.
LogMap ReadLogMap(const std::filesystem::path& map, const RecordingColumns& recording);

}  // namespace gauntlet::sim
