#include "sim/tables/message_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>
#include <optional>
#include <span>
#include <utility>

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

/// Problems and signals of the types of topics, found once for each type: a file may have tens of
/// thousands of topics.
class TopicTypes {
 public:
  struct Facts {
    std::string problem;
    bool has_signals = false;
  };

  const Facts& Of(const Topic& topic) {
    const auto [known, is_new] = facts_.try_emplace(
        {topic.encoding, topic.type, topic.schema_encoding, topic.schema, topic.problem});
    if (is_new) known->second = {.problem = ProblemOf(topic), .has_signals = HasSignals(topic)};
    return known->second;
  }

 private:
  static bool HasSignals(const Topic& topic) {
    if (IsBookkeeping(topic.type) || !ProblemOf(topic).empty()) return false;
    if (topic.encoding != "cdr") return true;
    return sim::HasSignals(
        ReadRos2Msg(topic.type, topic.schema_encoding == "ros2msg" ? topic.schema : std::string()));
  }

  std::map<std::array<std::string_view, 5>, Facts> facts_;  // by all that decides them
};

std::vector<ListedTopic> ListAll(const MessageFile& file) {
  std::vector<ListedTopic> listed;
  TopicTypes types;
  for (const Topic& topic : file.topics()) {
    const TopicTypes::Facts& facts = types.Of(topic);
    listed.push_back({.name = topic.name,
                      .type = topic.type,
                      .messages = topic.messages,
                      .problem = facts.problem,
                      .has_signals = facts.has_signals && topic.messages >= 2});
    const double duration_s =
        (static_cast<double>(topic.last_ns) - static_cast<double>(topic.first_ns)) / kNsPerS;
    if (topic.messages > 1 && duration_s > 0.0) {
      listed.back().rate_hz = static_cast<double>(topic.messages - 1) / duration_s;
    }
  }
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
std::optional<std::size_t> FindTopic(const std::vector<ListedTopic>& topics,
                                     std::string_view chosen) {
  if (chosen.empty()) {
    const auto found = std::ranges::find_if(topics, &ListedTopic::has_signals);
    if (std::ranges::count_if(topics, &ListedTopic::has_signals) != 1) return std::nullopt;
    return static_cast<std::size_t>(found - topics.begin());
  }
  const auto is_chosen = [&](const ListedTopic& topic) {
    return topic.name == chosen ||
           (topic.name.starts_with('/') && std::string_view(topic.name).substr(1) == chosen);
  };
  const auto found = std::ranges::find_if(topics, is_chosen);
  if (found == topics.end()) {
    std::vector<std::string> names;
    for (const ListedTopic& topic : topics) names.push_back(topic.name);
    throw UserError(fmt::format("has no topic {}{}", Shown(chosen), Suggestion(chosen, names)));
  }
  if (!found->problem.empty()) {
    throw UserError(
        fmt::format("topic {} is not read: {}", OneLine(found->name, 60), found->problem));
  }
  return static_cast<std::size_t>(found - topics.begin());
}

/// Facts that all messages of a topic have in common.
struct TopicFacts {
  std::vector<std::string> columns;
  std::vector<std::string> remarks;  // on units
  bool has_stamps = true;
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
  ForEachRow(file, topic, rows, [&](std::int64_t, std::optional<std::int64_t> stamp_ns) {
    largest.resize(rows.row().size());
    for (const std::size_t column : rows.positions()) {
      largest[column] = std::fmax(largest[column], std::abs(rows.row()[column]));
    }
    facts.has_stamps = facts.has_stamps && stamp_ns.has_value();
  });
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

/// Places of the rows in the order of their times; empty if they are in it.
std::vector<double> OrderOf(const std::vector<std::int64_t>& times_ns) {
  std::vector<double> order;
  if (std::ranges::is_sorted(times_ns)) return order;
  order.resize(times_ns.size());
  std::iota(order.begin(), order.end(), 0.0);
  std::ranges::stable_sort(order, {},
                           [&](double place) { return times_ns[static_cast<std::size_t>(place)]; });
  return order;
}

double SecondsOf(std::int64_t ns) {
  return static_cast<double>(static_cast<long double>(ns) / kNsPerS);
}

}  // namespace

std::vector<ListedTopic> ListTopics(MessageFile& file, std::string_view chosen) {
  std::vector<ListedTopic> listed = ListAll(file);
  const std::optional<std::size_t> taken = FindTopic(listed, chosen);
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
  const std::vector<ListedTopic> listed = ListAll(file);
  const std::optional<std::size_t> found = FindTopic(listed, chosen);
  if (!found) throw UserError(QuestionOf(listed));
  const std::size_t topic = *found;
  MessageRows rows(file.topics()[topic]);
  const TopicFacts facts = FactsOf(file, topic, rows);
  std::vector<std::string> names = facts.columns;
  names.insert(names.begin(), "time_s");
  TableWriter table(pipe, names, facts.remarks, file.topics()[topic].messages);
  std::vector<double> row;
  std::vector<std::int64_t> times_ns;
  ForEachRow(file, topic, rows, [&](std::int64_t log_ns, std::optional<std::int64_t> stamp_ns) {
    if (rows.columns().size() != facts.columns.size()) throw UserError("changes while it is read");
    times_ns.push_back(facts.has_stamps ? stamp_ns.value_or(0) : log_ns);
    row.assign(1, SecondsOf(times_ns.back()));
    row.insert(row.end(), rows.row().begin(), rows.row().end());
    table.Rows(row);
  });
  table.Finish(file.is_cut(), OrderOf(times_ns));
}

}  // namespace gauntlet::sim
