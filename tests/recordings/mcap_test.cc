// MCAP and bags of ROS 2: files of another implementation (mcap/write.mjs), bags made by SQLite,
// and our own writer.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sqlite3.h>
#include <zstd.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <memory>
#include <numeric>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "controller/number.h"
#include "sim/base/csv_line.h"
#include "sim/base/error.h"
#include "sim/recordings/table_source.h"
#include "sim/tables/checksum.h"
#include "sim/tables/file_format.h"
#include "sim/tables/mcap_writer.h"
#include "sim/tables/message_file.h"
#include "sim/tables/message_rows.h"
#include "sim/tables/message_table.h"
#include "sim/tables/text_lines.h"
#include "tests/support/program.h"
#include "tests/support/source_dir.h"
#include "tests/support/table_text.h"

namespace gauntlet::sim {
namespace {

namespace fs = std::filesystem;
using namespace std::string_literals;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::StartsWith;

fs::path ShippedMcap(const std::string& name) {
  return fs::path(SourceDir()) / "tests" / "recordings" / "mcap" / name;
}

std::string BytesOfMcap(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  EXPECT_TRUE(file) << path;
  return {std::istreambuf_iterator<char>(file), {}};
}

/// Columns of a table by name; NaN for what is missing.
using Columns = std::map<std::string, std::vector<double>>;

Columns ColumnsOf(const std::string& text) {
  const std::vector<std::string_view> lines = SplitLines(text);
  std::vector<std::string_view> names = SplitCells(lines.at(0), ',');
  Columns columns;
  for (std::size_t i = 1; i < lines.size(); ++i) {
    if (lines[i].starts_with('#')) continue;
    const std::vector<std::string_view> cells = SplitCells(lines[i], ',');
    for (std::size_t c = 0; c < cells.size(); ++c) {
      columns[std::string(names.at(c))].push_back(
          controller::ParseNumberOfProgram(cells[c]).value_or(1e99));
    }
  }
  return columns;
}

Columns TableOfTopic(const fs::path& file, const std::string& topic) {
  return ColumnsOf(test::TextOf(TableSource(file, topic)));
}

std::string ErrorOfTopic(const fs::path& file, const std::string& topic = {}) {
  try {
    test::TextOf(TableSource(file, topic));
  } catch (const UserError& error) {
    return error.what();
  }
  return "";
}

// The values of write.mjs.
void ExpectJointStates(const Columns& columns, int messages) {
  ASSERT_EQ(columns.size(), 7U);
  for (int k = 0; k < messages; ++k) {
    const auto row = static_cast<std::size_t>(k);
    EXPECT_EQ(columns.at("time_s").at(row), 1.7e9 + k / 100.0) << k;
    EXPECT_EQ(columns.at("index_mcp_rad").at(row), 0.01 * k) << k;
    EXPECT_EQ(columns.at("middle_mcp_rad").at(row), 0.5) << k;
    const double ring = columns.at("ring_mcp_rad").at(row);
    EXPECT_TRUE(k == 7 ? std::isnan(ring) : ring == 1.0 - 0.01 * k) << k;
    for (const char* joint : {"velocity_index_mcp", "velocity_ring_mcp"}) {
      const double velocity = columns.at(joint).at(row);
      const bool is_missing = k % 2 == 0 || (k == 7 && joint == "velocity_ring_mcp"s);
      EXPECT_TRUE(is_missing ? std::isnan(velocity) : velocity == -k) << joint << " " << k;
    }
  }
  EXPECT_EQ(columns.at("time_s").size(), static_cast<std::size_t>(messages));
}

TEST(Mcap, OfAnotherImplementationIsReadInEveryForm) {
  for (const char* name : {"zstd.mcap", "lz4.mcap", "plain.mcap", "no_index.mcap"}) {
    SCOPED_TRACE(name);
    const fs::path file = ShippedMcap(name);
    ExpectJointStates(TableOfTopic(file, "/joint_states"), 60);
    const Columns commands = TableOfTopic(file, "commands");
    EXPECT_EQ(commands.size(), 8U);  // without the layout, the constant and the text
    const Columns fingers = TableOfTopic(file, "/fingers");
    for (int k = 0; k < 60; ++k) {
      const auto row = static_cast<std::size_t>(k);
      // These have no time of their own: the recorder's is 4 and 5 ms behind.
      EXPECT_NEAR(commands.at("time_s").at(row), 1.7e9 + k / 100.0 + 0.004, 3e-7);
      EXPECT_EQ(commands.at("data_1").at(row), k);
      EXPECT_EQ(commands.at("data_2").at(row), -k / 2.0);
      EXPECT_EQ(commands.at("mode").at(row), k % 200);
      EXPECT_EQ(commands.at("gains_2").at(row), k);
      EXPECT_EQ(commands.at("is_on").at(row), k % 2 == 0 ? 1 : 0);
      EXPECT_NEAR(fingers.at("time_s").at(row), 1.7e9 + k / 100.0 + 0.005, 3e-7);
      EXPECT_EQ(fingers.at("position_thumb").at(row), k);
      EXPECT_EQ(fingers.at("position_index").at(row), k / 4.0);
      EXPECT_EQ(fingers.at("is_good").at(row), k == 4 ? 0 : 1);
      const double x = fingers.at("palm_x").at(row);
      EXPECT_TRUE(k == 5 ? std::isnan(x) : x == 2 * k);
      EXPECT_EQ(fingers.at("palm_q_2").at(row), 1);
    }
  }
}

TEST(Mcap, HasTopicsToChooseFrom) {
  for (const char* name : {"zstd.mcap", "no_index.mcap"}) {
    const fs::path file = ShippedMcap(name);
    const std::vector<ListedTopic> topics = OpenTable(file, "/joint_states").topics;
    ASSERT_EQ(topics.size(), 4U);
    EXPECT_EQ(topics[0].name, "/joint_states");
    EXPECT_EQ(topics[0].type, "sensor_msgs/msg/JointState");
    EXPECT_EQ(topics[0].messages, 60U);
    EXPECT_NEAR(topics[0].rate_hz, 100.0, 0.01);
    EXPECT_TRUE(topics[0].is_taken && topics[0].has_stamps && !topics[0].is_cut);
    EXPECT_FALSE(topics[1].is_taken);
    EXPECT_FALSE(OpenTable(file, "/commands").topics[1].has_stamps);
    EXPECT_EQ(topics[3].messages, 6U);
    EXPECT_THAT(topics[3].problem,
                HasSubstr("encoded as protobuf, not as cdr or json; write them as json"));
    EXPECT_THAT(ErrorOfTopic(file),
                HasSubstr("has several topics: /joint_states, /commands, /fingers; --topic NAME "
                          "takes one"));
    EXPECT_THAT(ErrorOfTopic(file, "/joint_state"), HasSubstr("did you mean /joint_states?"));
    EXPECT_THAT(ErrorOfTopic(file, "/camera"),
                HasSubstr("topic /camera is not read: its messages are encoded as protobuf, not as "
                          "cdr or json; write them as json"));
  }
}

class BagTest : public testing::Test {
 protected:
  fs::path Write(const std::string& name, const std::string& bytes) {
    std::ofstream(folder_.path() / name, std::ios::binary) << bytes;
    return folder_.path() / name;
  }
  test::TemporaryDirectory folder_;
};

// A recorder that was killed leaves a file without its end.
TEST_F(BagTest, ThatIsCutHasItsWholeMessages) {
  const std::string whole = BytesOfMcap(ShippedMcap("plain.mcap"));
  const fs::path half = Write("half.mcap", whole.substr(0, whole.size() / 2));
  const std::vector<ListedTopic> topics = OpenTable(half, "/joint_states").topics;
  const auto messages = static_cast<int>(topics[0].messages);
  EXPECT_GT(messages, 20);
  EXPECT_LT(messages, 40);
  EXPECT_TRUE(topics[0].is_cut);
  ExpectJointStates(TableOfTopic(half, "/joint_states"), messages);
}

// Every byte of a file, changed in several ways, and every length of it.
TEST(Mcap, ThatIsDamagedIsReadOrRefused) {
  const auto read = [](const std::string& bytes) {
    try {
      const std::unique_ptr<MessageFile> messages = ReadMcap(bytes);
      return test::TextFromPipe(
          [&](PipeWriter& pipe) { WriteTopicTable(*messages, "/joint_states", pipe); });
    } catch (const UserError& error) {
      EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
      return ""s;
    }
  };
  for (const char* name : {"zstd.mcap", "lz4.mcap", "plain.mcap"}) {
    SCOPED_TRACE(name);
    const std::string whole = BytesOfMcap(ShippedMcap(name));
    const std::string table = read(whole);
    ASSERT_THAT(table, HasSubstr("index_mcp_rad"));
    int changed = 0;
    for (std::size_t i = 0; i < whole.size(); i += 43) {
      std::string damaged = whole;
      damaged[i] = static_cast<char>(damaged[i] ^ (i % 2 == 0 ? 0x80 : 1));
      const std::string found = read(damaged);
      // Chunks, the data and the summary have checksums, so no value is wrong.
      if (!found.empty() && found != table) ++changed;
      const std::string cut = read(whole.substr(0, i));
      if (cut.empty()) continue;
      // Perhaps with fewer columns: those of the messages that are whole.
      for (std::string_view left = cut, all = table; left != all && !left.empty();) {
        const std::string_view row = left.substr(0, left.find('\n'));
        if (!left.starts_with("time_s") && !left.starts_with('#')) {
          EXPECT_TRUE(table.find("\n" + std::string(row)) != std::string::npos) << i;
        }
        left.remove_prefix(row.size() + 1);
      }
    }
    EXPECT_EQ(changed, 0);
  }
}

/// Two JointState messages, a second apart, of our writer of CDR.
std::string JointStateMessage(std::int64_t stamp_ns, const std::vector<std::string>& names,
                              const std::vector<double>& positions) {
  CdrWriter message;
  message.Time(stamp_ns);
  message.Text("");
  message.Texts(names);
  message.Numbers(positions);
  message.Numbers({});
  message.Numbers({});
  return std::string(message.message());
}

// A bag as rosbag2 writes it in SQLite.
void MakeBag(const fs::path& file, const std::string& type,
             const std::vector<std::pair<std::int64_t, std::string>>& messages,
             const std::string& definition = {}) {
  fs::remove(file);
  sqlite3* database = nullptr;
  ASSERT_EQ(sqlite3_open(file.c_str(), &database), SQLITE_OK);
  const auto run = [&](const std::string& text) {
    EXPECT_EQ(sqlite3_exec(database, text.c_str(), nullptr, nullptr, nullptr), SQLITE_OK)
        << sqlite3_errmsg(database);
  };
  run("CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT NOT NULL, type TEXT NOT NULL, "
      "serialization_format TEXT NOT NULL, offered_qos_profiles TEXT NOT NULL);"
      "CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER NOT NULL, timestamp INTEGER "
      "NOT NULL, data BLOB NOT NULL);"
      "CREATE INDEX timestamp_idx ON messages (timestamp ASC);"
      "INSERT INTO topics VALUES(1, '/joints', '" +
      type +
      "', 'cdr', '');"
      "INSERT INTO topics VALUES(2, '/rosout', 'rcl_interfaces/msg/Log', 'cdr', '');");
  if (!definition.empty()) {
    run("CREATE TABLE message_definitions(id INTEGER PRIMARY KEY, topic_type TEXT NOT NULL, "
        "encoding TEXT NOT NULL, encoded_message_definition TEXT NOT NULL, type_description_hash "
        "TEXT NOT NULL);"
        "INSERT INTO message_definitions VALUES(1, '" +
        type + "', 'ros2msg', '" + definition + "', '');");
  }
  for (const auto& [ns, data] : messages) {
    std::string hex;
    for (const char byte : data) hex += fmt::format("{:02x}", static_cast<unsigned char>(byte));
    run(fmt::format("INSERT INTO messages(topic_id, timestamp, data) VALUES(1, {}, x'{}')", ns,
                    hex));
  }
  sqlite3_close(database);
}

TEST_F(BagTest, OfSqliteIsReadByTheTypesThatGauntletKnows) {
  const fs::path file = folder_.path() / "a b%.db3";
  MakeBag(file, "sensor_msgs/msg/JointState",
          {{3000000000, JointStateMessage(2500000000, {"a", "b"}, {5, 6})},
           {1000000000, JointStateMessage(500000000, {"b", "a"}, {2, 1})},
           {2000000000, JointStateMessage(1500000000, {"a", "b"}, {3, 4})}});
  EXPECT_EQ(test::TextOf(TableSource(file)), "time_s,b_rad,a_rad\n0.5,2,1\n1.5,4,3\n2.5,6,5\n");
  const std::vector<ListedTopic> topics = OpenTable(file).topics;
  ASSERT_EQ(topics.size(), 2U);
  EXPECT_NEAR(topics[0].rate_hz, 1.0, 1e-9);
  EXPECT_THAT(topics[1].problem, HasSubstr("no definition of rcl_interfaces/msg/Log"));
  std::ofstream(file.string() + "-wal") << "x";
  EXPECT_THAT(ErrorOfTopic(file), HasSubstr("that are not in it yet"));
}

/// Fast DDS counts the place of an aligned number for each empty list and leaves it unset: seen in
/// bags of JointState with two empty lists.
TEST_F(BagTest, MayHaveUnsetBytesBehindEmptyLists) {
  const fs::path file = folder_.path() / "padded.db3";
  const auto padded = [](std::int64_t ns, const char* bytes) {
    return std::pair(ns, JointStateMessage(ns, {"a"}, {1.0 * static_cast<double>(ns)}) + bytes);
  };
  MakeBag(file, "sensor_msgs/msg/JointState", {padded(1, "12345678"), padded(2, "87654321")});
  EXPECT_EQ(test::TextOf(TableSource(file)), "time_s,a_rad\n1e-09,1\n2e-09,2\n");
  MakeBag(file, "sensor_msgs/msg/JointState", {padded(1, "1234567890123456")});
  EXPECT_THROW(TableSource(file, "/joints"), UserError);
}

TEST_F(BagTest, NamesTheUnitOfJointsThatSlide) {
  const fs::path file = folder_.path() / "gripper.db3";
  std::vector<std::pair<std::int64_t, std::string>> messages;
  for (int k = 0; k < 3; ++k) {
    const std::int64_t ns = 1000000000LL * (k + 1);
    messages.emplace_back(
        ns, JointStateMessage(ns, {"gripper", "elbow", "pan"}, {0.01 * k, 0.5 * k, 40.0 * k}));
  }
  MakeBag(file, "sensor_msgs/msg/JointState", messages);
  EXPECT_EQ(test::TextOf(TableSource(file)),
            "time_s,gripper,elbow_rad,pan\n1,0,0,0\n2,0.01,0.5,40\n"
            "# gripper: radians or metres, unknown (a gripper by its name)\n"
            "# pan: up to 80, beyond a turn in radians, so the unit is unknown\n"
            "3,0.02,1,80\n");
}

TEST_F(BagTest, OfSqliteIsReadByTheDefinitionsInIt) {
  const fs::path file = folder_.path() / "own.db3";
  CdrWriter first, second;
  first.Numbers(std::vector<double>{1, 2});
  second.Numbers(std::vector<double>{3, 4});
  const std::vector<std::pair<std::int64_t, std::string>> messages = {
      {1000000000, std::string(first.message())}, {1010000000, std::string(second.message())}};
  MakeBag(file, "my_msgs/msg/Flex", messages, "float64[] flex\n");
  EXPECT_EQ(test::TextOf(TableSource(file)), "time_s,flex_1,flex_2\n1,1,2\n1.01,3,4\n");
  MakeBag(file, "my_msgs/msg/Flex", messages);
  EXPECT_THAT(ErrorOfTopic(file), HasSubstr("no definition of my_msgs/msg/Flex as ros2msg"));
  // Of another type than it says: one byte too few, or too many.
  MakeBag(file, "sensor_msgs/msg/JointState", messages);
  EXPECT_THAT(ErrorOfTopic(file), HasSubstr("message 1 of /joints: is damaged: a message "));
  MakeBag(file, "std_msgs/msg/Float32", messages);
  EXPECT_THAT(ErrorOfTopic(file), HasSubstr("a message is longer than its type"));
}

TEST_F(BagTest, IsAFolderOfParts) {
  const auto message = [](int k) {
    const std::int64_t ns = (100 + k) * std::int64_t{10000000};
    return std::pair(ns, JointStateMessage(ns, {"a"}, {1.0 * k}));
  };
  // By number, not by letters.
  MakeBag(folder_.path() / "bag_2.db3", "sensor_msgs/msg/JointState", {message(0), message(1)});
  MakeBag(folder_.path() / "bag_10.db3", "sensor_msgs/msg/JointState", {message(2)});
  EXPECT_EQ(OpenTable(folder_.path()).format, FileFormat::kSqlite);
  const std::string table = "time_s,a_rad\n1,0\n1.01,1\n1.02,2\n";
  EXPECT_EQ(test::TextOf(TableSource(folder_.path())), table);
  EXPECT_EQ(OpenTable(folder_.path()).topics[0].messages, 3U);
  // Rows are sorted by time whatever the order of the files is.
  Write("metadata.yaml",
        "rosbag2_bagfile_information:\n  version: 5\n  relative_file_paths:\n    - bag_10.db3\n    "
        "- \"bag_2.db3\"\n  duration:\n    nanoseconds: 1\n");
  EXPECT_EQ(test::TextOf(TableSource(folder_.path())), table);
  Write("metadata.yaml", "relative_file_paths:\n  - bag_10.db3\n  - bag_3.db3\n");
  EXPECT_THAT(ErrorOfTopic(folder_.path()), HasSubstr("bag_3.db3"));
  Write("metadata.yaml", "relative_file_paths:\n  - bag_3.db3\n");
  Write("bag_3.db3", "");  // of a recorder that was killed at once
  EXPECT_THAT(ErrorOfTopic(folder_.path()), HasSubstr("bag_3.db3: is empty, must be MCAP or"));
  fs::remove(folder_.path() / "bag_3.db3");
  // Compressed as a whole: the unpacked file is taken, whatever is listed.
  Write("metadata.yaml", "relative_file_paths:\n  - bag_2.db3.zstd\n");
  EXPECT_EQ(test::TextOf(TableSource(folder_.path())), "time_s,a_rad\n1,0\n1.01,1\n");
  Write("metadata.yaml", "relative_file_paths:\n  - bag_4.db3.zstd\n");
  Write("bag_4.db3.zstd", "\x28\xb5\x2f\xfd..");
  EXPECT_THAT(ErrorOfTopic(folder_.path()),
              HasSubstr("bag_4.db3.zstd: is zstd, which is not read; unpack it: zstd -d FILE"));
  fs::remove(folder_.path() / "metadata.yaml");
  EXPECT_THAT(ErrorOfTopic(folder_.path()),
              HasSubstr("has a file bag_4.db3.zstd, which is zstd; unpack it"));
  fs::remove(folder_.path() / "bag_4.db3.zstd");
  Write("other_1.mcap", "");
  EXPECT_THAT(ErrorOfTopic(folder_.path()), HasSubstr("has several recordings"));
}

std::vector<double> RowOf(const std::string& definition, const std::string& message) {
  MessageRows rows({.name = "/t",
                    .type = "p/msg/T",
                    .encoding = "cdr",
                    .schema_encoding = "ros2msg",
                    .schema = definition});
  rows.Read(message);
  return rows.row();
}

// Bytes by the rules of CDR, in both orders.
TEST(MessageRows, ReadsCdrOfBothByteOrders) {
  const std::string definition = "uint8 a\nint16 b\nfloat64 c\nbool[3] d\nuint32[] e\nint64 f\n";
  const std::string little = "\0\1\0\0"s + "\x05\0\xfe\xff\0\0\0\0"s + "\0\0\0\0\0\0\xf8\x3f"s +
                             "\1\0\1\0"s + "\2\0\0\0\1\0\0\0\2\0\0\0"s +
                             "\xff\xff\xff\xff\xff\xff\xff\xff"s;
  const std::string big = "\0\0\0\0"s + "\x05\0\xff\xfe\0\0\0\0"s + "\x3f\xf8\0\0\0\0\0\0"s +
                          "\1\0\1\0"s + "\0\0\0\2\0\0\0\1\0\0\0\2"s +
                          "\xff\xff\xff\xff\xff\xff\xff\xff"s;
  for (const std::string& message : {little, big}) {
    // In the order of the definition, lists behind single numbers.
    EXPECT_THAT(RowOf(definition, message), ElementsAre(5, -2, 1.5, -1, 1, 0, 1, 1, 2));
  }
}

TEST(MessageRows, RefusesWhatItDoesNotRead) {
  const auto error = [](const std::string& definition, const std::string& message) {
    try {
      RowOf(definition, message);
    } catch (const UserError& problem) {
      return std::string(problem.what());
    }
    return ""s;
  };
  EXPECT_THAT(error("uint8 a\n", "\0\7\0\0\1"s), HasSubstr("CDR variant 00 07"));
  EXPECT_THAT(error("wstring a\n", ""), HasSubstr("wide strings in the type p/T"));
  EXPECT_THAT(error("q/Part a\n", ""), HasSubstr("definition of the type q/Part"));
  EXPECT_THAT(error("T again\n", ""), HasSubstr("nested too deeply"));
  EXPECT_THAT(error("float64[] a\n", "\0\1\0\0\xff\xff\xff\x7f"s),
              HasSubstr("longer than the message"));
  // Two names for three values, after messages with one for each.
  Topic topic;
  topic.type = "sensor_msgs/msg/JointState";
  topic.encoding = "cdr";
  MessageRows rows(topic);
  rows.Read(JointStateMessage(1, {"a", "b"}, {1, 2}));
  EXPECT_THROW(rows.Read(JointStateMessage(1, {"a", "b"}, {1, 2, 3})), UserError);
  EXPECT_THROW(rows.Read(JointStateMessage(1, {"a", "a"}, {1, 2})), UserError);
}

// foxglove.JointStates in JSON, as foxglove-sdk 0.30.3 (PyPI) writes it. Wrong: joints by place, so
// that a message in another order exchanges fingers.
TEST(MessageRows, CallsItemsOfAListByTheirNames) {
  Topic topic;
  topic.encoding = "json";
  MessageRows rows(topic);
  rows.Read(R"({"timestamp": {"sec": 1, "nsec": 5}, "joints": [{"name": "index_mcp", "position": 1},
                {"name": "index_pip", "position": 2}]})");
  EXPECT_EQ(rows.stamp_ns(), 1000000005);
  rows.Read(R"({"joints": [{"name": "index_pip", "position": 4},
                {"name": "index_mcp", "position": 3}]})");
  EXPECT_THAT(rows.columns(),
              ElementsAre("joints_index_mcp_position", "joints_index_pip_position"));
  EXPECT_THAT(rows.row(), ElementsAre(3, 4));
  MessageRows unnamed(topic);
  unnamed.Read(R"({"f": [{"name": "a", "x": 1}, {"name": "a", "x": 2}, {"x": 3}]})");
  EXPECT_THAT(unnamed.columns(), ElementsAre("f_1_x", "f_2_x", "f_3_x"));
}

