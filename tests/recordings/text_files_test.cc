// Texts of other programs, as their formats define them: headers, shapes, and what is no number.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "sim/base/error.h"
#include "sim/recordings/table_source.h"
#include "sim/tables/array_files.h"
#include "sim/tables/csv_reader.h"
#include "sim/tables/file_format.h"
#include "sim/tables/opensim_files.h"
#include "sim/tables/text_forms.h"
#include "sim/tables/text_lines.h"
#include "tests/support/program.h"
#include "tests/support/table_text.h"

namespace gauntlet::sim {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::StartsWith;

class TextFiles : public testing::Test {
 protected:
  std::filesystem::path Write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_.path() / name, std::ios::binary) << text;
    return folder_.path() / name;
  }
  std::string Read(const std::string& text, const std::string& chosen = {}) const {
    return test::TextOf(TableSource(Write("in", text), chosen));
  }
  std::string ErrorOf(const std::string& text) const {
    try {
      Read(text);
    } catch (const UserError& error) {
      return error.what();
    }
    return "";
  }
  test::TemporaryDirectory folder_;
};

// --- Octave --------------------------------------------------------------------------------------

/// A variable as save_ascii writes it.
std::string Octave(const std::string& name, const std::string& type, const std::string& rest) {
  return "# name: " + name + "\n# type: " + type + "\n" + rest + "\n\n";
}

TEST_F(TextFiles, OfOctaveHaveMatricesScalarsAndRanges) {
  const std::string head = "# Created by Octave 7.3.0, Mon Jan 01 00:00:00 2024 UTC <a@b>\n";
  EXPECT_EQ(Read(head + Octave("t", "matrix", "# rows: 2\n# columns: 1\n 0\n 0.5\n") +
                 Octave("a", "matrix", "# rows: 2\n# columns: 2\n 1 2\n NaN -4\n") +
                 Octave("flag", "bool matrix", "# rows: 2\n# columns: 1\n 1\n 0\n")),
            "t,a_1,a_2,flag\n0,1,2,1\n0.5,nan,-4,0\n");
  // ndims stand before the values, which go by columns: element (i, j, k) is i + 2 j + 4 k.
  EXPECT_EQ(Read(Octave("x", "int32 matrix",
                        "# ndims: 3\n 2 2 3\n" + std::string("0\n1\n2\n3\n4\n5\n6\n7\n8\n9\n") +
                            "10\n11\n")),
            "x_1,x_2,x_3,x_4,x_5,x_6\n0,4,8,2,6,10\n1,5,9,3,7,11\n");
  // base, limit, increment.
  EXPECT_EQ(Read(Octave("up", "range", "# base, limit, increment\n0 1 0.25\n") +
                 Octave("down", "double_range", "# base, limit, increment\n4 0 -1\n")),
            "up,down\n0,4\n0.25,3\n0.5,2\n0.75,1\n1,0\n");
  EXPECT_EQ(Read(Octave("fs", "scalar", "50\n") +
                 Octave("a", "matrix", "# rows: 3\n# columns: 1\n 7\n 8\n 9\n")),
            "time_s,a\n0,7\n0.02,8\n0.04,9\n");
}

TEST_F(TextFiles, OfOctaveHaveCellsAndStructures) {
  const auto column = [](const std::string& name, const char* values) {
    return Octave(name, "matrix", std::string("# rows: 2\n# columns: 1\n") + values);
  };
  const std::string cells = "# name: c\n# type: cell\n# rows: 1\n# columns: 2\n" +
                            column("<cell-element>", "1\n2\n") + column("<cell-element>", "3\n4\n");
  EXPECT_THAT(ErrorOf(cells), HasSubstr("has 2 recordings in c: c_1 (2 x 1), c_2 (2 x 1)"));
  EXPECT_EQ(Read(cells, "c_2"), "c_2\n3\n4\n");
  // The cells of the next one begin at 1 again.
  const std::string two = cells + "# name: d\n# type: cell\n# rows: 1\n# columns: 1\n" +
                          column("<cell-element>", "5\n6\n");
  EXPECT_EQ(Read(two, "d_1"), "d_1\n5\n6\n");
  EXPECT_EQ(Read("# name: s\n# type: scalar struct\n# ndims: 2\n 1 1\n# length: 2\n" +
                 column("t", "0\n1\n") + column("a", "8\n9\n")),
            "t,a\n0,8\n1,9\n");
}

