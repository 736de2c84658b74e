#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace gauntlet::sim {

/// A named stream of messages of one type.
struct Topic {
  std::string name;
  std::string type;             // of its messages, as sensor_msgs/msg/JointState; may be empty
  std::string encoding;         // of its messages, as cdr or json
  std::string schema_encoding;  // as ros2msg or jsonschema; empty: without a schema
  std::string schema;
  std::uint64_t messages = 0;
  std::int64_t first_ns = 0;  // the recorder's time of the first and the last message
  std::int64_t last_ns = 0;
  std::string problem = {};  // that prevents reading; empty: none is known
};

/// A file of messages in topics, as robots and their tools record them: MCAP, a bag of ROS 2.
/// Memory does not grow with the file.
class MessageFile {
 public:
  using Visit = std::function<void(std::int64_t log_ns, std::string_view data)>;

  MessageFile() = default;
  virtual ~MessageFile() = default;
  MessageFile(const MessageFile&) = delete;
  MessageFile& operator=(const MessageFile&) = delete;

  const std::vector<Topic>& topics() const { return topics_; }
  /// True if the file ends before its end, as of a recorder that was killed. What is whole is read.
  bool is_cut() const { return is_cut_; }
  /// False if only the messages themselves may have times.
  bool has_log_times() const { return has_log_times_; }
  /// All messages of a topic, in the order of the file. Errors: UserError without a place.
  virtual void ForEachMessage(std::size_t topic, const Visit& visit) = 0;

 protected:
  std::vector<Topic> topics_;
  bool is_cut_ = false;
  bool has_log_times_ = true;
};

/// Several files, one after the other, as one. Errors: UserError without a place for a topic whose
/// type differs between them.
std::unique_ptr<MessageFile> JoinMessageFiles(std::vector<std::unique_ptr<MessageFile>> parts);

}  // namespace gauntlet::sim
