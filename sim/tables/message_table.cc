#include "sim/tables/message_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <span>

#include "sim/base/error.h"
#include "sim/base/nearest_name.h"
#include "sim/base/text.h"
#include "sim/tables/joint_unit.h"
#include "sim/tables/message_rows.h"
#include "sim/tables/message_type.h"
#include "sim/tables/missing.h"

namespace gauntlet::sim {
namespace {

constexpr double kNsPerS = 1e9;

/// True for messages that robots record about themselves, beside what is recorded on purpose.
bool IsBookkeeping(std::string_view type) {
  const std::string plain = PlainTypeName(type);
  return plain.starts_with("rcl_interfaces/") || plain.starts_with("diagnostic_msgs/") ||
         plain == "rosgraph_msgs/Clock" || plain == "tf2_msgs/TFMessage" || plain == "foxglove.Log";
}

/// True for a topic that may be the one to take.
bool HasSignals(const Topic& topic) {
  if (topic.messages < 2 || IsBookkeeping(topic.type) || !ProblemOf(topic).empty()) return false;
  if (topic.encoding != "cdr") return true;
  return HasSignals(
      ReadRos2Msg(topic.type, topic.schema_encoding == "ros2msg" ? topic.schema : std::string()));
}

ListedTopic Listed(const Topic& topic) {
  ListedTopic listed = {.name = topic.name, .type = topic.type, .messages = topic.messages};
  listed.problem = ProblemOf(topic);
  listed.has_signals = HasSignals(topic);
  const double duration_s =
      (static_cast<double>(topic.last_ns) - static_cast<double>(topic.first_ns)) / kNsPerS;
  if (topic.messages > 1 && duration_s > 0.0) {
    listed.rate_hz = static_cast<double>(topic.messages - 1) / duration_s;
  }
  return listed;
}

std::vector<ListedTopic> ListAll(const MessageFile& file) {
  std::vector<ListedTopic> listed;
  for (const Topic& topic : file.topics()) listed.push_back(Listed(topic));
  return listed;
}

/// The names of topics, of many the first ones.
std::string NamesIn(const std::vector<std::string>& names) {
  constexpr std::size_t kMost = 12;
  std::string text;
  for (std::size_t i = 0; i < std::min(names.size(), kMost); ++i) {
    text += (i == 0 ? "" : ", ") + OneLine(names[i], 120);
  }
  return names.size() > kMost ? text + fmt::format(" and {} more", names.size() - kMost) : text;
}

/// The topic of this name, or the only one with signals. Nothing if there are none or several.
std::optional<std::size_t> FindTopic(const std::vector<Topic>& topics, std::string_view chosen) {
  if (chosen.empty()) {
    const auto is_usable = [](const Topic& topic) { return HasSignals(topic); };
    const auto found = std::ranges::find_if(topics, is_usable);
    if (std::ranges::count_if(topics, is_usable) != 1) return std::nullopt;
    return static_cast<std::size_t>(found - topics.begin());
  }
  const auto is_chosen = [&](const Topic& topic) {
    return topic.name == chosen ||
           (topic.name.starts_with('/') && std::string_view(topic.name).substr(1) == chosen);
  };
  const auto found = std::ranges::find_if(topics, is_chosen);
  if (found == topics.end()) {
    std::vector<std::string> names;
    for (const Topic& topic : topics) names.push_back(topic.name);
    throw UserError(fmt::format("has no topic {}{}", Shown(chosen), Suggestion(chosen, names)));
  }
  if (const std::string problem = ProblemOf(*found); !problem.empty()) {
    throw UserError(fmt::format("topic {} is not read: {}", OneLine(found->name, 60), problem));
  }
  return static_cast<std::size_t>(found - topics.begin());
}

/// Facts that all messages of a topic have in common.
struct TopicFacts {
  std::vector<std::string> columns;
  std::vector<std::string> remarks;  // on units
  bool has_stamps = true;
  bool is_sorted = true;  // by the time to be used
};

/// Calls `visit(time of the header or of the recorder, row)` for each message.
template <class Visit>
void ForEachRow(MessageFile& file, std::size_t topic, MessageRows& rows, const Visit& visit) {
  std::uint64_t number = 0;
  file.ForEachMessage(topic, [&](std::int64_t log_ns, std::string_view data) {
    ++number;
    try {
      rows.Read(data);
    } catch (const UserError& error) {
      throw UserError(fmt::format("message {} of {}: {}", number,
                                  OneLine(file.topics()[topic].name, 60), error.what()));
    }
    visit(log_ns, rows.stamp_ns());
  });
}

/// Types of the joints in the first robot_description of the file; empty without one.
JointTypes JointTypesOf(MessageFile& file) {
  std::string text;
  for (std::size_t i = 0; i < file.topics().size(); ++i) {
    const Topic& topic = file.topics()[i];
    if (!topic.name.ends_with("robot_description") || topic.encoding != "cdr" ||
        PlainTypeName(topic.type) != "std_msgs/String") {
      continue;
    }
    file.ForEachMessage(i, [&text](std::int64_t, std::string_view data) {
      if (text.empty()) text = data;
    });
  }
  return JointTypesIn(text);
}

/// Names positions of joints with their units.
void NameUnits(MessageFile& file, const MessageRows& rows, const std::vector<double>& largest,
               TopicFacts& facts) {
  if (rows.positions().empty()) return;
  const JointTypes types = JointTypesOf(file);
  for (const std::size_t column : rows.positions()) {
    JointUnit unit = UnitOfJoint(facts.columns[column], largest[column], types);
    facts.columns[column] += unit.suffix;
    if (!unit.why.empty()) facts.remarks.push_back(std::move(unit.why));
  }
}

TopicFacts FactsOf(MessageFile& file, std::size_t topic, MessageRows& rows) {
  TopicFacts facts;
  std::vector<double> largest;  // magnitude per column
  bool is_sorted_by_stamp = true;
  std::optional<std::int64_t> log_before, stamp_before;
  ForEachRow(file, topic, rows, [&](std::int64_t log_ns, std::optional<std::int64_t> stamp_ns) {
    largest.resize(rows.row().size());
    for (const std::size_t column : rows.positions()) {
      largest[column] = std::fmax(largest[column], std::abs(rows.row()[column]));
    }
    facts.has_stamps = facts.has_stamps && stamp_ns.has_value();
    if (log_before && log_ns < *log_before) facts.is_sorted = false;
    if (stamp_before && stamp_ns && *stamp_ns < *stamp_before) is_sorted_by_stamp = false;
    log_before = log_ns;
    stamp_before = stamp_ns;
  });
  if (facts.has_stamps) facts.is_sorted = is_sorted_by_stamp;
  if (!facts.has_stamps && !file.has_log_times()) {
    throw UserError(
        "has messages without a time in a header; rostopic echo -p and ros2 bag record keep times");
  }
  facts.columns = rows.columns();
  if (facts.columns.empty()) {
    throw UserError(fmt::format("topic {} has no numbers", OneLine(file.topics()[topic].name, 60)));
  }
  NameUnits(file, rows, largest, facts);
  return facts;
}

double SecondsOf(std::int64_t ns) {
  return static_cast<double>(static_cast<long double>(ns) / kNsPerS);
}

}  // namespace

std::vector<ListedTopic> ListTopics(MessageFile& file, std::string_view chosen) {
  const std::optional<std::size_t> taken = FindTopic(file.topics(), chosen);
  std::vector<ListedTopic> listed = ListAll(file);
  if (!taken) return listed;
  MessageRows rows(file.topics()[*taken]);
  listed[*taken].is_taken = true;
  listed[*taken].has_stamps = FactsOf(file, *taken, rows).has_stamps;
  listed[*taken].is_cut = file.is_cut();
  return listed;
}

std::string QuestionOf(const std::vector<ListedTopic>& topics) {
  std::vector<std::string> usable, all;
  for (const ListedTopic& topic : topics) {
    all.push_back(topic.problem.empty() ? topic.name
                                        : fmt::format("{} ({})", topic.name, topic.problem));
    if (topic.has_signals) usable.push_back(topic.name);
  }
  if (all.empty()) return "has no topic";
  if (usable.empty()) return "has no topic with signals that is read, but " + NamesIn(all);
  return fmt::format("has several topics: {}; --topic NAME takes one", NamesIn(usable));
}

void WriteTopicTable(MessageFile& file, std::string_view chosen, PipeWriter& pipe) {
  const std::optional<std::size_t> found = FindTopic(file.topics(), chosen);
  if (!found) throw UserError(QuestionOf(ListAll(file)));
  const std::size_t topic = *found;
  MessageRows rows(file.topics()[topic]);
  const TopicFacts facts = FactsOf(file, topic, rows);
  std::vector<std::string> names = facts.columns;
  names.insert(names.begin(), "time_s");
  TableWriter table(pipe, names, facts.remarks, file.topics()[topic].messages);
  std::vector<double> row;
  const auto write = [&](std::int64_t ns, std::span<const double> values_of_row) {
    row.assign(1, SecondsOf(ns));
    row.insert(row.end(), values_of_row.begin(), values_of_row.end());
    table.Rows(row);
  };
  std::vector<std::int64_t> times_ns;  // of rows that have to be sorted
  std::vector<double> values;
  ForEachRow(file, topic, rows, [&](std::int64_t log_ns, std::optional<std::int64_t> stamp_ns) {
    if (rows.columns().size() != facts.columns.size()) throw UserError("changes while it is read");
    const std::int64_t ns = facts.has_stamps ? stamp_ns.value_or(0) : log_ns;
    if (facts.is_sorted) {
      write(ns, rows.row());
    } else {
      times_ns.push_back(ns);
      values.insert(values.end(), rows.row().begin(), rows.row().end());
    }
  });
  std::vector<std::size_t> order(times_ns.size());
  std::iota(order.begin(), order.end(), 0);
  std::ranges::stable_sort(order, {}, [&](std::size_t i) { return times_ns[i]; });
  const std::size_t columns = facts.columns.size();
  for (const std::size_t i : order) {
    write(times_ns[i], std::span(values).subspan(i * columns, columns));
  }
  table.Finish(file.is_cut());
}

}  // namespace gauntlet::sim