TEST_F(TextFiles, OfOctaveLeaveOutOrRefuseWhatIsNoRealNumber) {
  const std::string a = Octave("a", "matrix", "# rows: 2\n# columns: 1\n 7\n 8\n");
  for (const char* type :
       {"complex matrix", "complex scalar", "sparse matrix", "function handle"}) {
    EXPECT_EQ(Read(a + Octave("b", type, "# rows: 2\n# columns: 1\n(1,2)\n")),
              "a\n7\n8\n" + test::RemarkLine("left out: b (" + std::string(type) + ")"));
  }
  // Texts are no arrays that somebody misses, and empty ones are none.
  EXPECT_EQ(Read(a + Octave("b", "string", "# elements: 1\n# length: 3\nabc\n") +
                 Octave("none", "matrix", "# rows: 0\n# columns: 0\n")),
            "a\n7\n8\n");
  const auto matrix = [](const char* rest) { return Octave("m", "matrix", rest); };
  EXPECT_THAT(ErrorOf(matrix("# rows: 2\n# columns: 1\n 7\n x\n")),
              HasSubstr("is damaged: m has a value that is no number"));
  EXPECT_THAT(ErrorOf(matrix("# rows: -2\n# columns: 1\n 7\n")),
              HasSubstr("is damaged: m has a wrong size"));
  EXPECT_THAT(ErrorOf(matrix("# rows: 2\n# columns: 2\n 7\n 8\n 9\n")),
              HasSubstr("is damaged: m ends too early"));
  EXPECT_THAT(ErrorOf(matrix("# rows: 2\n# columns: 1\n 7\n 8\n 9\n")),
              HasSubstr("is damaged: m has another size than it says"));
  EXPECT_THAT(ErrorOf(matrix("# ndims: 3\n 2\n")), HasSubstr("is damaged: m ends too early"));
  EXPECT_THAT(ErrorOf(Octave("r", "range", "# base, limit, increment\n0 1\n")),
              HasSubstr("is damaged: r is no range"));
}

TEST(CountOfRange, HasBothEndsAndNoEndlessOnes) {
  EXPECT_EQ(CountOfRange(0.0, 1.0, 0.1), 11U);
  EXPECT_EQ(CountOfRange(0.0, 0.95, 0.1), 10U);
  EXPECT_EQ(CountOfRange(3.0, 3.0, 1.0), 1U);
  EXPECT_EQ(CountOfRange(5.0, 3.0, -0.5), 5U);
  EXPECT_EQ(CountOfRange(3.0, 5.0, -0.5), 0U);
  EXPECT_EQ(CountOfRange(0.0, 1.0, 0.0), 0U);
  EXPECT_EQ(CountOfRange(0.0, 1e9, 1.0), 0U);
  // The last number is never beyond the limit.
  EXPECT_THAT(RangeArray("r", 0.0, 0.3, 0.1, 4).values, ElementsAre(0.0, 0.1, 0.2, 0.3));
  EXPECT_THAT(RangeArray("r", 0.3, 0.0, -0.1, 4).values,
              ElementsAre(0.3, 0.3 - 0.1, 0.3 - 0.2, 0.3 - 3 * 0.1 < 0.0 ? 0.0 : 0.3 - 3 * 0.1));
}

// --- OpenSim -------------------------------------------------------------------------------------

TEST_F(TextFiles, OfOpenSimHaveTheUnitThatTheirHeaderSays) {
  const auto names = [&](const std::string& header) {
    const std::string table = Read(header +
                                   "endheader\ntime\tindex_mcp\tFFJ3\tleft_wrist\tload\n"
                                   "0\t1\t2\t3\t4\n1\t2\t3\t4\t5\n");
    return table.substr(0, table.find('\n'));
  };
  const std::string deg = "time,index_mcp_deg,FFJ3_deg,left_wrist_deg,load";
  const std::string rad = "time,index_mcp_rad,FFJ3_rad,left_wrist_rad,load";
  const std::string none = "time,index_mcp,FFJ3,left_wrist,load";
  EXPECT_EQ(names("inDegrees=yes\n"), deg);
  EXPECT_EQ(names("inDegrees = Y\n"), deg);
  EXPECT_EQ(names("in_degrees\ttrue\n"), deg);
  EXPECT_EQ(names("inDegrees=no\n"), rad);
  EXPECT_EQ(names("inDegrees=n\n"), rad);
  EXPECT_EQ(names("inDegrees=FALSE\n"), rad);
  EXPECT_EQ(names("Angles are in degrees.\n"), deg);
  EXPECT_EQ(names("Angles are in radians.\n"), rad);
  EXPECT_EQ(names("inDegrees=no\nAngles are in degrees.\n"), rad);  // a sentence for both kinds
  EXPECT_EQ(names("name hand.mot\n"), none);
  EXPECT_THAT(ErrorOf("nRows=2\ninDegrees=maybe\nendheader\ntime\ta\n0\t1\n"),
              HasSubstr(":2: inDegrees is 'maybe', must be yes or no"));
  EXPECT_THAT(ErrorOf("\nnRows=two\nendheader\ntime\ta\n0\t1\n"),
              HasSubstr(":2: nRows is 'two', must be a whole number"));
}

