#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <optional>
#include <string_view>
#include <utility>

#include "sim/base/error.h"
#include "sim/base/signal.h"
#include "sim/base/text.h"
#include "sim/fit/chain_columns.h"
#include "sim/recordings/time_guess.h"
#include "sim/tables/time_columns.h"

namespace gauntlet::sim {
namespace {

std::string InSmall(std::string text) {
  std::ranges::transform(text, text.begin(),
                         [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

bool HasAny(const std::string& text, const auto& words) {
  return std::ranges::any_of(
      words, [&](std::string_view word) { return text.find(word) != std::string::npos; });
}

bool IsState(const ListedTopic& topic) {
  const std::string name = InSmall(topic.name);
  return topic.has_signals && topic.type.ends_with("JointState") &&
         HasAny(name, std::array{"state", "measured", "feedback"}) &&
         !HasAny(name, std::array{"command", "cmd", "desired", "target", "goal"});
}

bool IsCommand(const ListedTopic& topic) {
  const std::string text = InSmall(topic.name + " " + topic.type);
  return topic.has_signals && !IsState(topic) &&
         HasAny(text, std::array{"command", "cmd", "desired", "target", "goal", "trajectory",
                                 "setpoint", "reference"}) &&
         !InSmall(topic.name).ends_with("state");
}

/// The only topic that `is` accepts; none without, or of several.
std::optional<std::string> OnlyOne(const std::vector<ListedTopic>& topics, const auto& is) {
  if (std::ranges::count_if(topics, is) != 1) return std::nullopt;
  return std::ranges::find_if(topics, is)->name;
}

/// A column with a position: its joint, and its unit if the name has one.
struct JointColumn {
  std::size_t column = 0;
  std::string joint;
  std::optional<double> scale = {};
};

/// True for `shoulder` and `points_1_positions_shoulder`.
bool EndsWithName(const std::string& name, const std::string& joint) {
  if (!name.ends_with(joint)) return false;
  return name.size() == joint.size() ||
         name.substr(0, name.size() - joint.size()).ends_with("positions_") ||
         name.substr(0, name.size() - joint.size()).ends_with("position_");
}

std::vector<JointColumn> PositionsOf(const FoundTable& table) {
  constexpr std::array kOther = {"veloc",   "effort", "accel",          "torque",
                                 "current", "stamp",  "time_from_start"};
  std::vector<JointColumn> columns;
  for (std::size_t i = 0; i < table.layout.names.size(); ++i) {
    const std::string& name = table.layout.names[i];
    if (TimeScaleS(name) || HasAny(InSmall(name), kOther)) continue;
    std::string joint = name.substr(name.find_last_of("./") + 1);
    std::optional<double> scale;
    for (const auto& [suffix, its_scale] :
         {std::pair("_rad", kDegPerRad), std::pair("_deg", 1.0)}) {
      if (!joint.ends_with(suffix)) continue;
      joint.resize(joint.size() - std::string_view(suffix).size());
      scale = its_scale;
    }
    columns.push_back({i, std::move(joint), scale});
  }
  return columns;
}

}  // namespace

TopicPair FindTopicPair(const std::string& file, const std::vector<ListedTopic>& topics,
                        const std::string& command, const std::string& state) {
  const auto found_state = state.empty() ? OnlyOne(topics, IsState) : std::optional(state);
  const auto found_command = command.empty() ? OnlyOne(topics, IsCommand) : std::optional(command);
  if (found_state && found_command && *found_state == *found_command) {
    throw UserError({.place = "--command " + *found_command,
                     .problem = "is the topic of the states, must be another"});
  }
  if (found_state && found_command) {
    return {*found_command, *found_state, !command.empty() && !state.empty()};
  }
  std::vector<std::string> names;
  for (const ListedTopic& one : topics) {
    if (one.has_signals) names.push_back(fmt::format("{} ({})", one.name, one.type));
  }
  if (names.empty()) throw UserError({.place = file, .problem = QuestionOf(topics)});
  throw UserError(
      {.place = file,
       .problem = fmt::format("has several topics: {}; --command TOPIC --state TOPIC takes two, "
                              "--topic TOPIC one",
                              OneLine(fmt::format("{}", fmt::join(names, ", ")), 600))});
}

ChainColumns PairTopics(const FoundTable& command, const FoundTable& state, const TopicPair& pair,
                        std::vector<std::string>& remarks) {
  ChainColumns columns;
  columns.time = TimeByName(state.reader.name(), state.layout);
  const std::vector<JointColumn> commands = PositionsOf(command);
  const std::vector<JointColumn> angles = PositionsOf(state);
  const auto add = [&](const JointColumn& from, const JointColumn& to) {
    const std::optional<double> scale = from.scale ? from.scale : to.scale;
    columns.commands.push_back({from.column, to.joint, scale});
    columns.angles.push_back({to.column, to.joint, to.scale ? to.scale : scale});
  };
  std::vector<bool> used(commands.size(), false);
  for (const JointColumn& angle : angles) {
    const JointColumn* found = nullptr;
    for (std::size_t i = 0; i < commands.size(); ++i) {
      if (!EndsWithName(commands[i].joint, angle.joint)) continue;
      if (found != nullptr) {
        command.reader.Fail(
            commands[i].column + 1,
            fmt::format("{} has several commands of {} in one message: {} and {}{}", pair.command,
                        command.reader.Quoted(angle.joint), command.layout.names[found->column],
                        command.layout.names[commands[i].column],
                        command.layout.names[found->column].starts_with("points_")
                            ? "; such a trajectory is a plan: record what the controller makes of "
                              "it, one position a message (of ros2_control: the reference in "
                              "controller_state), as JointState"
                            : ""));
      }
      found = &commands[i];
      used[i] = true;
    }
    if (found == nullptr) {
      columns.ignored.push_back(angle.joint);
    } else {
      add(*found, angle);
    }
  }
  const bool by_order =
      columns.commands.empty() && pair.is_given && commands.size() == angles.size();
  for (std::size_t i = 0; by_order && i < commands.size(); ++i) add(commands[i], angles[i]);
  if (by_order) {
    columns.ignored.clear();
    remarks.push_back(
        fmt::format("The commands of {} have no names: the order of the joints of {} is assumed.",
                    pair.command, pair.state));
  } else {
    for (std::size_t i = 0; i < commands.size(); ++i) {
      if (!used[i]) columns.ignored.push_back(command.layout.names[commands[i].column]);
    }
  }
  if (columns.commands.empty()) {
    std::vector<std::string> names;
    for (const JointColumn& one : commands) names.push_back(one.joint);
    state.reader.Fail(
        1, fmt::format("no joint of {} has a command in {} ({}){}", pair.state, pair.command,
                       OneLine(fmt::format("{}", fmt::join(names, ", ")), 200),
                       commands.size() == angles.size()
                           ? "; --command and --state together pair them by their order"
                           : ""));
  }
  return columns;
}

}  // namespace gauntlet::sim
