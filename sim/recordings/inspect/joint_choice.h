#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "sim/recordings/column_map.h"
#include "sim/recordings/inspect/joint_names.h"
#include "sim/recordings/profile.h"
#include "sim/recordings/quantities.h"

namespace gauntlet::sim {

/// Facts that a person gives about the joints of a file.
struct JointOptions {
  std::string preset;  // profile of the glove, by name; empty: by names, or by its facts
  std::string hand;    // left or right, of a file with both; empty: none given
  std::string unit;    // of the sensors: deg, rad, counts, share, percent, volts; empty: found
};

/// Facts about the columns of a table.
struct JointEvidence {
  std::span<const ColumnEvidence> columns;
  std::span<const ColumnFamily> families;  // of these columns
  std::string angle_unit;                  // by the header: deg, rad, or angle; empty: none
  std::string format;                      // as in ProfileFacts
  double duration_s = 0.0;                 // of the rows
  bool is_translated = false;              // names of fingers are in another language
};

/// The columns that drive the joints of one hand.
struct JointChoice {
  std::vector<std::size_t> columns;                       // in the order of the sensors
  std::vector<ColumnJoint> joints;                        // of these columns
  std::vector<std::vector<ColumnMapping>> mappings = {};  // of these columns; empty: by the unit
  RawUnit unit = RawUnit::kUnknown;
  bool unit_is_assumed = false;
  std::string unit_why;
  double high = 0.0;                                  // of the columns, without their rarest values
  std::string profile = {};                           // that the columns are of, by name
  std::vector<std::string> profiles_to_ask_for = {};  // that they may be of
  std::string question;         // that must be answered before a column drives a joint; empty: none
  bool asks_joints = false;     // the joints of `columns` answer the question
  bool is_command_log = false;  // commands and measured angles of a hand, not of a glove
};

/// Facts, then profiles, then a question. The joints are, by the first of these that holds:
/// 1. those of a map, or of the profile that a person names;
/// 2. those of a profile that is known by names of columns and another fact;
/// 3. all columns whose names are a joint's (see ReadJointName); with one more word in all of them
///    they are assumed to be;
/// 4. those of a profile that is known by number, values and format of its columns, if one family
///    of columns can be the sensors: assumed.
/// Errors: UserError for an unknown preset, or columns that do not fit the preset or the map.
JointChoice ChooseJoints(const JointEvidence& evidence, const JointOptions& options,
                         const std::optional<ColumnMap>& map, const std::vector<Profile>& profiles);

/// The facts that profiles look at.
ProfileFacts FactsOf(const JointEvidence& evidence);

}  // namespace gauntlet::sim
