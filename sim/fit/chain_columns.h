#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "sim/recordings/column_map.h"
#include "sim/tables/message_table.h"
#include "sim/tables/table_layout.h"

namespace gauntlet::sim {

/// A column of a part's command, angle or motor angle: degrees = scale * value + offset_deg. No
/// scale: the name has no unit.
struct PartColumn {
  std::size_t column = 0;
  std::string part;
  std::optional<double> scale;
  double offset_deg = 0.0;
};

struct EpisodeColumn {
  std::size_t column = 0;
  bool is_text = false;
};

/// The columns of a log of commands and angles.
struct ChainColumns {
  std::vector<TimeMapping> time;  // summed; empty: by the rate
  /// That tell episodes apart: `episode` or `episode_index` alone, else all of sessions and trials.
  std::vector<EpisodeColumn> episodes;
  std::vector<PartColumn> commands;
  std::vector<PartColumn> angles;    // in the order of `commands`
  std::vector<PartColumn> motors;    // of parts with a motor angle, by name
  std::vector<std::string> ignored;  // names of columns that are none of these
  bool names_angles = false;         // a name without a unit contains the word angle
  bool is_trace = false;             // the CSV of a trace
};

/// Finds the columns of each part: `NAME_command_deg` (or `_rad`) and `NAME_deg`, or the same with
/// other usual words: command, cmd, target, goal, desired, setpoint or action, and actual,
/// measured, feedback, present, observation, state or nothing, with or without position, pos or
/// angle: `goal_position` and `present_position`, `action.X.pos` and `observation.state.X.pos`.
/// A log of a single part needs no name for it; it is called `joint`. Columns of other quantities
/// (speed, current, torque, ..) are ignored.
/// A column map (see ReadLogMap), if one is given, is used in place of the names.
/// Errors: UserError for a command without an angle, two columns for the same, or no time.
/// `rate_hz` above 0: rows are even, and no column is the time.
ChainColumns FindChainColumns(const FoundTable& table, const std::string& map = {},
                              double rate_hz = 0.0, const std::string& time_unit = {});

/// Two topics of a file of messages, as ROS records them: commands and states.
struct TopicPair {
  std::string command;
  std::string state;
  bool is_given = false;  // by a person
};

/// The topics to pair: those that a person gave, else the only JointState named state(s) and the
/// only other one whose name or type is that of a command.
/// Errors: UserError in `file` that lists the topics if there is no such pair.
TopicPair FindTopicPair(const std::string& file, const std::vector<ListedTopic>& topics,
                        const std::string& command, const std::string& state);

/// The columns of both tables: `commands` are those of `command`, `angles` and `time` those of
/// `state`. Joints are paired by the last part of their names, `points_1.positions.thumb` with
/// `thumb`; numbered commands (`data_1`) of a given topic by their order, if there are as many.
/// `remarks` receives a sentence on what is assumed.
/// Errors: UserError if no joint has both, or if two columns are the command of one joint.
ChainColumns PairTopics(const FoundTable& command, const FoundTable& state, const TopicPair& pair,
                        std::vector<std::string>& remarks);

}  // namespace gauntlet::sim
