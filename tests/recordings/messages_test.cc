// Messages of ROS as rows: every type of their fields, in both orders of bytes and in JSON.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <zstd.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <string>
#include <vector>

#include "sim/base/error.h"
#include "sim/tables/message_file.h"
#include "sim/tables/message_rows.h"
#include "sim/tables/message_table.h"
#include "sim/tables/message_type.h"
#include "tests/support/table_text.h"

namespace gauntlet::sim {
namespace {

using namespace std::string_literals;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsNan;

Topic CdrTopic(const std::string& definition, const std::string& type = "p/msg/T") {
  Topic topic;
  topic.name = "/t";
  topic.type = type;
  topic.encoding = "cdr";
  topic.schema_encoding = definition.empty() ? "" : "ros2msg";
  topic.schema = definition;
  return topic;
}

Topic JsonTopic(const std::string& type = {}) {
  Topic topic;
  topic.name = "/t";
  topic.type = type;
  topic.encoding = "json";
  return topic;
}

/// Fields of CDR one after the other, each at a multiple of its size.
class Fields {
 public:
  explicit Fields(bool is_big) : is_big_(is_big) {}
  template <class Value>
  Fields& Put(Value value) {
    while (body_.size() % sizeof(Value) != 0) body_ += '\x55';  // padding has any bytes
    std::string bytes(sizeof(Value), '\0');
    std::memcpy(bytes.data(), &value, sizeof(Value));
    if (is_big_) std::ranges::reverse(bytes);
    body_ += bytes;
    return *this;
  }
  Fields& Text(const std::string& text) {
    Put(static_cast<std::uint32_t>(text.size() + 1));
    body_ += text + '\0';
    return *this;
  }
  std::string message() const { return "\0"s + (is_big_ ? '\0' : '\1') + "\0\0"s + body_; }

