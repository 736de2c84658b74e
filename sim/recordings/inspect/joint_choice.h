#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "sim/recordings/column_map.h"
#include "sim/recordings/inspect/joint_names.h"
#include "sim/recordings/quantities.h"

namespace gauntlet::sim {

/// Facts that a person gives about the joints of a file.
struct JointOptions {
  std::string preset;  // glove with these sensors in its order; empty: by names
  std::string hand;    // left or right, of a file with both; empty: none given
};

/// The family of columns that drives the joints of one hand.
struct JointChoice {
  std::vector<std::size_t> columns;  // in the order of the sensors
  std::vector<ColumnJoint> joints;   // of these columns
  RawUnit unit = RawUnit::kUnknown;
  bool unit_is_assumed = false;
  std::string unit_why;
  double high = 0.0;            // of the family, without its rarest values
  std::string question;         // that must be answered before a column drives a joint; empty: none
  bool is_command_log = false;  // commands and measured angles of a hand, not of a glove
};

/// Chooses the best family of sensors: with names of joints before without, then angles before
/// shares before counts and volts, then moving before still. Joints are by name, by preset, by map,
/// or by the number of the sensors, which is an assumption.
/// Errors: UserError for an unknown preset, or columns that do not fit the preset or the map.
JointChoice ChooseJoints(const std::vector<ColumnFamily>& families,
                         const std::vector<std::string>& names, const JointOptions& options,
                         const std::optional<ColumnMap>& map);

}  // namespace gauntlet::sim
