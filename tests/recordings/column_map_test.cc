// The language of column maps, and the times that others write.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "sim/base/channels.h"
#include "sim/base/error.h"
#include "sim/base/signal.h"
#include "sim/recordings/profile.h"
#include "sim/recordings/recording_reader.h"
#include "sim/tables/time_columns.h"
#include "tests/support/program.h"
#include "tests/support/source_dir.h"

namespace gauntlet::sim {
namespace {

using testing::HasSubstr;

struct Row {
  double time_s;
  std::vector<double> angle_deg;  // of KnownChannels()
  double operator[](const char* channel) const { return angle_deg[ChannelIndex(channel)]; }
};

RecordingFormat At100Hz() {
  RecordingFormat format;
  format.rate_hz = 100.0;
  return format;
}

class ColumnMaps : public testing::Test {
 protected:
  /// Rows of `text` as `map` has them.
  std::vector<Row> Read(const std::string& text, const std::string& map,
                        RecordingFormat format = {}) const {
    format.map = (folder_.path() / "map.csv").string();
    std::ofstream(format.map) << map;
    RecordingReader reader("in.csv", TextSource(text), format);
    std::vector<Row> rows;
    Row row{.time_s = 0.0, .angle_deg = std::vector<double>(KnownChannels().size())};
    while (reader.NextRow(row.time_s, row.angle_deg)) {
      rows.push_back(row);
      for (double& angle : rows.back().angle_deg) angle *= kDegPerRad;
    }
    return rows;
  }
  std::string MapFile() const { return (folder_.path() / "map.csv").string(); }
  std::string ErrorOf(const std::string& text, const std::string& map) const {
    try {
      Read(text, map, At100Hz());
    } catch (const std::exception& error) {
      return error.what();
    }
    return "";
  }

