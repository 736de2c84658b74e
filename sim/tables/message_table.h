#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "sim/tables/message_file.h"
#include "sim/tables/table_pipe.h"

namespace gauntlet::sim {

/// A topic of a file of messages, for a person who has to choose one.
struct ListedTopic {
  std::string name;
  std::string type;
  std::uint64_t messages = 0;
  double rate_hz = 0.0;      // by the recorder's times; 0: not known
  std::string problem = {};  // that prevents reading; empty: none
  bool has_signals = false;  // it is read, and not a log, a clock or the like
  bool is_taken = false;
  bool has_stamps = false;  // of the topic that is taken: the times are those of its headers
  bool is_cut = false;      // the file ends before its end
};

/// All topics. `chosen` is the name of the one to take, with or without its first `/`. Without it,
/// that is the only one with signals, if there is exactly one: logs, clocks, parameters,
/// diagnostics and transforms of ROS do not count.
/// Errors: UserError without a place: there is no such topic; the topic is not read; as of
/// MessageFile and MessageRows.
std::vector<ListedTopic> ListTopics(MessageFile& file, std::string_view chosen);

/// The sentence that asks for a topic if ListTopics() takes none.
std::string QuestionOf(const std::vector<ListedTopic>& topics);

/// The table of the topic that ListTopics() takes: `time_s`, then the columns of MessageRows. The
/// time is the one in the headers if every message has one, else the recorder's. The reader of the
/// pipe sorts the rows by it, so none is held here. The table of a file that is cut is cut, too.
/// Errors: as ListTopics(); UserError without a place if it takes none.
void WriteTopicTable(MessageFile& file, std::string_view chosen, PipeWriter& pipe);

}  // namespace gauntlet::sim