/// One topic with these times, and its message's number as the only value.
class TimedMessages : public MessageFile {
 public:
  explicit TimedMessages(std::vector<std::int64_t> times_ns) : times_ns_(std::move(times_ns)) {
    Topic topic;
    topic.name = "/t";
    topic.encoding = "json";
    topic.messages = times_ns_.size();
    topics_.push_back(topic);
  }
  void ForEachMessage(std::size_t /*topic*/, const Visit& visit) override {
    visited_ = 0;
    for (const std::int64_t time_ns : times_ns_) {
      visit(time_ns, fmt::format("{{\"x\": {}}}", visited_));
      ++visited_;
    }
  }
  /// Messages of the last pass so far.
  std::size_t visited() const { return visited_; }

 private:
  std::vector<std::int64_t> times_ns_;
  std::size_t visited_ = 0;
};

// The rows of a large file are not held in memory, in whatever order they are.
TEST(WriteTopicTable, SortsRowsAndHoldsNone) {
  constexpr std::size_t kCount = 120'000;
  std::vector<std::int64_t> sorted(kCount);
  for (std::size_t i = 0; i < kCount; ++i) sorted[i] = static_cast<std::int64_t>(i / 2 * 10);
  const auto moved = [&](std::size_t from, std::size_t to) {
    std::vector<std::int64_t> times = sorted;
    const std::int64_t time = times[from];
    times.erase(times.begin() + static_cast<std::ptrdiff_t>(from));
    times.insert(times.begin() + static_cast<std::ptrdiff_t>(to), time);
    return times;
  };
  std::vector<std::int64_t> halves = sorted, in_pairs = sorted;
  std::rotate(halves.begin(), halves.begin() + kCount / 2, halves.end());
  for (std::size_t i = 0; i + 3 < kCount; i += 4) std::swap(in_pairs[i], in_pairs[i + 3]);
  for (const std::vector<std::int64_t>& times_ns :
       {sorted, moved(7, kCount - 1), moved(kCount - 1, 0), moved(500, 700), in_pairs, halves}) {
    std::vector<std::size_t> order(kCount);
    std::iota(order.begin(), order.end(), 0);
    std::ranges::stable_sort(order, {}, [&](std::size_t i) { return times_ns[i]; });
    TimedMessages file(times_ns);
    std::string bytes;
    std::size_t first_rows_at = 0;  // messages that were read before the first block of rows
    PipeWriter pipe([&](std::span<const char> part) {
      if (first_rows_at == 0 && part.size() > 1000) first_rows_at = file.visited();
      bytes.append(part.begin(), part.end());
    });
    WriteTopicTable(file, "", pipe);
    EXPECT_LT(first_rows_at, kCount / 2);
    PipeReader reader([&, read = std::size_t{0}](std::span<char> part) mutable {
      std::ranges::copy(bytes.substr(read, part.size()), part.begin());
      read += part.size();
    });
    const Table table = ReadTable(reader);
    ASSERT_EQ(table.rows, kCount);
    for (std::size_t row = 0; row < kCount; ++row) {
      ASSERT_EQ(table.columns[1].numbers[row], static_cast<double>(order[row]));
      ASSERT_DOUBLE_EQ(table.columns[0].numbers[row],
                       1e-9 * static_cast<double>(times_ns[order[row]]));
    }
  }
}