TEST_F(TextFiles, OfOpenSimHaveTheirUnitForJointsAlone) {
  const std::string table = Read(
      "inDegrees=yes\nendheader\n"
      "time\twrist_flex\tr_thumb_ip\tthumb_abd\tpip\tleft\telbow\tindex_force\thand_x\n"
      "0\t1\t2\t3\t4\t5\t6\t7\t8\n1\t1\t2\t3\t4\t5\t6\t7\t8\n");
  EXPECT_THAT(table, StartsWith("time,wrist_flex,r_thumb_ip_deg,thumb_abd_deg,pip,left,elbow_deg,"
                                "index_force,hand_x\n"));
}

TEST_F(TextFiles, OfOpenSimHaveAColumnForEachNumberOfAVector) {
  const auto table = [&](const std::string& kind, const std::string& cells) {
    return Read("DataType=" + kind + "\nendheader\ntime\timu\n0\t" + cells + "\n1\t" + cells +
                "\n");
  };
  EXPECT_EQ(table("Vec3", "1,2,3"), "time,imu_x,imu_y,imu_z\n0,1,2,3\n1,1,2,3\n");
  EXPECT_EQ(table("Quaternion", "1,2,3,4"), "time,imu_w,imu_x,imu_y,imu_z\n0,1,2,3,4\n1,1,2,3,4\n");
  EXPECT_EQ(table("Vec2", "1, 2"), "time,imu_1,imu_2\n0,1,2\n1,1,2\n");
  // A cell with another count of numbers, or with none, has none.
  EXPECT_EQ(Read("DataType=Vec2\nendheader\ntime\timu\tb\n0\t1,2\t8\n1\t1\t9\n2\t5,x\t9\n"),
            "time,imu_1,imu_2,b\n0,1,2,8\n1,nan,nan,9\n2,5,nan,9\n");
}

TEST_F(TextFiles, OfOpenSimAreCutWhereRowsAreMissing) {
  const std::string rows = "endheader\ntime\ta\n0\t1\n1\t2\n2\t3";
  for (const char* key : {"nRows=", "datarows ", "nr="}) {
    EXPECT_EQ(Read(key + ("5\n" + rows)),
              "time,a\n0,1\n1,2\n" +
                  test::RemarkLine("the header says 5 rows, the file has 2, which are read"))
        << key;
  }
  EXPECT_EQ(Read("nRows=3\n" + rows), "time,a\n0,1\n1,2\n2,3\n");
  EXPECT_EQ(Read("nRows=2\n" + rows + "\n"),
            "time,a\n0,1\n1,2\n" +
                test::RemarkLine("the header says 2 rows, the file has 3, which are read") +
                "2,3\n");
}

TEST_F(TextFiles, OfMarkersHaveThreeColumnsForEach) {
  const auto trc = [](const std::string& unit, const std::string& names, const std::string& axes) {
    return "PathFileType\t4\t(X/Y/Z)\ta.trc\nDataRate\tCameraRate\tNumFrames\tNumMarkers\tUnits\n"
           "100\t100\t2\t2\t" +
           unit + "\nFrame#\tTime\t" + names + "\n\t\t" + axes +
           "\n\n1\t0\t1\t2\t3\t4\t5\t6\n2\t0.01\t7\t8\t9\t\t\t12\n";
  };
  const std::string names = "Wrist\t\t\tTip\t\t\t", axes = "X1\tY1\tZ1\tX2\tY2\tZ2\t";
  for (const std::string unit : {"m", "cm", "mm", "inch", ""}) {
    const std::string end = unit == "inch" || unit.empty() ? "" : "_" + unit;
    std::string header = "Frame#,Time";
    for (const char* marker : {"Wrist", "Tip"}) {
      for (const char axis : {'x', 'y', 'z'}) {
        header += std::string(",") + marker + "_" + axis + end;
      }
    }
    const std::string shown = unit == "inch" ? "'inch'" : unit.empty() ? "unknown unit" : unit;
    EXPECT_THAT(Read(trc(unit, names, axes)),
                testing::AllOf(StartsWith(header + "\n1,0,1,2,3,4,5,6\n2,0.01,7,8,9,nan,nan,12\n"),
                               HasSubstr("2 markers [")))
        << unit;
  }
  EXPECT_THAT(ErrorOf(trc("mm", names, "X1\tY1\tZ1\tX2\tY2")),
              HasSubstr(":4: has 2 names of markers above 5 components, must have 3 for each"));
  EXPECT_EQ(ReadTrcHeader("a", trc("mm", names, axes)).rows, 2);
}

