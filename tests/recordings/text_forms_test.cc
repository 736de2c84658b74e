// Texts whose rows are no plain rows of numbers become tables.
#include "sim/tables/text_forms.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "sim/tables/csv_reader.h"
#include "sim/tables/text_lines.h"

namespace gauntlet::sim {
namespace {

using testing::StartsWith;

std::string PlainOf(const std::string& text) { return BytesOf(PlainTable(TextSource(text))); }

TEST(PlainTable, TakesLabelsOutOfCells) {
  EXPECT_EQ(PlainOf("10:15:00.0 -> Thumb:300\tIndex:298\n"
                    "10:15:00.5 -> Thumb:301\tIndex:299\n"
                    "noise\n"
                    "10:15:01.0 -> Thumb:302\tIndex:300\n"),
            "time,Thumb,Index\n10:15:00.0,300,298\n10:15:00.5,301,299\n# noise\n"
            "10:15:01.0,302,300\n");
  EXPECT_EQ(PlainOf("a: 1, b: 2\na: 3, b: 4\na: 5, b: -6.5\n"), "a,b\n1,2\n3,4\n5,-6.5\n");
  const std::string rows = "10:15:00.0,1\n10:15:00.5,2\n10:15:01.0,3\n";  // clocks have colons, too
  EXPECT_EQ(PlainOf(rows), rows);
}

TEST(PlainTable, TakesTheClockOffThatASerialMonitorWrites) {
  EXPECT_EQ(PlainOf("10:15:00.000 -> flex1,flex2\n10:15:00.020 -> 300,4\n10:15:00.040 -> 301,5\n"
                    "10:15:00.060 -> 302\n10:15:00.080 -> 303,7\n"),
            "time,flex1,flex2\n10:15:00.020,300,4\n10:15:00.040,301,5\n# 10:15:00.060 -> 302\n"
            "10:15:00.080,303,7\n");
  EXPECT_EQ(PlainOf("10:15:00.000 -> 300 4\n10:15:00.020 -> 301 5\n10:15:00.040 -> 302 6\n"),
            "time,value_1,value_2\n10:15:00.000,300,4\n10:15:00.020,301,5\n10:15:00.040,302,6\n");
}

TEST(PlainTable, TakesOtherClocksOff) {
  EXPECT_EQ(PlainOf("[2024-03-01 10:15:00.02] 3,4\n[2024-03-01 10:15:00.04] 3,5\n"
                    "[2024-03-01 10:15:00.06] 2,6\n"),
            "time,value_1,value_2\n2024-03-01 10:15:00.02,3,4\n2024-03-01 10:15:00.04,3,5\n"
            "2024-03-01 10:15:00.06,2,6\n");
  EXPECT_EQ(PlainOf("12.02 -> 3 4\n12.04 -> 3 5\n12.06 -> 2 6\n"),
            "time,value_1,value_2\n12.02,3,4\n12.04,3,5\n12.06,2,6\n");
}

TEST(PlainTable, SpreadsListsOverColumns) {
  EXPECT_EQ(PlainOf(",action,t\n0,[1.5  -2. ],0.1\n1,\"[3, 4]\",0.2\n2,[ 5.\n 6.],0.3\n"),
            ",action_1,action_2,t\n0,1.5,-2.,0.1\n1,3,4,0.2\n2,5.,6.,0.3\n");
  EXPECT_EQ(PlainOf("t,a\n0,[1 2]\n1,[1 2 3]\n2,[3 4]\n"),
            "t,a_1,a_2\n0,1,2\n# 1,[1 2 3]\n2,3,4\n");
}

TEST(PlainTable, JoinsListsOverLinesUpToALimit) {
  const auto list = [](int lines) {
    std::string text = "t,a\n0,[1";
    for (int i = 0; i < lines; ++i) text += "\n 2";
    return text + "]\n";
  };
  const std::string joined = PlainOf(list(64));
  EXPECT_THAT(joined, StartsWith("t,a_1,a_2,"));
  EXPECT_EQ(std::ranges::count(joined, '\n'), 2);
  EXPECT_EQ(PlainOf(list(65)), list(65));
  // The bracket of a colour opens no list.
  EXPECT_EQ(PlainOf("t,a\n\x1b[0m,1\n0,2\n"), "t,a\n\x1b[0m,1\n0,2\n");
}

// The form of most lines, and of three at least.
TEST(PlainTable, NeedsThreeLinesAndHalfOfAll) {
  const auto is_plain = [](const std::string& line, int fitting, int others) {
    std::string text;
    for (int i = 0; i < fitting; ++i) text += line + "\n";
    for (int i = 0; i < others; ++i) text += "noise\n";
    return PlainOf(text) != text;
  };
  for (const char* line : {"a:1 b:2", "10:15:00 -> 1,2", "A100B200"}) {
    EXPECT_TRUE(is_plain(line, 3, 0)) << line;
    EXPECT_FALSE(is_plain(line, 2, 0)) << line;
    EXPECT_TRUE(is_plain(line, 4, 4)) << line;
    EXPECT_FALSE(is_plain(line, 4, 5)) << line;
  }
}

TEST(PlainTable, TakesClocksBeforeLabelsOff) {
  const std::string plain = "time,a,b\n12:00:01,1,2\n12:00:02,3,4\n12:00:03,5,6\n";
  for (const char* form :
       {"{} -> a:{} b:{}", "{} - a:{}, b:{}", "[{}] a={};b={}", "{} | a: {}\tb: {}"}) {
    std::string text;
    for (int i = 1; i <= 3; ++i) {
      text += fmt::format(fmt::runtime(form), fmt::format("12:00:0{}", i), 2 * i - 1, 2 * i) + "\n";
    }
    EXPECT_EQ(PlainOf(text), plain) << form;
  }
  // A label begins with a letter, and its value is a number.
  for (const char* cell : {":1", "1a:1", "a:x", "a:", "a"}) {
    const std::string line = std::string(cell) + " b:2\n", text = line + line + line;
    EXPECT_EQ(PlainOf(text), text) << cell;
  }
}

TEST(PlainTable, NamesListsAsIsKnown) {
  const std::string text = "action,state\n[1 2],[3 4]\n[5 6],[7 8]\n";
  const ListNames known = {{"action", {"wrist.pos", "elbow"}}, {"state", {"one"}}};
  EXPECT_EQ(BytesOf(PlainTable(TextSource(text), known)),
            "action.wrist.pos,action.elbow,state_1,state_2\n1,2,3,4\n5,6,7,8\n");
}

TEST(PlainTable, TurnsARowPerChannel) {
  std::string channels, turned;
  for (int row = 0; row < 2; ++row) {
    channels += "0";
    for (int i = 1; i < 100; ++i) channels += "," + std::to_string(100 * row + i);
    channels += "\n";
  }
  for (int i = 1; i < 100; ++i) {
    turned += std::to_string(i) + "," + std::to_string(100 + i) + "\n";
  }
  EXPECT_EQ(PlainOf(channels), turned);  // the zeros in front are an index
  EXPECT_THAT(PlainOf("a," + channels.substr(2)), StartsWith("a,0\n1,101\n"));
  // Names stand in front of each row; 64 rows at most, and more than twice as many columns.
  const auto row_of = [](const std::string& name, int columns) {
    std::string row = name;
    for (int i = 1; i < columns; ++i) row += "," + std::to_string(i);
    return row + "\n";
  };
  EXPECT_THAT(PlainOf(row_of("a", 66) + row_of("b", 66)), StartsWith("a,b\n1,1\n2,2\n"));
  std::string many;
  for (int row = 0; row < 64; ++row) many += row_of("1", 129);
  EXPECT_EQ(std::ranges::count(PlainOf(many), '\n'), 129);
  EXPECT_EQ(PlainOf(many + row_of("1", 129)), many + row_of("1", 129));
  for (const std::string& text :
       {row_of("1", 64) + row_of("1", 64), row_of("1", 100), row_of("1", 100) + row_of("1", 99)}) {
    EXPECT_EQ(PlainOf(text), text);
  }
  std::string nearly;
  for (int row = 0; row < 50; ++row) nearly += row_of("1", 100);
  EXPECT_EQ(PlainOf(nearly), nearly);  // not more than twice as many
  std::string wide;                    // a hundred columns and more rows than any hand has channels
  for (int row = 0; row < 70; ++row) wide += channels.substr(0, channels.find('\n') + 1);
  EXPECT_EQ(PlainOf(wide), wide);
}

TEST(PlainTable, NamesPositionsOfRostopicEcho) {
  EXPECT_EQ(PlainOf("%time,field.header.seq,field.name0,field.name1,field.position0,"
                    "field.position1,field.velocity0\n"
                    "1500000000000000000,1,index_mcp,thumb_ip,0.1,0.2,9\n"
                    "1500000000010000000,2,index_mcp,thumb_ip,0.3,0.4,8\n"
                    "1500000000020000000,3,thumb_ip,index_mcp,0.5,0.6,7\n"),
            "%time,field.header.seq,index_mcp_rad,thumb_ip_rad,index_mcp_velocity\n"
            "1500000000000000000,1,0.1,0.2,9\n1500000000010000000,2,0.3,0.4,8\n"
            "# 1500000000020000000,3,thumb_ip,index_mcp,0.5,0.6,7\n");
}

TEST(PlainTable, ReadsTheAlphaEncodingOfOpengloves) {
  EXPECT_EQ(PlainOf("A100B200C300D400E500F2048G2047P0(AB)7(BB)9\n"
                    "A101B201C301D401E501F2048G2047P5IL\n"
                    "A102B202C302\n"
                    "A103B203C303D403E503F2048G2047P5(AB)7\n"),
            "thumb,index,middle,ring,little,joystick_x,joystick_y,trigger\n"
            "100,200,300,400,500,2048,2047,0\n101,201,301,401,501,2048,2047,5\n"
            "# A102B202C302\n103,203,303,403,503,2048,2047,5\n");
  const std::string words = "AB\nCD\nEF\nGH\n";  // no numbers
  EXPECT_EQ(PlainOf(words), words);
}

TEST(PlainTable, ReadsJointStates) {
  EXPECT_EQ(PlainOf("1762000000,400000095,base,j1,j2,0.1,0.2,9,8\n"
                    "1762000000,410000086,base,j1,j2,0.3,0.4,7,6\n"),
            "sec,nanosec,j1_rad,j2_rad,j1_velocity,j2_velocity\n"
            "1762000000,400000095,0.1,0.2,9,8\n1762000000,410000086,0.3,0.4,7,6\n");
  EXPECT_EQ(PlainOf("1762000000,400000095,,j1,j2_deg,0.1,0.2,,9,8\n"  // frame and velocity empty
                    "1762000000,410000086,,j1,j2_deg,0.3,0.4,,7,6\n"
                    "1762000000,420000086,,j1,j2_deg,0.3,0.4,7,6,\n"),
            "sec,nanosec,j1_rad,j2_deg,j1_effort,j2_deg_effort\n"
            "1762000000,400000095,0.1,0.2,9,8\n1762000000,410000086,0.3,0.4,7,6\n"
            "# 1762000000,420000086,,j1,j2_deg,0.3,0.4,7,6,\n");
  // Stamps of other centuries, nanoseconds of more than a second, and other counts of numbers.
  for (const char* row :
       {"5,400000095,base,j1,0.1", "499999999,5,base,j1,0.1", "10000000000,5,base,j1,0.1",
        "1762000000,1000000000,base,j1,0.1", "1762000000,-1,base,j1,0.1",
        "1762000000,5,base,j1,j2,0.1", "1762000000,5,base,j1,j2,0.1,0.2,0.3",
        "1762000000,5,base,j1", "1762000000,5,base,j1,0.1,0.2,0.3,0.4",
        "1762000000,5,base,j1,0.1,x", "1762000000,5,base,j1,,,"}) {
    const std::string text = std::string(row) + "\n" + row + "\n";
    EXPECT_EQ(PlainOf(text), text);
  }
  EXPECT_EQ(PlainOf("500000000,0,base,j1,0.1\n9999999999,999999999,base,j1,0.3\n"),
            "sec,nanosec,j1_rad\n500000000,0,0.1\n9999999999,999999999,0.3\n");
  EXPECT_EQ(PlainOf("1762000000,0,,j1,0.1,0.2,0.3\n1762000001,0,,j1,0.4,0.5,0.6\n"),
            "sec,nanosec,j1_rad,j1_velocity,j1_effort\n1762000000,0,0.1,0.2,0.3\n"
            "1762000001,0,0.4,0.5,0.6\n");
}

}  // namespace
}  // namespace gauntlet::sim