// A reader that believed the index would take a part of the messages for all.
TEST(Mcap, WhoseIndexCountsOtherMessagesIsRefused) {
  std::string bytes;
  McapWriter writer([&](std::string_view part) { bytes.append(part); });
  const std::uint16_t joints = writer.AddTopic("/joints", "sensor_msgs/msg/JointState",
                                               KnownMessage("sensor_msgs/JointState"));
  for (int k = 1; k <= 9; ++k) {
    writer.AddMessage(joints, k * std::int64_t{1000000},
                      JointStateMessage(k * std::int64_t{1000000}, {"a"}, {0.1 * k}));
  }
  writer.Finish();
  // The last field of the statistics is the number of messages of each channel; the checksum of the
  // summary, in the footer, becomes 0: none.
  const std::size_t footer = bytes.size() - 8 - 4;
  bytes.replace(footer, 4, 4, '\0');
  const std::string statistics = "\x0b"s + std::string("\x38\0\0\0\0\0\0\0", 8);
  const std::size_t at = bytes.rfind(statistics);
  ASSERT_NE(at, std::string::npos);
  char& count = bytes[at + 9 + 46 + 2];
  ASSERT_EQ(count, 9);
  for (const char other : {8, 10}) {
    count = other;
    const std::unique_ptr<MessageFile> messages = ReadMcap(bytes);
    EXPECT_EQ(messages->topics()[0].messages, static_cast<std::uint64_t>(other));
    try {
      test::TextFromPipe([&](PipeWriter& pipe) { WriteTopicTable(*messages, "", pipe); });
      FAIL() << int{other};
    } catch (const UserError& error) {
      EXPECT_THAT(
          error.what(),
          HasSubstr(fmt::format("its index counts {} messages of /joints, it has 9", int{other})));
    }
  }
}

