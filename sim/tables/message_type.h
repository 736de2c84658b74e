#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace gauntlet::sim {

/// Kinds of fields in messages of ROS 2. kTime and kDuration are those of builtin_interfaces: whole
/// seconds and nanoseconds.
enum class FieldKind : std::uint8_t {
  kBool,
  kInt8,
  kUint8,  // byte and char, too
  kInt16,
  kUint16,
  kInt32,
  kUint32,
  kInt64,
  kUint64,
  kFloat32,
  kFloat64,
  kText,
  kTime,
  kDuration,
  kMessage,
};

enum class FieldShape : std::uint8_t { kOne, kArray, kSequence };

struct MessageField {
  std::string name;
  FieldKind kind = FieldKind::kFloat64;
  FieldShape shape = FieldShape::kOne;
  std::size_t length = 1;   // of an array
  std::size_t message = 0;  // place of its type, for kMessage
};

/// The member of messages that have none.
inline constexpr std::string_view kNoMember = "structure_needs_at_least_one_member";

struct MessageType {
  std::string name;  // as sensor_msgs/JointState
  std::vector<MessageField> fields;
};

/// Types of a message and of the messages in it; the first is that of the message itself.
using MessageTypes = std::vector<MessageType>;

/// Reads the text of a .msg file, with those of its parts behind it, each after a line of `=` and a
/// line `MSG: package/Type`. Parts that the text does not have are those of KnownMessage().
/// Source: docs.ros.org, Interfaces; mcap.dev/spec/registry, ros2msg.
/// Errors: UserError without a place for an unknown type, a wide string, and a type in itself.
MessageTypes ReadRos2Msg(std::string_view type, std::string_view text);

/// The text of a .msg file of std_msgs, geometry_msgs, sensor_msgs or trajectory_msgs, for bags
/// that contain only the names of types; empty for others. Sources: ros2/common_interfaces,
/// ros2/rcl_interfaces.
std::string_view KnownMessage(std::string_view type);

/// True if messages contain floating-point numbers or lists of numbers beside their header.
bool HasSignals(const MessageTypes& types);

/// `package/msg/Type` as `package/Type`.
std::string PlainTypeName(std::string_view type);

}  // namespace gauntlet::sim