 private:
  bool is_big_;
  std::string body_;
};

std::string ErrorOf(const auto& call) {
  try {
    call();
  } catch (const UserError& error) {
    return error.what();
  }
  return "";
}

/// One number, an array and a list of a type, with its ends.
template <class Value>
void ExpectType(const std::string& type) {
  const Value least = std::numeric_limits<Value>::lowest();
  const Value most = std::numeric_limits<Value>::max();
  for (const bool is_big : {false, true}) {
    SCOPED_TRACE(type + (is_big ? " big" : " little"));
    MessageRows rows(
        CdrTopic(fmt::format("uint8 first\n{0} a\n{0}[2] b\n{0}[] c\n{0}[<=3] d\n", type)));
    Fields fields(is_big);
    fields.Put(std::uint8_t{9}).Put(least).Put(most).Put(least);
    fields.Put(std::uint32_t{2}).Put(Value{1}).Put(most).Put(std::uint32_t{1}).Put(least);
    rows.Read(fields.message());
    const auto low = static_cast<double>(least), high = static_cast<double>(most);
    EXPECT_THAT(rows.columns(), ElementsAre("first", "a", "b_1", "b_2", "c_1", "c_2", "d_1"));
    EXPECT_THAT(rows.row(), ElementsAre(9.0, low, high, low, 1.0, high, low));
  }
}

TEST(MessageRows, HasEveryTypeOfNumberInBothOrdersOfBytes) {
  ExpectType<std::int8_t>("int8");
  ExpectType<std::uint8_t>("uint8");
  ExpectType<std::uint8_t>("byte");
  ExpectType<std::uint8_t>("char");
  ExpectType<std::int16_t>("int16");
  ExpectType<std::uint16_t>("uint16");
  ExpectType<std::int32_t>("int32");
  ExpectType<std::uint32_t>("uint32");
  ExpectType<std::int64_t>("int64");
  ExpectType<std::uint64_t>("uint64");
  ExpectType<float>("float32");
  ExpectType<double>("float64");
}

TEST(MessageRows, HasTimesInSecondsBesideTheStampOfTheHeader) {
  for (const char* stamp : {"builtin_interfaces/Time stamp", "time stamp",
                            "builtin_interfaces/msg/Time timestamp", "std_msgs/Header header"}) {
    SCOPED_TRACE(stamp);
    const bool is_header = std::string(stamp).ends_with("header");
    MessageRows rows(CdrTopic(std::string(stamp) + "\nbuiltin_interfaces/Duration wait\n"
                                                   "builtin_interfaces/Time other\n"));
    const auto message = [&](std::int32_t sec, std::uint32_t ns) {
      Fields fields(false);
      fields.Put(sec).Put(ns);
      if (is_header) fields.Text("base");
      return fields.Put(std::int32_t{-2}).Put(500000000U).Put(std::int32_t{7}).Put(1U).message();
    };
    rows.Read(message(5, 250000001));
    EXPECT_EQ(rows.stamp_ns(), 5250000001);
    EXPECT_THAT(rows.columns(), ElementsAre("wait", "other"));
    EXPECT_THAT(rows.row(), ElementsAre(-1.5, 7.0 + 1e-9));
    rows.Read(message(0, 0));  // never set
    EXPECT_EQ(rows.stamp_ns(), std::nullopt);
  }
}

TEST(MessageRows, HasPartsListsOfPartsAndNoTexts) {
  MessageRows rows(
      CdrTopic("string note\nPoint one\nPoint[] many\nq/msg/Empty none\nstring[] words\n"
               "float32 behind # [N]\nint32 LIMIT=5\nint32 OTHER = 6\n\n# a comment\n"
               "================\nMSG: p/Point\nfloat64 x\nfloat64 y\n"
               "================\nMSG: q/Empty\n"));
  Fields fields(false);
  fields.Text("abc").Put(1.0).Put(2.0);
  fields.Put(std::uint32_t{2}).Put(3.0).Put(4.0).Put(5.0).Put(6.0);
  fields.Put(std::uint8_t{0});  // the member of a message without any
  fields.Put(std::uint32_t{2}).Text("a").Text("bcd").Put(7.5F);
  rows.Read(fields.message());
  EXPECT_THAT(rows.columns(), ElementsAre("one_x", "one_y", "many_1_x", "many_1_y", "many_2_x",
                                          "many_2_y", "behind"));
  EXPECT_THAT(rows.row(), ElementsAre(1, 2, 3, 4, 5, 6, 7.5));
  // A shorter list later: what it does not have is missing.
  Fields shorter(false);
  shorter.Text("").Put(1.0).Put(2.0).Put(std::uint32_t{1}).Put(3.0).Put(4.0);
  shorter.Put(std::uint8_t{0}).Put(std::uint32_t{0}).Put(8.5F);
  rows.Read(shorter.message());
  EXPECT_THAT(rows.row(), ElementsAre(1, 2, 3, 4, IsNan(), IsNan(), 8.5));
}

TEST(MessageRows, NamesValuesOfJoints) {
  MessageRows rows(CdrTopic("", "trajectory_msgs/msg/JointTrajectory"));
  Fields fields(false);
  fields.Put(std::int32_t{1}).Put(0U).Text("").Put(std::uint32_t{2}).Text("a").Text("b c");
  fields.Put(std::uint32_t{1});
  fields.Put(std::uint32_t{2}).Put(1.0).Put(2.0);      // positions
  fields.Put(std::uint32_t{0}).Put(std::uint32_t{0});  // velocities, accelerations
  fields.Put(std::uint32_t{2}).Put(3.0).Put(4.0).Put(std::int32_t{5}).Put(0U);
  rows.Read(fields.message());
  EXPECT_THAT(rows.columns(),
              ElementsAre("points_1_time_from_start", "points_1_positions_a",
                          "points_1_positions_b_c", "points_1_effort_a", "points_1_effort_b_c"));
  EXPECT_THAT(rows.row(), ElementsAre(5, 1, 2, 3, 4));
}

TEST(MessageRows, LeavesOutImagesAndLayouts) {
  MessageRows rows(CdrTopic("uint8[] data\nfloat64 a\n"));
  const auto message = [](std::uint32_t size) {
    Fields fields(false);
    fields.Put(size);
    for (std::uint32_t i = 0; i < size; ++i) fields.Put(std::uint8_t{7});
    return fields.Put(2.5).message();
  };
  rows.Read(message(65));
  EXPECT_THAT(rows.columns(), ElementsAre("a"));
  EXPECT_THAT(rows.row(), ElementsAre(2.5));
  rows.Read(message(64));
  EXPECT_EQ(rows.columns().size(), 65U);
  EXPECT_EQ(rows.row()[64], 7.0);
  MessageRows wide(CdrTopic("float32[] data\n"));
  const auto list = [](std::uint32_t size) {
    Fields fields(false);
    fields.Put(size);
    for (std::uint32_t i = 0; i < size; ++i) fields.Put(1.0F);
    return fields.message();
  };
  wide.Read(list(1000));
  EXPECT_EQ(wide.columns().size(), 1000U);
  EXPECT_EQ(ErrorOf([&] { wide.Read(list(1001)); }), "has messages of more than 1000 values");
  MessageRows array(CdrTopic("", "std_msgs/msg/Float32MultiArray"));
  Fields fields(false);
  fields.Put(std::uint32_t{1}).Text("x").Put(std::uint32_t{3}).Put(std::uint32_t{4});
  array.Read(fields.Put(std::uint32_t{5}).Put(std::uint32_t{1}).Put(6.5F).message());
  EXPECT_THAT(array.columns(), ElementsAre("data_1"));
}

TEST(MessageRows, RefusesAMessageOfAnotherLength) {
  const std::string whole = Fields(false).Text("abc").Put(std::uint32_t{1}).Put(2.0).message();
  const auto read = [](const std::string& message) {
    return ErrorOf([&] { MessageRows(CdrTopic("string s\nfloat64[] a\n")).Read(message); });
  };
  EXPECT_EQ(read(whole), "");
  for (std::size_t size = 0; size < whole.size(); ++size) {
    EXPECT_THAT(read(whole.substr(0, size)), HasSubstr("is damaged: ")) << size;
  }
  EXPECT_EQ(read(whole + std::string(7, 'x')), "");  // up to the next multiple of eight
  EXPECT_THAT(read(whole + std::string(8, 'x')), HasSubstr("a message is longer than its type"));
}

TEST(MessageRows, MayBeCompressed) {
  const std::string whole = Fields(false).Put(2.5).message();
  std::string packed(200, '\0');
  packed.resize(ZSTD_compress(packed.data(), packed.size(), whole.data(), whole.size(), 3));
  MessageRows rows(CdrTopic("float64 a\n"));
  rows.Read(packed);
  EXPECT_THAT(rows.row(), ElementsAre(2.5));
  EXPECT_THAT(ErrorOf([&] { rows.Read(packed.substr(0, packed.size() - 1)); }),
              HasSubstr("is damaged: a message is not whole"));
  EXPECT_THAT(ErrorOf([&] { rows.Read(packed.substr(0, 4)); }),
              HasSubstr("is damaged: a compressed message has no size"));
}

TEST(MessageRows, OfJsonHasNumbersListsAndParts) {
  MessageRows rows(JsonTopic());
  rows.Read(R"({"a": true, "b": null, "c": false, "d": [{"x": 1, "s": "t"}, {"x": -2.5}],
                "e": {"f": 3}, "g": [1, null, true], "h": []})");
  EXPECT_THAT(rows.columns(),
              ElementsAre("a", "b", "c", "d_1_x", "d_2_x", "e_f", "g_1", "g_2", "g_3"));
  EXPECT_THAT(rows.row(), ElementsAre(1, IsNan(), 0, 1, -2.5, 3, 1, IsNan(), 1));
  MessageRows number(JsonTopic()), list(JsonTopic());
  number.Read("7");
  EXPECT_THAT(number.columns(), ElementsAre("value"));
  list.Read("[7, 8]");
  EXPECT_THAT(list.columns(), ElementsAre("value_1", "value_2"));
  EXPECT_THAT(list.row(), ElementsAre(7, 8));
  EXPECT_THAT(ErrorOf([&] { list.Read("[7,"); }), HasSubstr("a message is no JSON"));
}

TEST(MessageRows, OfJsonHasTimesOfBothVersionsOfRos) {
  for (const char* key : {"nanosec", "nsec"}) {
    const auto stamp = [&](const std::string& sec, const std::string& ns) {
      return fmt::format(R"({{"sec": {}, "{}": {}}})", sec, key, ns);
    };
    MessageRows rows(JsonTopic());
    rows.Read(fmt::format(R"({{"header": {{"stamp": {}}}, "t": {}}})", stamp("5", "250000001"),
                          stamp("-2", "500000000")));
    EXPECT_EQ(rows.stamp_ns(), 5250000001);
    EXPECT_THAT(rows.columns(), ElementsAre("t"));
    EXPECT_THAT(rows.row(), ElementsAre(-1.5));
    rows.Read(fmt::format(R"({{"stamp": {}}})", stamp("0", "0")));
    EXPECT_EQ(rows.stamp_ns(), std::nullopt);
    for (const char* most : {"9000000000", "-9000000000"}) {
      MessageRows far(JsonTopic());
      far.Read(fmt::format(R"({{"stamp": {}}})", stamp(most, "1")));
      EXPECT_TRUE(far.stamp_ns()) << most;
    }
    // Texts that are no time are two numbers.
    for (const auto& [sec, ns] :
         {std::pair("9000000001", "1"), {"-9000000001", "1"}, {"1.5", "1"}, {"1", "1.5"}}) {
      MessageRows other(JsonTopic());
      other.Read(fmt::format(R"({{"stamp": {}}})", stamp(sec, ns)));
      EXPECT_EQ(other.stamp_ns(), std::nullopt) << sec;
      EXPECT_EQ(other.columns().size(), 2U) << sec;
    }
  }
  MessageRows three(JsonTopic());
  three.Read(R"({"stamp": {"sec": 1, "nanosec": 2, "x": 3}})");
  EXPECT_EQ(three.columns().size(), 3U);
}

TEST(MessageRows, OfJsonNamesValuesByTheOnlyListOfNames) {
  for (const char* key : {"name", "names", "joint_names"}) {
    MessageRows rows(JsonTopic());
    rows.Read(fmt::format(
        R"({{"{}": ["a", "b"], "x": [1, 2], "y": [3], "part": {{"velocity": [4, 5], "z": [6, 7]}}}})",
        key));
    EXPECT_THAT(rows.columns(), ElementsAre("x_a", "x_b", "y_1", "part_velocity_a",
                                            "part_velocity_b", "part_z_1", "part_z_2"))
        << key;
    EXPECT_THAT(rows.row(), ElementsAre(1, 2, 3, 4, 5, 6, 7));
    // In another order the columns stay.
    rows.Read(fmt::format(R"({{"{}": ["b", "a"], "x": [1, 2]}})", key));
    EXPECT_EQ(rows.row()[0], 2.0);
    EXPECT_EQ(rows.row()[1], 1.0);
  }
  MessageRows two(JsonTopic());
  two.Read(R"({"name": ["a"], "names": ["b"], "x": [1]})");
  EXPECT_THAT(two.columns(), ElementsAre("x_1"));
  MessageRows label(JsonTopic());
  label.Read(R"({"label": ["a"], "x": [1]})");
  EXPECT_THAT(label.columns(), ElementsAre("x_1"));
  // All lists with a value for each joint.
  for (const char* list : {"position", "positions", "velocity", "velocities", "acceleration",
                           "accelerations", "effort", "efforts", "values"}) {
    MessageRows deep(JsonTopic());
    deep.Read(fmt::format(R"({{"names": ["j"], "p": {{"{}": [1]}}}})", list));
    EXPECT_THAT(deep.columns(), ElementsAre(fmt::format("p_{}_j", list)));
  }
}

TEST(MessageRows, TellsColumnsOfTheSameNameApart) {
  MessageRows rows(JsonTopic());
  rows.Read(R"({"a b": 1, "a_b": 2, "a-b": 3, "time_s": 4})");
  EXPECT_THAT(rows.columns(), ElementsAre("a_b", "a_b_2", "a_b_3", "time_s_2"));
  EXPECT_THAT(rows.row(), ElementsAre(1, 2, 3, 4));
}

TEST(MessageRows, HasLimitsOfJson) {
  const auto list = [](int count) {
    std::string text = "[0";
    for (int i = 1; i < count; ++i) text += ",0";
    return text + "]";
  };
  EXPECT_EQ(ErrorOf([&] { MessageRows(JsonTopic()).Read(list(1000)); }), "");
  EXPECT_THAT(ErrorOf([&] { MessageRows(JsonTopic()).Read(list(1001)); }),
              HasSubstr("more than 1000 values"));
  EXPECT_THAT(
      ErrorOf([&] { MessageRows(JsonTopic()).Read(R"({"a": )" + list(1000) + R"(, "b": 1})"); }),
      HasSubstr("more than 1000 values"));
  const auto nested = [](int depth) {
    std::string text = "1";
    for (int i = 0; i < depth; ++i) text = "{\"a\": " + text + "}";
    return text;
  };
  EXPECT_EQ(ErrorOf([&] { MessageRows(JsonTopic()).Read(nested(32)); }), "");
  EXPECT_THAT(ErrorOf([&] { MessageRows(JsonTopic()).Read(nested(33)); }),
              HasSubstr("nested too deeply"));
}

TEST(ReadRos2Msg, RefusesWhatIsNoDefinition) {
  const auto error = [](const std::string& text) {
    return ErrorOf([&] { ReadRos2Msg("p/msg/T", text); });
  };
  EXPECT_THAT(error("float64\n"), HasSubstr("has a definition of p/T that is not of ROS 2"));
  for (const char* size : {"x", "3x", "-1"}) {
    EXPECT_THAT(error(fmt::format("float64[{}] a\n", size)), HasSubstr("that is not of ROS 2"));
  }
  EXPECT_EQ(error("string<=10 a\nstring<=5[<=2] b\nfloat64[3] c\n"), "");
  EXPECT_THAT(error("Other a\n"), HasSubstr("does not contain the definition of the type p/Other"));
  // Sixteen levels, and one more.
  const auto chain = [](int parts) {
    std::string text = "T1 a\n";
    for (int i = 1; i <= parts; ++i) {
      text += fmt::format("==========\nMSG: p/T{}\n", i);
      text += i < parts ? fmt::format("T{} a\n", i + 1) : "float64 a\n";
    }
    return text;
  };
  EXPECT_EQ(error(chain(16)), "");
  EXPECT_THAT(error(chain(17)), HasSubstr("nested too deeply"));
}

TEST(HasSignals, AreFloatingPointNumbersAndLists) {
  const auto has = [](const std::string& text, const std::string& type = "p/msg/T") {
    return HasSignals(ReadRos2Msg(type, text));
  };
  for (const char* text : {"float64 a\n", "float32 a\n", "int32[] a\n", "uint16[2] a\n",
                           "string s\nuint8 b\nfloat32 c\n",
                           "std_msgs/Header h\nPoint p\n=========="
                           "\nMSG: p/Point\nfloat64 x\n",
                           "uint64[] a\n"}) {
    EXPECT_TRUE(has(text)) << text;
  }
  for (const char* text : {"int32 a\n", "uint8[] a\n", "int8[] a\n", "bool[] a\n", "string[] a\n",
                           "std_msgs/Header h\n", "std_msgs/MultiArrayLayout l\n", "bool a\n",
                           "builtin_interfaces/Time[] a\n"}) {
    EXPECT_FALSE(has(text)) << text;
  }
  for (const char* type : {"Bool", "Int8", "UInt8", "Int64", "Float64", "Int32MultiArray"}) {
    EXPECT_TRUE(has("", "std_msgs/msg/" + std::string(type))) << type;
  }
  for (const char* type : {"String", "Empty", "Header", "UInt8MultiArray"}) {
    EXPECT_FALSE(has("", "std_msgs/msg/" + std::string(type))) << type;
  }
}

using Topics = std::vector<std::pair<std::string, std::string>>;

/// Topics with these names and types, each with two messages of JSON a second apart.
class Recorded : public MessageFile {
 public:
  explicit Recorded(const Topics& topics, const std::string& encoding = "json") {
    for (const auto& [name, type] : topics) {
      Topic topic;
      topic.name = name;
      topic.type = type;
      topic.encoding = encoding;
      topic.messages = 2;
      topic.first_ns = 1000000000;
      topic.last_ns = 3000000000;
      topics_.push_back(topic);
    }
  }
  void ForEachMessage(std::size_t topic, const Visit& visit) override {
    visit(1000000000, fmt::format("{{\"x\": {}}}", topic));
    visit(3000000000, fmt::format("{{\"x\": {}}}", topic));
  }
  void SetMessages(std::size_t topic, std::uint64_t count) { topics_[topic].messages = count; }
};

TEST(ListTopics, TakesTheOnlyOneWithSignals) {
  for (const char* other : {"rcl_interfaces/msg/Log", "diagnostic_msgs/msg/DiagnosticArray",
                            "rosgraph_msgs/msg/Clock", "tf2_msgs/msg/TFMessage", "foxglove.Log"}) {
    Recorded file(Topics{{"/other", other}, {"/hand", "p/msg/T"}});
    const std::vector<ListedTopic> topics = ListTopics(file, "");
    EXPECT_FALSE(topics[0].is_taken) << other;
    EXPECT_TRUE(topics[1].is_taken) << other;
    EXPECT_EQ(topics[1].rate_hz, 0.5);
  }
  Recorded two(Topics{{"/a", "p/T"}, {"/b", "p/T"}});
  EXPECT_EQ(QuestionOf(ListTopics(two, "")), "has several topics: /a, /b; --topic NAME takes one");
  for (const char* chosen : {"/b", "b"}) EXPECT_TRUE(ListTopics(two, chosen)[1].is_taken);
  two.SetMessages(0, 1);  // one message is no signal
  EXPECT_TRUE(ListTopics(two, "")[1].is_taken);
  EXPECT_EQ(ListTopics(two, "")[0].rate_hz, 0.0);
  Recorded none(Topics{{"/log", "foxglove.Log"}});
  EXPECT_EQ(QuestionOf(ListTopics(none, "")), "has no topic with signals that is read, but /log");
  Recorded unread(Topics{{"/a", "p/T"}}, "protobuf");
  EXPECT_EQ(QuestionOf(ListTopics(unread, "")),
            "has no topic with signals that is read, but /a (its messages are encoded as protobuf, "
            "not as cdr or json; write them as json)");
  Recorded unknown(Topics{{"/a", "p/T"}}, "");
  EXPECT_THAT(QuestionOf(ListTopics(unknown, "")), HasSubstr("encoded as nothing known"));
  EXPECT_EQ(QuestionOf({}), "has no topic");
  Topics many;
  for (int i = 0; i < 13; ++i) many.emplace_back(fmt::format("/t{}", i), "p/T");
  Recorded thirteen(many);
  EXPECT_THAT(QuestionOf(ListTopics(thirteen, "")), HasSubstr("/t10, /t11 and 1 more; --topic"));
  many.pop_back();
  Recorded twelve(many);
  EXPECT_THAT(QuestionOf(ListTopics(twelve, "")), HasSubstr("/t10, /t11; --topic"));
}

// Parts of one recording.
TEST(JoinMessageFiles, HasTheMessagesOfAllParts) {
  const auto joined = [](const std::string& first_type, const std::string& second_type) {
    std::vector<std::unique_ptr<MessageFile>> parts;
    parts.push_back(std::make_unique<Recorded>(Topics{{"/a", first_type}}));
    parts.push_back(std::make_unique<Recorded>(Topics{{"/b", "p/T"}, {"/a", second_type}}));
    return JoinMessageFiles(std::move(parts));
  };
  const std::unique_ptr<MessageFile> file = joined("p/T", "p/T");
  ASSERT_EQ(file->topics().size(), 2U);
  EXPECT_EQ(file->topics()[0].messages, 4U);
  EXPECT_EQ(file->topics()[1].messages, 2U);
  EXPECT_EQ(file->topics()[0].first_ns, 1000000000);
  EXPECT_EQ(file->topics()[0].last_ns, 3000000000);
  EXPECT_FALSE(file->is_cut());
  std::string seen;
  file->ForEachMessage(0, [&](std::int64_t, std::string_view data) { seen += data; });
  EXPECT_EQ(seen, R"({"x": 0}{"x": 0}{"x": 1}{"x": 1})");
  EXPECT_EQ(ErrorOf([&] { joined("p/T", "p/U"); }),
            "has several types of messages in the topic /a: p/T and p/U");
}

}  // namespace
}  // namespace gauntlet::sim