TEST(McapWriter, IsReadBackWithAndWithoutItsIndex) {
  std::string bytes;
  McapWriter writer([&](std::string_view part) { bytes.append(part); });
  const std::uint16_t joints = writer.AddTopic("/joints", "sensor_msgs/msg/JointState",
                                               KnownMessage("sensor_msgs/JointState"));
  const std::uint16_t other = writer.AddTopic("/other", "sensor_msgs/msg/JointState",
                                              KnownMessage("sensor_msgs/JointState"));
  constexpr int kMessages = 16000;  // of several chunks
  for (int k = 0; k < kMessages; ++k) {
    const std::int64_t ns = std::int64_t{k + 1} * 1000000;
    writer.AddMessage(joints, ns, JointStateMessage(ns, {"a", "b"}, {0.1 * k, -k / 3.0}));
    if (k == 1 || k == 12000) writer.AddMessage(other, ns, JointStateMessage(ns, {"c"}, {1.0 * k}));
  }
  writer.Finish();
  test::TemporaryDirectory folder;
  const fs::path file = folder.path() / "a.mcap";
  // Without its end it has no index.
  for (const std::size_t cut : {0, 1}) {
    std::ofstream(file, std::ios::binary) << bytes.substr(0, bytes.size() - cut);
    const std::unique_ptr<MessageFile> messages = OpenMcap(file);
    EXPECT_EQ(messages->topics()[0].messages, static_cast<std::uint64_t>(kMessages));
    EXPECT_EQ(messages->topics()[0].first_ns, 1000000);
    EXPECT_EQ(messages->topics()[0].last_ns, kMessages * std::int64_t{1000000});
    const Columns columns = TableOfTopic(file, "/joints");  // beyond a turn: no unit
    for (int k = 0; k < kMessages; ++k) {
      const auto row = static_cast<std::size_t>(k);
      ASSERT_EQ(columns.at("time_s").at(row), (k + 1) / 1000.0);
      ASSERT_EQ(columns.at("a").at(row), 0.1 * k);
      ASSERT_EQ(columns.at("b").at(row), -k / 3.0);
    }
    EXPECT_THAT(TableOfTopic(file, "/other").at("c"), ElementsAre(1, 12000));
  }
}

