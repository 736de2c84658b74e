#pragma once

#include <cstdint>
#include <filesystem>
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

/// Opens an MCAP file. Chunks are uncompressed, lz4 or zstd. The index of the file is used if it
/// is complete: then only chunks with the topic's messages are read. Checksums are checked.
/// Source: mcap.dev/spec. Errors: UserError without a place for a damaged file, for a chunk above
/// 256 MB and for another compression.
std::unique_ptr<MessageFile> OpenMcap(const std::filesystem::path& file);
/// As OpenMcap(), for the bytes of a file.
std::unique_ptr<MessageFile> ReadMcap(std::string bytes);

/// Opens a bag of ROS 2 in a SQLite file (.db3). It is only read, and no file is written beside
/// it. Source: ros2/rosbag2, rosbag2_storage_sqlite3.
/// Errors: UserError without a place for a damaged file, a database of another kind, and for a
/// file with messages in a log beside it (-wal), as of a recorder that was killed.
std::unique_ptr<MessageFile> OpenRosbag(const std::filesystem::path& file);

/// True for the beginning of what `rostopic echo` and `ros2 topic echo` print: messages in YAML,
/// each before a line `---`.
bool IsEcho(std::string_view head);

/// Opens a text of `rostopic echo` or `ros2 topic echo` as a file with one topic, which has no
/// times but those in the headers of its messages. A last message without a line `---` behind it
/// is not read.
/// Errors: UserError without a place for a message that is no YAML or has shortened lists.
std::unique_ptr<MessageFile> OpenEcho(const std::filesystem::path& file);

}  // namespace gauntlet::sim
