#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "sim/tables/message_file.h"
#include "sim/tables/message_type.h"

namespace gauntlet::sim {

/// Turns the messages of a topic into rows of numbers: JSON, and CDR of ROS 2 (XCDR version 1).
/// Each number is a column, named by the fields on the way to it. Numbers of a list are numbered
/// from 1; where the message has a list of as many names (`name`, `names`, `joint_names`) beside
/// them, they have these names; so do positions, velocities and the like in its parts. Items of a
/// list in JSON that have a `name` each are called so. Times and durations are in seconds.
/// Positions of a JointState have the names of their joints; for their unit see UnitOfJoint(). Left
/// out are texts, layouts of arrays, and lists of more than 64 bytes, as images are. Source: OMG
/// Common Data Representation (formal/02-06-51, 15.3); docs.ros.org, sensor_msgs.
class MessageRows {
 public:
  /// Errors: UserError without a place if messages of the topic are not read.
  explicit MessageRows(const Topic& topic);
  ~MessageRows();

  /// Reads a message. Errors: UserError without a place if it is damaged, of another type, or has
  /// more than 1000 numbers.
  void Read(std::string_view message);
  /// Values of the last message by column; NaN for what it does not have.
  const std::vector<double>& row() const { return row_; }
  /// Time in its header, in ns; nothing without one, or for 0.
  std::optional<std::int64_t> stamp_ns() const { return stamp_ns_; }
  /// Columns of all messages so far.
  const std::vector<std::string>& columns() const { return columns_; }
  /// Columns with positions of a JointState.
  const std::vector<std::size_t>& positions() const { return positions_; }

 private:
  struct Node;
  class Cdr;
  class Json;
  /// A list of numbers, which are named at the end of the message.
  struct List {
    Node* node = nullptr;
    std::size_t begin = 0;
    std::size_t size = 0;
  };

  void SetNumber(Node& node, double value);
  void SetLists();
  int NewColumn(const std::string& path);

  MessageTypes types_;  // of CDR
  bool is_joint_state_ = false;
  std::unique_ptr<Node> root_;
  std::vector<std::string> columns_;
  std::map<std::string, int, std::less<>> column_counts_;  // by name
  std::vector<std::size_t> positions_;
  std::vector<double> row_;
  std::optional<std::int64_t> stamp_ns_;
  std::vector<List> lists_;
  std::vector<double> list_values_;
  std::vector<std::string> names_;
  const Node* names_parent_ = nullptr;  // what the list of names is in
  int name_lists_ = 0;
  std::string expanded_;  // of a compressed message
};

/// Why messages of this topic are not read, as a part of a sentence; empty if they are.
std::string ProblemOf(const Topic& topic);

}  // namespace gauntlet::sim