 private:
  test::TemporaryDirectory folder_;
};

TEST_F(ColumnMaps, UndoJumpsOfAngles) {
  const auto rows =
      Read("350\n359\n5\n20\n350\n340\n",
           "column,channel,unit,offset,wraps_at\n1,wrist_flexion,deg,-360,360\n", At100Hz());
  std::vector<double> angles_deg;
  for (const Row& row : rows) angles_deg.push_back(std::round(row["wrist_flexion"]));
  EXPECT_THAT(angles_deg, testing::ElementsAre(-10.0, -1.0, 5.0, 20.0, -10.0, -20.0));
}

TEST_F(ColumnMaps, GoOnOverMidnight) {
  const std::string map = "column,channel,unit\n1,time,date\n2,index_mcp,deg\n";
  const auto times_s = [&](const std::string& text) {
    std::vector<double> times;
    RecordingFormat format;
    format.handling = ProblemHandling::kRepair;
    for (const Row& row : Read(text, map, format)) times.push_back(row.time_s);
    return times;
  };
  EXPECT_THAT(
      times_s("23:59:59.98,1\n23:59:59.99,2\n00:00:00.01,3\n00:00:00.02,4\n"),
      testing::Pointwise(testing::DoubleNear(1e-6), {86399.98, 86399.99, 86400.01, 86400.02}));
  // A clock that starts anew elsewhere goes on by a usual step.
  EXPECT_THAT(
      times_s("22:00:00.00,1\n22:00:00.01,2\n10:00:00.00,3\n10:00:00.01,4\n"),
      testing::Pointwise(testing::DoubleNear(1e-6), {79200.00, 79200.01, 79200.02, 79200.03}));
}

TEST_F(ColumnMaps, TakeTheRowsOfOneHand) {
  const std::string text =
      "time,hand,bend\n0,Left,1\n0,Right,2\n1,left_hand,3\n1,R,4\n2,,5\n2,\"right\",6\n3,both,7\n";
  const auto bends = [&](const char* side) {
    std::vector<double> angles_deg;
    RecordingFormat format;
    format.longest_gap_ms = 1500.0;
    for (const Row& row :
         Read(text, std::string("column,channel\ntime,time\nhand,") + side + "\nbend,index_mcp\n",
              format)) {
      angles_deg.push_back(std::round(row["index_mcp"]));
    }
    return angles_deg;
  };
  EXPECT_THAT(bends("left"), testing::ElementsAre(1.0, 3.0));
  EXPECT_THAT(bends("right"), testing::ElementsAre(2.0, 4.0, 6.0));
  EXPECT_THAT(ErrorOf("1,2,3\n", "column,channel\n1,left\n2,right\n3,index_mcp\n"),
              HasSubstr("one column alone may name the hand"));
  EXPECT_THAT(ErrorOf("1,2,3\n", "column,channel\n1,left\n"), HasSubstr("names no channel"));
  std::ofstream(MapFile()) << "column,channel\n1,left\n2,index_mcp\n";
  EXPECT_THROW(ReadColumnMap(MapFile(), {.name = "a stream", .count = 2}), UserError);
}

TEST_F(ColumnMaps, TellWhatTheyAssume) {
  const std::string map =
      "column,channel,unit,assumed\n1,index_mcp,deg,joint unit\n2,index_pip,deg,\n3,ring_pip,deg,"
      "joint unit\n";
  const auto assumed = [this](const std::string& rows_of_map) {
    Read("1,2,3\n2,3,4\n", rows_of_map, At100Hz());
    RecordingFormat format = At100Hz();
    format.map = MapFile();
    return RecordingReader("in.csv", TextSource("1,2,3\n"), format).Remarks();
  };
  EXPECT_THAT(assumed(map),
              testing::ElementsAre(HasSubstr(
                  "in.csv: assumed: joint and unit of index_mcp, ring_pip (to confirm: the row")));
  EXPECT_THAT(assumed(map + "all,confirmed,,\n"), testing::IsEmpty());
  EXPECT_THAT(ErrorOf("1\n2\n", "column,channel,assumed\n1,index_mcp,wrong\n"),
              HasSubstr("map.csv:2:3: 'wrong' must be one of: joint, unit, sign, range, rate"));
}

TEST_F(ColumnMaps, TakeTwoPointsOfAnyUnitToTwoAngles) {
  const std::vector<Row> rows =
      Read("a,b\n312,2.41\n539,1.765\n766,1.12\n",
           "column,channel,unit,raw_low,raw_high,deg_low,deg_high\n"
           "a,index_pip,counts,312,766,0,90\nb,middle_pip,volts,2.41,1.12,10,70\n",
           At100Hz());
  ASSERT_EQ(rows.size(), 3U);
  for (int k = 0; k < 3; ++k) {
    EXPECT_NEAR(rows[k]["index_pip"], 45.0 * k, 1e-9);
    EXPECT_NEAR(rows[k]["middle_pip"], 10.0 + 30.0 * k, 1e-9);
  }
}

TEST_F(ColumnMaps, TakeTwoPointsToTheJointsRangeByDefault) {
  const std::vector<Row> rows =
      Read("a\n-1\n3\n", "column,channel,raw_low,raw_high\n1,thumb_ip,-1,3\n", At100Hz());
  EXPECT_NEAR(rows[0]["thumb_ip"], -15.0, 1e-9);
  EXPECT_NEAR(rows[1]["thumb_ip"], 80.0, 1e-9);
}

TEST_F(ColumnMaps, TakeCountsOfEachColumnsBits) {
  const std::vector<Row> rows = Read("a,b\n409.5,6553.5\n3685.5,58981.5\n",
                                     "column,channel,unit,bits\na,index_pip,counts,12\n"
                                     "b,middle_pip,counts,16\n",
                                     At100Hz());
  for (const char* channel : {"index_pip", "middle_pip"}) {
    EXPECT_NEAR(rows[0][channel], 0.0, 1e-9);
    EXPECT_NEAR(rows[1][channel], 100.0, 1e-9);
  }
}

TEST_F(ColumnMaps, AddSeveralColumnsWithTheirWeights) {
  RecordingFormat repaired = At100Hz();
  repaired.handling = ProblemHandling::kRepair;
  const std::vector<Row> rows = Read("a,b\n10,30\n20,\n",
                                     "column,channel,unit,weight\na,index_pip,deg,0.25\n"
                                     "b,index_pip,deg,0.75\na,index_mcp,deg,\n",
                                     repaired);
  EXPECT_NEAR(rows[0]["index_pip"], 25.0, 1e-9);
  EXPECT_NEAR(rows[0]["index_mcp"], 10.0, 1e-9);
  EXPECT_TRUE(std::isnan(rows[1]["index_pip"]));  // a part is missing
  EXPECT_NEAR(rows[1]["index_mcp"], 20.0, 1e-9);
}

TEST_F(ColumnMaps, AddThePartsOfATime) {
  const std::string map =
      "column,channel,unit\nhour,time,h\nmin,time,min\nsec,time,s\nms,time,ms\nx,ignore,\na,index_"
      "pip,\n";
  const std::vector<Row> rows =
      Read("hour,min,sec,ms,x,a\n13,59,59,980,text,1\n14,0,0,0,text,2\n", map);
  EXPECT_NEAR(rows[1].time_s - rows[0].time_s, 0.02, 1e-9);
  const std::vector<Row> clocks =
      Read("2024-05-31;23:59:59,98;1\n2024-06-01;00:00:00,00;2\n",
           "column,channel,unit\n1,time,date\n2,time,date\n3,index_pip,\n");
  ASSERT_EQ(clocks.size(), 2U);
  EXPECT_NEAR(clocks[1].time_s - clocks[0].time_s, 0.02, 1e-6);
}

TEST_F(ColumnMaps, SkipTheLinesOfASensorsSoftware) {
  RecordingFormat with_head;
  with_head.skipped_lines = 3;
  const std::vector<Row> rows =
      Read("Glove Studio 2.1; serial 17\nrate,100\n\nt_s,a\n0,1\n0.01,2\n",
           "column,channel\nt_s,time\na,index_pip\n", with_head);
  ASSERT_EQ(rows.size(), 2U);
  EXPECT_NEAR(rows[1]["index_pip"], 2.0, 1e-9);
}

TEST_F(ColumnMaps, OfAPersonNameColumnsExactly) {
  EXPECT_THAT(ErrorOf("index_mcp_rad\n0.5\n0.6\n", "column,channel\nindex_mcp,index_mcp\n"),
              HasSubstr("has no column"));
}

TEST_F(ColumnMaps, OfProfilesWithoutNamesFitAGloveOfTheirSensors) {
  int presets = 0;
  for (const auto& file : std::filesystem::directory_iterator(SourceDir() + "/scenarios/maps")) {
    if (!ReadProfile(file.path()).match.names.empty()) continue;
    std::string row;
    for (int i = 0; i < 30; ++i) row += i > 0 ? ",1" : "1";
    RecordingFormat format = At100Hz();
    format.map = file.path().stem().string();
    format.handling = ProblemHandling::kRepair;
    RecordingReader reader("in.csv", TextSource(row + "\n" + row + "\n"), format);
    const std::vector<bool>& has = reader.has_channel();
    EXPECT_GE(std::count(has.begin(), has.end(), true), 5) << file.path();
    ++presets;
  }
  EXPECT_GE(presets, 8);
}

TEST_F(ColumnMaps, GiveTheThumbItsColumnBesideNumbersOfRows) {
  RecordingFormat repaired = At100Hz();
  repaired.handling = ProblemHandling::kRepair;
  const std::vector<Row> rows = Read("thumb,index\n0,11,22\n1,12,23\n",
                                     "column,channel\nthumb,thumb_ip\nindex,index_pip\n", repaired);
  EXPECT_NEAR(rows[0]["thumb_ip"], 11.0, 1e-9);
  EXPECT_NEAR(rows[0]["index_pip"], 22.0, 1e-9);
}

TEST_F(ColumnMaps, ReadDecimalCommasBetweenBlanks) {
  const std::vector<Row> rows =
      Read("0,00 1,5 2,5\n0,01 1,6 2,6\n", "column,channel\n1,time\n2,index_mcp\n3,index_pip\n");
  EXPECT_NEAR(rows[1]["index_mcp"], 1.6, 1e-9);
  EXPECT_NEAR(rows[1]["index_pip"], 2.6, 1e-9);
}

// Each key at its limits, and beside the keys that it excludes.
TEST_F(ColumnMaps, RefuseEveryMistakeAtItsPlace) {
  const auto map = [&](const std::string& keys, const std::string& cells) -> std::string {
    std::ofstream(MapFile()) << "column,channel" << keys << "\na,index_mcp" << cells << "\n";
    try {
      ReadColumnMap(MapFile(), RecordingColumns{.name = "in.csv", .header = {"a"}, .count = 1});
    } catch (const UserError& error) {
      return error.what();
    }
    return "";
  };
  const struct {
    const char* keys;
    const char* cells;
    const char* problem;  // empty: none
  } known[] = {
      {"", "", ""},
      {",unit", ",mV", ":2:3: 'mV' must be one of: deg, rad, counts, share, volts"},
      {",unit", ",volts", ":2:3: volts need raw_low and raw_high"},
      {",sign", ",-1", ""},
      {",sign", ",2", ":2:3: must be 1 or -1"},
      {",deg_low", ",1", ":2:3: needs raw_low and raw_high"},
      {",deg_high", ",1", ":2:3: needs raw_low and raw_high"},
      {",raw_low", ",1", ":2:3: must be given, as the other end is"},
      {",raw_low,raw_high", ",1,", ":2:4: must be given, as the other end is"},
      {",raw_low,raw_high", ",,1", ":2:3: must be given, as the other end is"},
      {",raw_low,raw_high", ",1,1", ":2:4: must not be raw_low"},
      {",raw_low,raw_high", ",1,2", ""},
      {",raw_low,raw_high,scale", ",1,2,1", ":2:5: must be empty beside raw_low and raw_high"},
      {",raw_low,raw_high,sign", ",1,2,1", ":2:5: must be empty beside raw_low and raw_high"},
      {",raw_low,raw_high,offset", ",1,2,1", ":2:5: must be empty beside raw_low and raw_high"},
      {",raw_low,raw_high,unit", ",1,2,volts", ""},
      {",raw_low,raw_high,unit", ",1,2,feet", ":2:5: 'feet' must be one of: deg, rad"},
      {",raw_low,raw_high,unit,bits", ",1,2,deg,8", ":2:6: is for counts only"},
      {",raw_low,raw_high,unit,bits", ",1,2,volts,8", ":2:6: is for counts only"},
      {",unit,bits", ",counts,1", ""},
      {",unit,bits", ",counts,24", ""},
      {",unit,bits", ",counts,0", ":2:4: must be a whole number from 1 to 24"},
      {",unit,bits", ",counts,25", ":2:4: must be a whole number from 1 to 24"},
      {",unit,bits", ",counts,8.5", ":2:4: must be a whole number from 1 to 24"},
      {",unit,bits", ",deg,8", ":2:4: is for counts only"},
      {",wraps_at", ",0", ""},
      {",wraps_at", ",-1", ":2:3: must be above 0"},
      {",joint", ",x", ":2:3: is for command, angle and motor"},
      {",assumed", ",joint unit sign range rate", ""},
      {",assumed", ",joint name", ":2:3: 'name' must be one of: joint, unit, sign, range, rate"},
      {",raw_low,raw_high,envelope_ms", ",1,2,10", ""},
      {",raw_low,raw_high,envelope_ms", ",1,2,0", ":2:5: must be from"},
      {",raw_low,raw_high,envelope_ms", ",1,2,1e6", ":2:5: must be from"},
      {",envelope_ms", ",10", ":2:3: needs raw_low and raw_high of the envelope"},
      {",raw_low,raw_high,envelope_ms,wraps_at", ",1,2,10,5", ":2:6: must be empty beside"},
      {",raw_low,raw_high,envelope_ms,bits,unit", ",1,2,10,5,counts", ":2:6: must be empty beside"},
      {",scala", ",1", ":1:3: unknown key 'scala' (did you mean scale?)"},
  };
  for (const auto& [keys, cells, problem] : known) {
    const std::string found = map(keys, cells);
    if (*problem == '\0') {
      EXPECT_EQ(found, "") << keys << cells;
    } else {
      EXPECT_THAT(found, HasSubstr(problem)) << keys << cells;
    }
  }
  EXPECT_THAT(ErrorOf("a\n1\n", "column,channel\na,index_mpc\n"),
              HasSubstr(":2:2: unknown channel 'index_mpc' (did you mean index_mcp?)"));
  EXPECT_THAT(ErrorOf("a\n1\n", "column,channel\na,command\n"),
              HasSubstr(":2:2: command is of a log of commands and angles"));
  EXPECT_THAT(ErrorOf("a,b\n1,2\n", "column,channel\n1,index_pip\n2,index_pip\n"),
              HasSubstr("each has a weight"));
  EXPECT_THAT(ErrorOf("a\n1\n", "channel\nindex_mcp\n"), HasSubstr(":1:1: there is no key column"));
  EXPECT_THAT(ErrorOf("a\n1\n", "column\na\n"), HasSubstr(":1:1: there is no key channel"));
  EXPECT_THAT(ErrorOf("a\n1\n", "column,channel\na,ignore\n"),
              HasSubstr("the map names no channel"));
  EXPECT_THAT(ErrorOf("a\n1\n", "column,channel\n2,index_mcp\n"),
              HasSubstr("has no column '2', must be one of its names or 1 to 1"));
  EXPECT_THAT(ErrorOf("a\n1\n", "column,channel,unit\na,time,day,\n"),
              HasSubstr("the map names no channel"));
  EXPECT_THAT(ErrorOf("a\n1\n", "column,channel,unit\na,time,year\n"),
              HasSubstr("must be one of: s, ms, us, ns, ticks, min, h, day, date"));
}

TEST_F(ColumnMaps, OfLogsHaveCommandsAnglesAndMotors) {
  const std::filesystem::path file = MapFile();
  const auto read = [&](const std::string& text) {
    std::ofstream(file) << text;
    return ReadLogMap(file, {.name = "log.csv", .header = {"t", "a", "b", "c"}, .count = 4});
  };
  const LogMap map = read(
      "column,channel,unit,joint,scale,offset,raw_low,raw_high,deg_low,deg_high\nt,time,ms,,,,,,,\n"
      "a,command,rad,thumb,2,0.5,,,,\nb,angle,,,,3,,,,\nc,motor,counts,m1,,,100,300,10,50\n");
  ASSERT_EQ(map.time.size(), 1U);
  EXPECT_EQ(map.time[0].scale_s, 1e-3);
  ASSERT_EQ(map.parts.size(), 3U);
  EXPECT_EQ(map.parts[0].role, "command");
  EXPECT_EQ(map.parts[0].part, "thumb");
  EXPECT_NEAR(map.parts[0].scale, 2.0 * kDegPerRad, 1e-9);
  EXPECT_NEAR(map.parts[0].offset_deg, 0.5 * kDegPerRad, 1e-9);
  EXPECT_EQ(map.parts[1].column, 2U);
  EXPECT_EQ(map.parts[1].scale, 1.0);
  EXPECT_EQ(map.parts[1].offset_deg, 3.0);
  EXPECT_EQ(map.parts[1].part, "");
  EXPECT_NEAR(map.parts[2].scale, 0.2, 1e-12);
  EXPECT_NEAR(map.parts[2].offset_deg, -10.0, 1e-12);
  const auto problem = [&](const std::string& keys, const std::string& cells) {
    try {
      read("column,channel" + keys + "\na," + cells + "\n");
    } catch (const UserError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_EQ(problem("", "angle"), "");
  EXPECT_THAT(problem("", "index_mcp"),
              HasSubstr("must be one of: time, command, angle, motor, ignore"));
  for (const char* key : {"weight", "wraps_at", "envelope_ms"}) {
    EXPECT_THAT(problem(std::string(",") + key, "angle,1"), HasSubstr("is for a glove's channels"));
  }
  EXPECT_THAT(problem(",raw_low,raw_high,deg_low", "angle,1,2,3"),
              HasSubstr("must be given beside"));
  EXPECT_THAT(problem(",raw_low,raw_high,deg_high", "angle,1,2,3"),
              HasSubstr("must be given beside"));
  EXPECT_THAT(problem(",unit", "angle,counts"), HasSubstr("of a log must be deg or rad"));
  EXPECT_THAT(problem(",unit", "angle,share"), HasSubstr("of a log must be deg or rad"));
}

TEST(HandColumn, NamesAHandInEveryRow) {
  const auto found = [](const std::string& name, const std::vector<std::string>& cells) {
    TableLayout layout;
    layout.columns = 2;
    layout.names = {"a", name};
    for (const std::string& cell : cells) layout.rows.push_back({"1", cell});
    return HandColumn(layout);
  };
  for (const char* name : {"hand", "Hands", "my_handedness", "side"}) {
    EXPECT_EQ(found(name, {"left", "R", "right_hand"}), 1U) << name;
  }
  EXPECT_EQ(found("hand", {"left", "both", "right"}), std::nullopt);
  EXPECT_EQ(found("person", {"left", "right", "left"}), std::nullopt);
}

TEST(SecondsOfText, ReadsDatesAndClocks) {
  const double day_s = 86400.0;
  const struct {
    const char* text;
    double seconds;
  } known[] = {
      {"1970-01-02", day_s},
      {"1970-01-01T00:00:01.5Z", 1.5},
      {"1970-01-01 01:00:00+01:00", 0.0},
      {"1970-01-01 00:00:00-0130", 5400.0},
      {"2.1.1970 00:01", day_s + 60.0},
      {"1/2/1970 12:00:00 AM", day_s},
      {"31/1/1970_00:00:00", 30 * day_s},
      {"2024-02-29 00:00:00", 19782 * day_s},
      {"13:05:07.25", 47107.25},
      {"13:05:07,25", 47107.25},
      {"1:05:07 PM", 47107.0},
      {"12:00 am", 0.0},
      {"05:07.25", 307.25},
      {"\"00:00:01\"", 1.0},
      {"23:59:60", day_s},  // a leap second
      {"1970/01/02/00:00:01.25", day_s + 1.25},
      {"1970-01-01T00:00:01.123456+00:00", 1.123456},
      // str() of pandas.Timedelta and to_csv() of pandas 3.1.1; str() of datetime.timedelta
      {"0 days 00:00:00.010000", 0.01},
      {"-1 days +23:59:59.990000", -0.01},
      {"2 days", 2 * day_s},
      {"1 day, 0:00:01.500000", day_s + 1.5},
      // ISO 8601 of polars 2.1.0 and of pandas 3.1.1 in JSON
      {"PT0.01S", 0.01},
      {"P0D", 0.0},
      {"P1DT2H3M4.5S", day_s + 7384.5},
      {"-PT0.01S", -0.01},
      {"P-1DT23H59M59.990S", -0.01},
      // The day comes first with points, and where no month has such a number.
      {"13/1/1970", 12 * day_s},
      {"12/1/1970", 334 * day_s},
      {"12/31/1970", 364 * day_s},
      {"31/12/1970", 364 * day_s},
      {"2-1-1970", 31 * day_s},
      {"1000-01-01", -354285 * day_s},
      {"24:00:00", day_s},
      {"24:30", 88200.0},
      {"00:59", 3540.0},
      {"60:59.5", 3659.5},
      {"12:30 PM", 45000.0},
      {"12:30:30.5 AM", 1830.5},
      {"11:59:59 pm", day_s - 1.0},
      {"11:59 am", 43140.0},
      {"12:00:00+2", 36000.0},
      {"12:00:00+05:30", 23400.0},
      {"12:00:00-99", 399600.0},
      {"12:00:00+100", 39600.0},
  };
  for (const auto& [text, seconds] : known) {
    const auto read = SecondsOfText(text);
    ASSERT_TRUE(read) << text;
    EXPECT_NEAR(*read, seconds, 1e-6) << text;
  }
}

TEST(SecondsOfText, ReadsNothingElse) {
  for (const char* text : {"",
                           "1",
                           "1.5",
                           "1,5",
                           "-3",
                           "12:",
                           "12:61",
                           "23:59:61",
                           "25:00",
                           "2024-02-30",
                           "12:00x",
                           "1.2.3",
                           "index",
                           "2024-01-01T",
                           "1e5",
                           "nan",
                           "10:20:30:40",
                           "1-2",
                           "0999-01-01",
                           "32/1/1970",
                           "12/32/1970",
                           "13/13/1970",
                           "12345-01-01",
                           "111:00:00",
                           "00:60",
                           "00:60.5",
                           "25:00:00",
                           "1:123",
                           "1:2:345",
                           "00:00:01.",
                           "00:00:01Zx",
                           "00:00:01+",
                           "00:00:01+x",
                           "12:00 P",
                           "12:00 XM",
                           "1970-01-02/00:00",
                           "1970-01-02T00",
                           "1970-01-02T100:00",
                           "2024-1x-01",
                           "2024-01.01",
                           "P",
                           "PT",
                           "P1",
                           "P1DT",
                           "PT5",
                           "P5S",
                           "p1",
                           "PIP",
                           "3 day sun",
                           "5 days 3"}) {
    EXPECT_FALSE(SecondsOfText(text)) << text;
  }
}

}  // namespace
}  // namespace gauntlet::sim