// --- rostopic echo -------------------------------------------------------------------------------

std::string Echo(int k, const std::string& rest = {}) {
  return "header:\n  stamp:\n    sec: 10\n    nanosec: " + std::to_string(500000000 * k) +
         "\n  frame_id: base\nname:\n- a\n- b\nposition:\n- " + std::to_string(k) +
         "\n- 0.5\nvelocity: []\neffort: []\n" + rest + "---\n";
}

TEST_F(TextFiles, OfTopicEchoAreItsMessages) {
  EXPECT_EQ(Read(Echo(0) + Echo(1)), "time_s,a_rad,b_rad\n10,0,0.5\n10.5,1,0.5\n");
  // A last message without its end is none.
  const std::string cut = Echo(0) + Echo(1) + Echo(2);
  EXPECT_EQ(Read(cut.substr(0, cut.size() - 4)), "time_s,a_rad,b_rad\n10,0,0.5\n10.5,1,0.5\n");
  EXPECT_TRUE(OpenTable(folder_.path() / "in").topics[0].is_cut);
  EXPECT_EQ(OpenTable(Write("arm.txt", Echo(0) + Echo(1))).topics[0].name, "arm");
}

TEST_F(TextFiles, OfTopicEchoHaveEveryKindOfValue) {
  const auto message = [](const std::string& sec, const std::string& nsec, const char* value) {
    return "header:\n  stamp:\n    " + sec + ": 3\n    " + nsec + ": 250000000\nvalue: " + value +
           "\n---\n";
  };
  for (const auto& [text, number] : {std::pair("7", "7"),
                                     {"-2.5", "-2.5"},
                                     {"1e3", "1000"},
                                     {"true", "1"},
                                     {"False", "0"},
                                     {".nan", "nan"},
                                     {"-.inf", "nan"},
                                     {"inf", "nan"}}) {
    EXPECT_EQ(Read(message("sec", "nanosec", text) + message("secs", "nsecs", "7")),
              std::string("time_s,value\n3.25,") + number + "\n3.25,7\n")
        << text;
  }
  // In quotes it is a text.
  EXPECT_EQ(Read(message("sec", "nanosec", "8\nnote: '7'") + message("sec", "nanosec", "8")),
            "time_s,value\n3.25,8\n3.25,8\n");
  EXPECT_THAT(
      ErrorOf(message("sec", "nanosec", "\n- 1\n- '...'\n- 2") + message("sec", "nanosec", "8")),
      HasSubstr("has shortened lists; ros2 topic echo --full-length writes whole ones"));
  EXPECT_THAT(ErrorOf(message("sec", "nanosec", "8") + message("sec", "nanosec", "[1, 2")),
              HasSubstr("is damaged: message 2 is no YAML"));
  EXPECT_THAT(ErrorOf("value: 1\n---\nvalue: 2\n---\n"),
              HasSubstr("has messages without a time in a header"));
}

TEST(FormatOfBytes, KnowsTheTextOfTopicEcho) {
  for (const char* text : {"a: 1\n---\na: 2\n---\n", "a:\n  b: 1\n- 2\n---\na:\n",
                           "\na_b2: 1\n\n---\n\na_b2: 2\n", "header:\n  stamp:\n    sec: 1\n"}) {
    EXPECT_EQ(FormatOfBytes(text), FileFormat::kRosEcho) << text;
  }
  for (const char* text :
       {"a: 1\n---\nb: 2\n---\n", "a: 1\nb: 2\n", "1a: 1\n---\n1a: 2\n", "a b: 1\n---\na b: 2\n",
        "a:1\n---\na:1\n", " a: 1\n---\n a: 1\n", "a: 1\nnoise\n---\na: 2\n",
        "other:\n  stamp:\n    sec: 1\n", "header:\n  time:\n    sec: 1\n"}) {
    EXPECT_EQ(FormatOfBytes(text), FileFormat::kText) << text;
  }
}

// --- A text that comes line by line --------------------------------------------------------------

