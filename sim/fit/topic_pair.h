#pragma once

#include <string>
#include <vector>

#include "sim/fit/chain_columns.h"
#include "sim/tables/message_table.h"
#include "sim/tables/table_layout.h"

namespace gauntlet::sim {

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
