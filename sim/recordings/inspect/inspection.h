#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "sim/base/channels.h"
#include "sim/recordings/inspect/joint_choice.h"
#include "sim/recordings/inspect/senders.h"
#include "sim/recordings/quantities.h"
#include "sim/recordings/table_statistics.h"
#include "sim/tables/array_table.h"
#include "sim/tables/file_format.h"
#include "sim/tables/message_table.h"
#include "sim/tables/table_layout.h"

namespace gauntlet::sim {

/// Largest part of a file that is read: hours of any glove.
inline constexpr std::uintmax_t kMostInspectedBytes = std::uintmax_t{1} << 30;

/// A column and its interpretation.
struct InspectedColumn {
  std::string name;  // may be empty
  CellKind kind = CellKind::kNumber;
  ColumnStatistics statistics;  // for numbers
  bool is_time = false;
  std::string time_unit;  // as in a column map; empty: no time, or one that repeats or has bursts
  Quantity quantity = Quantity::kUnknown;
  bool is_sensor = false;  // of the family that drives the joints
  bool is_dead = false;    // a sensor with one value in nearly all rows: drives no joint
  std::string channel;     // empty: ignored
  JointBasis basis = JointBasis::kName;
  bool is_inverted = false;       // falls while the joint bends
  double added = 0.0;             // deg or rad, to be in the joint's range
  bool is_turning = false;        // jumps by 360
  bool is_from_straight = false;  // looks like 180 deg where the joint is straight
  double envelope_ms = 0.0;  // of a muscle: `statistics` are those of its Envelope; 0: its values
  std::vector<ColumnMapping> mappings = {};  // of a map or a profile; empty: by the unit
  std::string why;                           // reason for the channel, or for ignoring the column
};

inline constexpr double kRadPerMilliradian = 1e-3;

/// Answer to the question of an Inspection.
enum class Remedy {
  kInSentence,   // named by the question itself
  kMap,          // a column map
  kPresetOrMap,  // a glove's preset or a column map
  kIdentify,     // another command, as the file is a log of commands and angles
};

/// Findings about a third-party recording.
struct Inspection {
  std::string file;
  FileFormat format = FileFormat::kText;
  std::string array;                // name of the chosen array or topic
  std::vector<ListedArray> arrays;  // of a file with arrays
  std::vector<ListedTopic> topics;  // of a file of messages; if none is taken, nothing follows
                                    // but the question
  std::uintmax_t file_bytes = 0;
  bool is_whole = true;     // false: only the beginning of a large file was read
  bool is_cut = false;      // the file ends before its end; what is whole was read
  bool is_tracked = false;  // the angles are of keypoints or bones: no joint has a cable
  TableLayout layout;
  std::size_t rows = 0;
  std::map<std::string, std::size_t> problems;  // number of rows by problem, see NameOf()
  std::vector<std::string> remarks;             // of the source of the table
  std::string time_why;                         // reason for these time columns, or for none
  std::string time_question;                    // that is open without times or a rate
  bool has_time = false;
  bool rate_is_known = false;
  bool rate_is_assumed = false;
  TimeStatistics time;  // without time columns: rate_hz as given or assumed
  RawUnit unit = RawUnit::kUnknown;
  bool unit_is_assumed = false;
  bool sign_is_assumed = false;
  std::string profile = {};  // that the columns are of, by name; empty: none
  std::vector<std::string> profiles_to_ask_for = {};  // that they may be of
  double unit_high = 0.0;                             // highest usual value of the sensors
  int bits = 0;                                       // for counts
  std::string unit_why;
  std::string question;                 // that stops the work until it is answered; empty: none
  Remedy remedy = Remedy::kInSentence;  // of the question
  bool asks_joints = false;             // the joints of the sensors answer the question
  std::optional<Senders> senders = std::nullopt;  // if two take turns
  std::optional<HandRows> hand = std::nullopt;    // whose rows alone were read
  std::vector<InspectedColumn> columns;
  std::vector<double> picture_time_s;               // of some rows
  std::vector<std::vector<double>> picture_values;  // per column; empty without numbers

  /// Columns that drive a joint.
  std::vector<std::size_t> MappedColumns() const;
  /// True if one of these has its joint by an assumption alone.
  bool HasAssumedJoint() const;
  /// Sensors of the hand, dead ones included.
  std::vector<std::size_t> Sensors() const;
  /// True if the sensors are angles.
  bool HasAngles() const;
  /// Degrees per unit of these angles.
  double DegPerUnit() const;
};

struct InspectionOptions {
  double rate_hz = 0.0;   // of a file without time, if known; 0: unknown
  std::string array;      // of a file with arrays, see ListArrays(), or a topic; empty: by size
  std::string map;        // column map that names time and joints; empty: none
  std::string time_unit;  // of the column that names the time: s, ms, us or ns; empty: found
  JointOptions joints = {};
  // First and last column of the sensors, from 1; empty: found.
  std::optional<std::pair<std::size_t, std::size_t>> columns = std::nullopt;
};

/// Lower end of the joint's range that a hand uses [deg]: few people bend a knuckle back by 45 deg.
double LowDegOf(const Channel& joint);

/// Errors: UserError in one line if the file has no readable table.
Inspection Inspect(const std::filesystem::path& file, const InspectionOptions& options);

}  // namespace gauntlet::sim