/// Gives a line at a time, as a serial port does.
TextLines::Source LineByLine(const std::string& text) {
  return [rest = text](char* buffer, std::size_t size) mutable {
    const std::size_t count = std::min({size, rest.find('\n') + 1, rest.size()});
    rest.copy(buffer, count);
    rest.erase(0, count);
    return count;
  };
}

// Whatever the first lines decide, the rows are those of the whole file.
TEST(PlainStream, HasTheRowsOfTheWholeText) {
  for (const std::string text : {
           "a: 1, b: 2\na: 3, b: 4\na: 5, b: -6.5\na: 7, b: 8\nb: 1\na: 9, b: 9\n",
           "10:15:00.0 -> 300 4\n10:15:00.1 -> 301 5\n10:15:00.2 -> 302 6\n10:15:00.3 -> 303 7\n"
           "noise\n10:15:00.4 -> 304 8\n",
           "I (1020) GLOVE: 300,4\nI (1040) GLOVE: 301,5\nI (1060) GLOVE: 302,6\n"
           "I (1080) GLOVE: 303,7\n",
           "A100B200C3\nA101B201C4\nA102B202C5\nA103B203C6\nnoise\nA104B204C7\n",
           ",action,t\n0,[1.5 -2.],0.1\n1,[3 4],0.2\n2,[5\n 6],0.3\n",
           "1762000000,400000095,base,j1,j2,0.1,0.2,9,8\n"
           "1762000000,410000086,base,j1,j2,0.3,0.4,7,6\n",
           "t,a\n0,1\n1,2\n",
           "0,1\n1,2\n2,3\n",
       }) {
    const LiveTable live = PlainStream("in", LineByLine(text));
    EXPECT_EQ(BytesOf(live.source), BytesOf(PlainTable(TextSource(text)))) << text;
    if (live.left_out) {
      EXPECT_EQ(*live.left_out,
                text.find("noise") != text.npos || text.find("\nb: 1") != text.npos ? 1U : 0U)
          << text;
    }
  }
  EXPECT_EQ(BytesOf(PlainStream("in", LineByLine("")).source), "");
}

/// Only as many lines are waited for as decide.
TEST(PlainStream, WaitsForNoMoreLinesThanItNeeds) {
  const auto lines_of = [](const std::string& text) {
    std::size_t calls = 0;
    PlainStream("in", [source = LineByLine(text), &calls](char* buffer, std::size_t size) mutable {
      ++calls;
      return source(buffer, size);
    });
    return calls;
  };
  EXPECT_EQ(lines_of("0,1\n1,2\n2,3\n3,4\n4,5\n5,6\n"), 1U);
  EXPECT_EQ(lines_of("t,a\n1,2\n2,3\n3,4\n4,5\n5,6\n"), 2U);
  EXPECT_EQ(lines_of("a: 1\na: 2\na: 3\na: 4\na: 5\na: 6\n"), 4U);
  EXPECT_EQ(lines_of("PathFileType\t4\na\nb\nc\nd\ne\nf\ng\nh\n"), 6U);
}

TEST(PlainTable, TakesTheTimeOfALogOff) {
  const auto plain = [](const std::string& text) { return BytesOf(PlainTable(TextSource(text))); };
  const std::string table = "time,a,b\n1.020,1,2\n1.040,3,4\n1.060,5,6\n";
  EXPECT_EQ(plain("I (1020) G: a=1 b=2\nI (1040) G: a=3 b=4\nI (1060) G: a=5 b=6\n"), table);
  EXPECT_EQ(plain("\x1b[0;32mI (1020) G: a=1 b=2\x1b[0m\n\x1b[0;32mI (1040) G: a=3 b=4\x1b[0m\n"
                  "\x1b[0;32mI (1060) G: a=5 b=6\x1b[0m\n"),
            table);
  for (const char* level : {"E", "W", "D", "V"}) {
    std::string text = "I (1020) G: a=1 b=2\nI (1040) G: a=3 b=4\nI (1060) G: a=5 b=6\n";
    for (char& letter : text) letter = letter == 'I' ? *level : letter;
    EXPECT_EQ(plain(text), table);
  }
  // With another letter, without its brackets or its tag it is none.
  for (const std::string head : {"X (1020) G: ", "I 1020 G: ", "I (x) G: ", "I (1020 G: "}) {
    const std::string text = head + "a=1\n" + head + "a=3\n" + head + "a=5\n";
    EXPECT_EQ(plain(text), text) << head;
  }
}

}  // namespace
}  // namespace gauntlet::sim