// --- Records by mcap.dev/spec --------------------------------------------------------------------

template <class Value>
std::string LittleOf(Value value) {
  std::string bytes(sizeof value, '\0');
  std::memcpy(bytes.data(), &value, sizeof value);
  return bytes;
}
std::string TextOfMcap(const std::string& text) {
  return LittleOf(static_cast<std::uint32_t>(text.size())) + text;
}
std::string RecordOf(int opcode, const std::string& content) {
  return static_cast<char>(opcode) + LittleOf(std::uint64_t{content.size()}) + content;
}
std::string SchemaRecord(std::uint16_t id, const std::string& name, const std::string& text) {
  return RecordOf(3, LittleOf(id) + TextOfMcap(name) + TextOfMcap("ros2msg") + TextOfMcap(text));
}
std::string ChannelRecord(std::uint16_t id, std::uint16_t schema, const std::string& name,
                          const std::string& encoding = "json") {
  return RecordOf(4, LittleOf(id) + LittleOf(schema) + TextOfMcap(name) + TextOfMcap(encoding) +
                         LittleOf(std::uint32_t{0}));
}
std::string MessageRecord(std::uint16_t channel, std::int64_t ns, const std::string& data) {
  return RecordOf(
      5, LittleOf(channel) + LittleOf(std::uint32_t{0}) + LittleOf(ns) + LittleOf(ns) + data);
}
std::string ChunkRecord(const std::string& records, const std::string& compression,
                        std::uint64_t size, std::uint32_t crc) {
  return RecordOf(6, LittleOf(std::int64_t{0}) + LittleOf(std::int64_t{0}) + LittleOf(size) +
                         LittleOf(crc) + TextOfMcap(compression) +
                         LittleOf(std::uint64_t{records.size()}) + records);
}
const std::string kMagicOfMcap = "\x89MCAP0\r\n";
/// A file without a summary; `crc`: of the data, 0 for none.
std::string McapOf(const std::string& records, std::uint32_t crc = 0) {
  return kMagicOfMcap + RecordOf(1, TextOfMcap("") + TextOfMcap("test")) + records +
         RecordOf(15, LittleOf(crc)) + RecordOf(2, std::string(20, '\0')) + kMagicOfMcap;
}

