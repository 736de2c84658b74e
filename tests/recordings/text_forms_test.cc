// Texts whose rows are no plain rows of numbers become tables.
#include "sim/tables/text_forms.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

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
  std::string wide;  // a hundred columns and more rows than any hand has channels
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
  const std::string other = "5,400000095,base,j1,0.1\n5,410000086,base,j1,0.3\n";
  EXPECT_EQ(PlainOf(other), other);  // no stamp of this century
}

}  // namespace
}  // namespace gauntlet::sim