std::string TableOfMcap(const std::string& bytes) {
  return test::TextFromPipe([&](PipeWriter& pipe) { WriteTopicTable(*ReadMcap(bytes), "", pipe); });
}
std::string ErrorOfMcap(const std::string& bytes) {
  try {
    TableOfMcap(bytes);
  } catch (const UserError& error) {
    return error.what();
  }
  return "";
}

TEST(Mcap, WithoutASummaryIsReadByItsRecords) {
  const std::string channel = ChannelRecord(7, 0, "/a");
  const std::string first = MessageRecord(7, 2000000000, R"({"x": 1})");
  const std::string second = MessageRecord(7, 3000000000, R"({"x": 2})");
  const std::string table = "time_s,x\n2,1\n3,2\n";
  const std::string all = channel + first + second;
  EXPECT_EQ(TableOfMcap(McapOf(all)), table);
  // Records of other kinds, attachments say, are passed over, also where they are large.
  EXPECT_EQ(TableOfMcap(McapOf(channel + RecordOf(9, std::string(700'000, 'x')) + first +
                               RecordOf(0x80, "private") + second)),
            table);
  // The checksum of the data is that of all bytes before its end.
  const std::string whole = McapOf(all);
  const std::string data = whole.substr(0, whole.size() - 8 - 29 - 13);
  EXPECT_EQ(TableOfMcap(McapOf(all, Crc32Of(data))), table);
  EXPECT_THAT(ErrorOfMcap(McapOf(all, Crc32Of(data) ^ 1)),
              HasSubstr("it does not have its checksum"));
  const std::string large = channel + RecordOf(9, std::string(700'000, 'x')) + first + second;
  const std::string large_file = McapOf(large);
  const std::uint32_t sum = Crc32Of(large_file.substr(0, large_file.size() - 8 - 29 - 13));
  EXPECT_EQ(TableOfMcap(McapOf(large, sum)), table);
  // Two channels of one topic, and a schema that is given again.
  EXPECT_EQ(TableOfMcap(McapOf(channel + ChannelRecord(8, 0, "/a") + first +
                               MessageRecord(8, 3000000000, R"({"x": 2})"))),
            table);
}

TEST(Mcap, WithChunksIsReadByTheirRecords) {
  const std::string records = ChannelRecord(0, 0, "/a") +
                              MessageRecord(0, 2000000000, R"({"x": 1})") +
                              MessageRecord(0, 3000000000, R"({"x": 2})");
  const std::string table = "time_s,x\n2,1\n3,2\n";
  const std::uint64_t size = records.size();
  const std::uint32_t crc = Crc32Of(records);
  EXPECT_EQ(TableOfMcap(McapOf(ChunkRecord(records, "", size, crc))), table);
  EXPECT_EQ(TableOfMcap(McapOf(ChunkRecord(records, "", size, 0))), table);
  // A checksum of the data is not compared then: chunks have their own.
  EXPECT_EQ(TableOfMcap(McapOf(ChunkRecord(records, "", size, crc), 5)), table);
  const struct {
    std::string chunk;
    const char* problem;
  } known[] = {
      {ChunkRecord(records, "", size, crc ^ 1), "a chunk does not have its checksum"},
      {ChunkRecord(records, "", size + 1, 0), "a chunk has another size than it says"},
      {ChunkRecord(records, "", size - 1, 0), "a chunk has another size than it says"},
      {ChunkRecord(records, "zstd", size, crc), "a chunk is not whole"},
      {ChunkRecord(records, "lz4", size, crc), "a chunk is not whole"},
      {ChunkRecord(records, "brotli", size, crc), "is compressed by brotli, which is not read"},
      {ChunkRecord(records, "", (1U << 28) + 1, 0), "has a chunk of 256 MB, must be at most 256"},
  };
  for (const auto& [chunk, problem] : known) {
    EXPECT_THAT(ErrorOfMcap(McapOf(chunk)), HasSubstr(problem));
  }
}

TEST(Mcap, WhoseRecordsDoNotFitIsRefused) {
  const std::string schema = SchemaRecord(1, "p/msg/T", "float64 x\n");
  const std::string message = MessageRecord(0, 1, R"({"x": 1})");
  EXPECT_THAT(ErrorOfMcap(McapOf(ChannelRecord(0, 7, "/a") + message)),
              HasSubstr("the schema of /a is missing"));
  EXPECT_THAT(ErrorOfMcap(McapOf(message)), HasSubstr("a message has an unknown channel"));
  EXPECT_THAT(ErrorOfMcap("\x89MCAP1\r\n" + std::string(50, 'x')),
              HasSubstr("it does not begin as MCAP"));
  for (const std::string& other :
       {ChannelRecord(1, 0, "/a"), ChannelRecord(1, 1, "/a", "cdr"),
        SchemaRecord(2, "p/msg/T", "int8 y\n") + ChannelRecord(1, 2, "/a"),
        SchemaRecord(2, "p/msg/U", "float64 x\n") + ChannelRecord(1, 2, "/a")}) {
    const std::unique_ptr<MessageFile> file =
        ReadMcap(McapOf(schema + ChannelRecord(0, 1, "/a") + other + message));
    EXPECT_EQ(file->topics()[0].problem, "its messages are of several types");
  }
  EXPECT_EQ(
      ReadMcap(McapOf(schema + ChannelRecord(0, 1, "/a") + ChannelRecord(1, 1, "/a") + message))
          ->topics()[0]
          .problem,
      "");
}

/// Takes numbers and texts off the front of a record.
class RecordBytes {
 public:
  explicit RecordBytes(std::string_view rest) : rest_(rest) {}
  template <class Value>
  Value Take() {
    Value value;
    EXPECT_GE(rest_.size(), sizeof value);
    std::memcpy(&value, rest_.data(), sizeof value);
    rest_.remove_prefix(sizeof value);
    return value;
  }
  std::string Text() {
    const auto size = Take<std::uint32_t>();
    const std::string text(rest_.substr(0, size));
    rest_.remove_prefix(size);
    return text;
  }
  std::string_view rest() const { return rest_; }

 private:
  std::string_view rest_;
};

// Every field that another reader may look at.
TEST(McapWriter, WritesWhatTheSpecificationSays) {
  std::string bytes;
  McapWriter writer([&](std::string_view part) { bytes.append(part); });
  const std::uint16_t a = writer.AddTopic("/a", "p/msg/T", "float64[] x\n");
  const std::uint16_t b = writer.AddTopic("/b", "p/msg/T", "float64[] x\n");
  const std::uint16_t c = writer.AddTopic("/c", "p/msg/U", "uint8 y\n");
  const std::string data(300'000, 'd');
  const std::vector<std::pair<std::uint16_t, std::int64_t>> messages = {
      {a, 50}, {b, 40}, {a, 60}, {a, 70}, {a, 80}, {b, 20}, {a, 90}};
  for (const auto& [topic, ns] : messages) writer.AddMessage(topic, ns, data);
  writer.Finish();
  ASSERT_TRUE(bytes.starts_with(kMagicOfMcap));
  ASSERT_TRUE(bytes.ends_with(kMagicOfMcap));
  struct ChunkFacts {
    std::int64_t first_ns = 0, last_ns = 0;
    std::uint64_t at = 0, bytes = 0, size = 0, stored = 0, index_bytes = 0;
    std::map<std::uint16_t, std::uint64_t> indexes = {};
  };
  std::vector<ChunkFacts> chunks, indexed;
  std::map<std::uint16_t, std::uint32_t> counts;
  std::size_t summary_at = 0, schemas = 0, channels = 0;
  std::size_t seen = 0;  // messages
  std::string records;   // of the last chunk
  for (std::size_t at = 8; at + 8 < bytes.size();) {
    RecordBytes head(std::string_view(bytes).substr(at));
    const int opcode = head.Take<std::uint8_t>();
    const auto length = head.Take<std::uint64_t>();
    RecordBytes record(head.rest().substr(0, length));
    if (opcode == 1) {
      EXPECT_EQ(record.Text(), "ros2");
    } else if (opcode == 6) {
      ChunkFacts chunk = {.first_ns = record.Take<std::int64_t>(),
                          .last_ns = record.Take<std::int64_t>()};
      chunk.at = at;
      chunk.bytes = 9 + length;
      chunk.size = record.Take<std::uint64_t>();
      const auto crc = record.Take<std::uint32_t>();
      EXPECT_EQ(record.Text(), "zstd");
      chunk.stored = record.Take<std::uint64_t>();
      EXPECT_EQ(record.rest().size(), chunk.stored);
      records.assign(chunk.size, '\0');
      EXPECT_EQ(ZSTD_decompress(records.data(), records.size(), record.rest().data(), chunk.stored),
                chunk.size);
      EXPECT_EQ(Crc32Of(records), crc);
      std::int64_t first_ns = INT64_MAX, last_ns = 0;
      for (std::size_t place = 0; place < records.size();) {
        RecordBytes inner_head(std::string_view(records).substr(place));
        const int inner = inner_head.Take<std::uint8_t>();
        const auto inner_length = inner_head.Take<std::uint64_t>();
        RecordBytes message(inner_head.rest().substr(0, inner_length));
        place += 9 + inner_length;
        if (inner != 5) continue;
        const auto& [topic, ns] = messages.at(seen++);
        EXPECT_EQ(message.Take<std::uint16_t>(), topic);
        EXPECT_EQ(message.Take<std::uint32_t>(), counts[topic]++);
        EXPECT_EQ(message.Take<std::int64_t>(), ns);
        EXPECT_EQ(message.Take<std::int64_t>(), ns);
        EXPECT_EQ(message.rest(), data);
        first_ns = std::min(first_ns, ns);
        last_ns = std::max(last_ns, ns);
      }
      EXPECT_EQ(chunk.first_ns, first_ns);
      EXPECT_EQ(chunk.last_ns, last_ns);
      chunks.push_back(chunk);
    } else if (opcode == 7) {
      chunks.back().index_bytes += 9 + length;
      const auto channel = record.Take<std::uint16_t>();
      chunks.back().indexes[channel] = at;
      RecordBytes entries(record.rest());
      EXPECT_EQ(entries.Take<std::uint32_t>(), record.rest().size() - 4);
      while (!entries.rest().empty()) {
        const auto ns = entries.Take<std::int64_t>();
        const auto place = entries.Take<std::uint64_t>();
        EXPECT_EQ(records.substr(place, 9 + 14), MessageRecord(channel, ns, data).substr(0, 11) +
                                                     records.substr(place + 11, 4) + LittleOf(ns));
      }
    } else if (opcode == 15) {
      EXPECT_EQ(record.Take<std::uint32_t>(), 0U);
      summary_at = at + 9 + length;
    } else if (opcode == 3) {
      EXPECT_EQ(record.Take<std::uint16_t>(), ++schemas);
      EXPECT_EQ(record.Text(), schemas == 1 ? "p/msg/T" : "p/msg/U");
      EXPECT_EQ(record.Text(), "ros2msg");
      EXPECT_EQ(record.Text(), schemas == 1 ? "float64[] x\n" : "uint8 y\n");
    } else if (opcode == 4) {
      EXPECT_EQ(record.Take<std::uint16_t>(), channels);
      EXPECT_EQ(record.Take<std::uint16_t>(), channels == c ? 2 : 1);
      EXPECT_EQ(record.Text(), channels == a ? "/a" : channels == b ? "/b" : "/c");
      EXPECT_EQ(record.Text(), "cdr");
      EXPECT_EQ(record.Text(), "");
      ++channels;
    } else if (opcode == 8) {
      ChunkFacts chunk = {.first_ns = record.Take<std::int64_t>(),
                          .last_ns = record.Take<std::int64_t>()};
      chunk.at = record.Take<std::uint64_t>();
      chunk.bytes = record.Take<std::uint64_t>();
      const auto entries_bytes = record.Take<std::uint32_t>();
      RecordBytes entries(record.rest().substr(0, entries_bytes));
      while (!entries.rest().empty()) {
        const auto channel = entries.Take<std::uint16_t>();
        chunk.indexes[channel] = entries.Take<std::uint64_t>();
      }
      record = RecordBytes(record.rest().substr(entries_bytes));
      chunk.index_bytes = record.Take<std::uint64_t>();
      EXPECT_EQ(record.Text(), "zstd");
      chunk.stored = record.Take<std::uint64_t>();
      chunk.size = record.Take<std::uint64_t>();
      indexed.push_back(chunk);
    } else if (opcode == 11) {
      EXPECT_EQ(record.Take<std::uint64_t>(), messages.size());
      EXPECT_EQ(record.Take<std::uint16_t>(), 2);
      EXPECT_EQ(record.Take<std::uint32_t>(), 3U);
      EXPECT_EQ(record.Take<std::uint32_t>(), 0U);  // attachments
      EXPECT_EQ(record.Take<std::uint32_t>(), 0U);  // metadata
      EXPECT_EQ(record.Take<std::uint32_t>(), chunks.size());
      EXPECT_EQ(record.Take<std::int64_t>(), 20);
      EXPECT_EQ(record.Take<std::int64_t>(), 90);
      RecordBytes entries(record.rest().substr(4));
      std::map<std::uint16_t, std::uint64_t> found;
      while (!entries.rest().empty()) {
        const auto channel = entries.Take<std::uint16_t>();
        found[channel] = entries.Take<std::uint64_t>();
      }
      EXPECT_EQ(found, (std::map<std::uint16_t, std::uint64_t>{{a, 5}, {b, 2}, {c, 0}}));
    } else if (opcode == 2) {
      EXPECT_EQ(record.Take<std::uint64_t>(), summary_at);
      EXPECT_EQ(record.Take<std::uint64_t>(), 0U);  // no offsets of the summary
      EXPECT_EQ(record.Take<std::uint32_t>(),
                Crc32Of(bytes.substr(summary_at, bytes.size() - summary_at - 12)));
    }
    at += 9 + length;
  }
  EXPECT_EQ(seen, messages.size());
  EXPECT_EQ(channels, 3U);
  ASSERT_EQ(chunks.size(), 2U);  // of a megabyte
  ASSERT_EQ(indexed.size(), 2U);
  for (std::size_t i = 0; i < chunks.size(); ++i) {
    EXPECT_EQ(indexed[i].first_ns, chunks[i].first_ns);
    EXPECT_EQ(indexed[i].last_ns, chunks[i].last_ns);
    EXPECT_EQ(indexed[i].at, chunks[i].at);
    EXPECT_EQ(indexed[i].bytes, chunks[i].bytes);
    EXPECT_EQ(indexed[i].size, chunks[i].size);
    EXPECT_EQ(indexed[i].stored, chunks[i].stored);
    EXPECT_EQ(indexed[i].index_bytes, chunks[i].index_bytes);
    EXPECT_EQ(indexed[i].indexes, chunks[i].indexes);
  }
}

}  // namespace
}  // namespace gauntlet::sim
