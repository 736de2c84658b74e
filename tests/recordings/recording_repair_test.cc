#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>
#include <map>
#include <string>
#include <vector>

#include "sim/base/channels.h"
#include "sim/base/error.h"
#include "sim/glove/glove.h"
#include "sim/recordings/recording.h"
#include "sim/recordings/zero_phase.h"
#include "tests/support/program.h"
#include "tests/support/source_dir.h"

namespace gauntlet::sim {
namespace {

using ::testing::Contains;
using ::testing::Each;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

struct Row {
  double time_s;
  double index_mcp_deg;
};

/// Everything that a reader gives of a text with the columns time and index_mcp.
struct ReadResult {
  std::vector<Row> rows;
  std::vector<std::string> remarks;
};

ReadResult Read(const std::string& text, RecordingFormat format) {
  RecordingReader reader("in.csv", TextSource(text), format);
  ReadResult result;
  std::vector<double> angles(KnownChannels().size());
  double time_s = 0.0;
  while (reader.NextRow(time_s, angles)) {
    result.rows.push_back({time_s, angles[ChannelIndex("index_mcp")] * kDegPerRad});
  }
  result.remarks = reader.Remarks();
  return result;
}

ReadResult Repair(const std::string& text) {
  RecordingFormat format;
  format.handling = ProblemHandling::kRepair;
  return Read(text, format);
}

template <class Action>
std::string ErrorOf(const Action& action) {
  try {
    action();
  } catch (const UserError& error) {
    return error.what();
  }
  return "no error";
}

std::string StrictError(const std::string& text) {
  return ErrorOf([&] { Read(text, {}); });
}

TEST(RecordingRepair, LeavesOutWhatIsNoNumberAndSaysWhereAndHowOften) {
  const std::string text =
      "time_s,index_mcp\r\n0,1\r\n0.01,x\r\n0.02\r\n0.03,nan\r\n0.04,\r\n0.05,6\r\n0.06,7,8\r\n";
  const ReadResult result = Repair(text);
  ASSERT_EQ(result.rows.size(), 7u);
  EXPECT_TRUE(std::isnan(result.rows[1].index_mcp_deg));
  EXPECT_TRUE(std::isnan(result.rows[2].index_mcp_deg));
  EXPECT_NEAR(result.rows[5].index_mcp_deg, 6.0, 1e-12);
  EXPECT_NEAR(result.rows[6].index_mcp_deg, 7.0, 1e-12);
  EXPECT_THAT(result.remarks, ElementsAre("in.csv: missing value: 2 times, first in row 5",
                                          "in.csv: not a number: 1 times, first in row 3",
                                          "in.csv: row too long: 1 times, first in row 8",
                                          "in.csv: truncated row: 1 times, first in row 4"));
  EXPECT_EQ(StrictError(text), "in.csv:3:2: 'x' is not a number");
}

TEST(RecordingRepair, MakesTimeRise) {
  const std::string text =
      "time_s,index_mcp\n10,1\n10.01,2\n10.01,3\n10.005,4\n10.02,5\n0.5,6\n0.51,7\n";
  const ReadResult result = Repair(text);
  std::vector<double> times, angles;
  for (const Row& row : result.rows) {
    times.push_back(std::round(1000 * row.time_s) / 1000);
    angles.push_back(std::round(row.index_mcp_deg));
  }
  EXPECT_THAT(angles, ElementsAre(1, 2, 5, 6, 7));
  EXPECT_THAT(times, ElementsAre(10, 10.01, 10.02, 10.03, 10.04));
  EXPECT_THAT(result.remarks,
              ElementsAre("in.csv: clock started anew: 1 times, first in row 7",
                          "in.csv: repeated time, row left out: 1 times, first in row 4",
                          "in.csv: row out of order, left out: 1 times, first in row 5"));
  EXPECT_EQ(StrictError(text),
            "in.csv:4:1: the time is 10.01 s, must be above 10.01 s of the row before");
}

/// A row that was written twice is one row, and no repair. Wrong: half of the file is a repair.
TEST(RecordingRepair, TakesARowThatWasWrittenTwiceOnce) {
  std::string text = "time_s,index_mcp\n";
  for (int row = 0; row < 40; ++row) text += fmt::format("{:.2f},{}\n", 0.01 * (row / 2), row / 2);
  const ReadResult result = Repair(text);
  EXPECT_EQ(result.rows.size(), 20U);
  EXPECT_THAT(result.remarks,
              ElementsAre("in.csv: 20 rows repeat the one before and its time: left out"));
}

/// Times of 9 rows at 100 Hz from 10 s, of which some lines of the file have another.
std::string Times(const std::map<int, double>& wild_s) {
  std::string text = "time_s,index_mcp\n";
  for (int i = 0; i < 9; ++i) {
    const auto wild = wild_s.find(i + 2);
    text += fmt::format("{},{}\n", wild != wild_s.end() ? wild->second : 10.0 + 0.01 * i, i);
  }
  return text;
}

double LengthS(const ReadResult& result) {
  return result.rows.back().time_s - result.rows.front().time_s;
}

TEST(RecordingRepair, LeavesOutOneWildTime) {
  for (const double wild_s : {50.0, 1e6, 10.3, 2.0, -1e6}) {
    const ReadResult result = Repair(Times({{6, wild_s}}));
    EXPECT_EQ(result.rows.size(), 8u) << wild_s;
    EXPECT_NEAR(LengthS(result), 0.08, 1e-9) << wild_s;
    EXPECT_THAT(result.remarks,
                ElementsAre("in.csv: wild time, row left out: 1 times, first in row 6"));
    EXPECT_THAT(StrictError(Times({{6, wild_s}})), HasSubstr("in.csv:6:1: "));
  }
  const ReadResult last = Repair(Times({{10, 50.0}}));
  EXPECT_NEAR(LengthS(last), 0.07, 1e-9);
  const ReadResult twice = Repair(Times({{5, 50.0}, {7, 60.0}}));
  EXPECT_EQ(twice.rows.size(), 7u);
  EXPECT_THAT(twice.remarks,
              ElementsAre("in.csv: wild time, row left out: 2 times, first in row 5"));
}

TEST(RecordingRepair, FindsWhatIsWrongInTheRowBehindAWildTime) {
  const ReadResult result =
      Repair("time_s,index_mcp\n0,1\n0.01,2\n50,3\n0.03,x\n0.04,5\n0.04,6\n0.05,7\n");
  ASSERT_EQ(result.rows.size(), 5u);
  EXPECT_TRUE(std::isnan(result.rows[2].index_mcp_deg));
  EXPECT_THAT(result.remarks,
              ElementsAre("in.csv: not a number: 1 times, first in row 5",
                          "in.csv: repeated time, row left out: 1 times, first in row 7",
                          "in.csv: wild time, row left out: 1 times, first in row 4"));
}

TEST(RecordingRepair, TakesNoGapAndNoNewStartForAWildTime) {
  const ReadResult gap = Repair("time_s,index_mcp\n0,1\n0.01,2\n50,3\n50.01,4\n");
  EXPECT_EQ(gap.rows.size(), 4u);
  EXPECT_THAT(gap.remarks, ElementsAre("in.csv: gap in time: 1 times, first in row 4"));
  const ReadResult anew = Repair("time_s,index_mcp\n7,1\n7.01,2\n0,3\n0.01,4\n");
  EXPECT_EQ(anew.rows.size(), 4u);
  EXPECT_THAT(anew.remarks, ElementsAre("in.csv: clock started anew: 1 times, first in row 4"));
}

TEST(RecordingRepair, ReportsGaps) {
  const std::string text = "time_ms,index_mcp\n0,1\n10,2\n670,3\n";
  EXPECT_THAT(Repair(text).remarks, ElementsAre("in.csv: gap in time: 1 times, first in row 4"));
  EXPECT_EQ(StrictError(text), "in.csv:4:1: nothing for 660 ms");
}

TEST(RecordingRepair, ReportsAbsurdValues) {
  const std::string text = "time_s,index_mcp_counts\n0,512\n0.01,35512.6\n0.02,512\n";
  const ReadResult result = Repair(text);
  EXPECT_TRUE(IsFarBeyondRange(KnownChannels()[ChannelIndex("index_mcp")],
                               result.rows[1].index_mcp_deg * kRadPerDeg));
  EXPECT_NEAR(result.rows[2].index_mcp_deg, 22.5, 0.1);  // half scale is the middle of the range
  EXPECT_THAT(StrictError(text), HasSubstr("in.csv:3:2: index_mcp is 5796.14 deg"));
}

TEST(RecordingRepair, FindsTheNameThatAHeaderLacks) {
  EXPECT_NEAR(Repair("time_s,index_mcp\n0,1,9\n1,2,9\n").rows[1].index_mcp_deg, 2.0, 1e-12);
  // The first column has no name, as R writes row names.
  EXPECT_NEAR(Repair("index_mcp,time_s\n7,1,0\n8,2,0.01\n").rows[1].index_mcp_deg, 2.0, 1e-12);
  EXPECT_EQ(StrictError("time_s,index_mcp\n0,1,9\n"),
            "in.csv:1:2: the header has 2 names for 3 values");
}

TEST(Recording, KnowsTheTimeOfTheProjectsOwnTables) {
  // As `gauntlet run --csv` and `gauntlet filter` name it.
  const ReadResult result = Read("k,t_s,index_mcp\n0,2,1\n1,2.05,2\n", {});
  ASSERT_EQ(result.rows.size(), 2u);
  EXPECT_NEAR(result.rows[1].time_s, 2.05, 1e-12);
  EXPECT_NEAR(result.rows[1].index_mcp_deg, 2.0, 1e-12);
  EXPECT_NEAR(Read("Time_ms,index_mcp\n0,1\n20,2\n", {}).rows[1].time_s, 0.02, 1e-12);

  EXPECT_EQ(StrictError("k,index_mcp\n0,1\n"),
            "in.csv:1:1: there is no column of time; without one file_rate_hz must be given");
  RecordingFormat format;
  format.rate_hz = 50.0;
  const ReadResult numbered = Read("k,index_mcp\n0,1\n1,2\n", format);
  EXPECT_NEAR(numbered.rows[1].time_s, 0.02, 1e-12);
  EXPECT_TRUE(numbered.remarks.empty());
}

TEST(Recording, WithTimeNeedsNoRate) {
  const std::string text = "index_mcp,time_s\n1,0\n2,0.01\n";
  RecordingFormat format;
  format.rate_hz = 50.0;
  EXPECT_EQ(ErrorOf([&] { Read(text, format); }),
            "in.csv:1:2: is a column of time, file_rate_hz must not be given");
  format.handling = ProblemHandling::kRepair;
  const ReadResult result = Read(text, format);
  EXPECT_NEAR(result.rows[1].time_s, 0.01, 1e-12);
  EXPECT_THAT(result.remarks, ElementsAre("in.csv: file_rate_hz not used beside a column of time"));
}

TEST(RecordingRepair, LeavesOutUnknownColumnsAndSaysSo) {
  const ReadResult result = Repair("time_s,label,index_mcp\n0,V,1\n0.01,H,2\n");
  EXPECT_NEAR(result.rows[1].index_mcp_deg, 2.0, 1e-12);
  EXPECT_THAT(result.remarks, Contains("in.csv: unknown column 'label' left out"));
}

TEST(Recording, FillsShortGapsAndMasksLongOnes) {
  Recording recording;
  recording.has_channel.assign(18, true);
  for (int i = 0; i <= 20; ++i) {
    if (i == 3 || (i > 6 && i < 17)) continue;
    recording.time_s.push_back(0.01 * i);
  }
  recording.angle_rad = Signal::Constant(static_cast<Eigen::Index>(recording.time_s.size()), 18, 1);
  const Resampled resampled = Resample(recording, 0, 0.0, 1000.0, 201, 0.05);
  for (int i = 0; i <= 200; ++i) {
    EXPECT_EQ(resampled.mask[i], i > 60 && i < 170) << i;
    EXPECT_EQ(resampled.value[i], 1.0);
  }
}

TEST(Recording, HeldShowsTheNewestRowAndNeverOneToCome) {
  Recording recording;
  recording.has_channel.assign(18, true);
  // A row 0.4 us late by rounding counts at its sample; a missing value holds the one before.
  recording.time_s = {0.0, 0.0100004, 0.02, 0.0303, 0.2, 0.21};
  recording.angle_rad = Signal::Zero(6, 18);
  recording.angle_rad.col(0) << 1, 2, std::numeric_limits<double>::quiet_NaN(), 4, 5, 6;
  const Resampled held = Resample(recording, 0, 0.0, 1000.0, 221, 0.05, Resampling::kHold);
  for (int i = 0; i <= 220; ++i) {
    const double expected = i < 10 ? 1 : i < 31 ? 2 : i < 200 ? 4 : i < 210 ? 5 : 6;
    EXPECT_EQ(held.value[i], expected) << i;
    // The row at 30.3 ms is known at 31 ms; then nothing comes for long.
    EXPECT_EQ(held.mask[i], i > 31 && i < 200) << i;
  }
  // In the middle of that gap nothing is known, at its start neither.
  EXPECT_TRUE(Resample(recording, 0, 0.1, 1000.0, 2, 0.05, Resampling::kHold).mask[0]);
}

class Files : public ::testing::Test {
 protected:
  std::string Write(const std::string& name, std::string_view text) {
    std::ofstream(folder_.path() / name, std::ios::binary) << text;
    return (folder_.path() / name).string();
  }
  test::TemporaryDirectory folder_;
};

/// 3 s of index_mcp at 100 Hz: 20 + 10 sin t [deg], with other angles in some lines of the file.
std::string SlowSine(const std::map<int, double>& wild_deg) {
  std::string text = "time_s,index_mcp\n";
  for (int i = 0; i <= 300; ++i) {
    const auto wild = wild_deg.find(i + 2);
    const double angle_deg = wild != wild_deg.end() ? wild->second : 20 + 10 * std::sin(0.01 * i);
    text += fmt::format("{},{}\n", 0.01 * i, angle_deg);
  }
  return text;
}

TEST_F(Files, WithGlitchesStopAStrictReadingAndAreRepaired) {
  const std::string file = Write("in.csv", SlowSine({{2, 80}, {101, 85}, {201, -40}, {202, 75}}));
  EXPECT_EQ(ErrorOf([&] { LoadRecording(file, {}); }),
            file + ":2:2: index_mcp jumps to 80 deg and back, faster than a hand");
  EXPECT_EQ(ErrorOf([&] { LoadRecording(file, {}, 0.5); }),
            file + ":101:2: index_mcp jumps to 85 deg and back, faster than a hand");
  RecordingFormat repair;
  repair.handling = ProblemHandling::kRepair;
  const Recording recording = LoadRecording(file, repair);
  EXPECT_THAT(
      recording.remarks,
      ElementsAre(file + ": glitch: 4 times, first in row 2 (index_mcp 1.33 % of the rows)"));
  const auto angle = recording.angle_rad.col(ChannelIndex("index_mcp"));
  EXPECT_EQ(angle.array().isNaN().count(), 4);
  EXPECT_TRUE(std::isnan(angle[99]));
}

TEST_F(Files, ThatAreShippedHaveNoGlitch) {
  const std::string folder = SourceDir() + "/scenarios/recordings/";
  RecordingFormat format;
  EXPECT_THAT(LoadRecording(folder + "door_opening/angles.csv", format).remarks, ElementsAre());
  format.handling = ProblemHandling::kRepair;
  EXPECT_THAT(LoadRecording(folder + "door_opening/targets.csv", format).remarks,
              Each(Not(HasSubstr("glitch"))));
  format.rate_hz = 50.0;
  format.map = folder + "sign_glove/map.csv";
  EXPECT_THAT(LoadRecording(folder + "sign_glove/letters_v_h_r.csv", format).remarks,
              Each(Not(HasSubstr("glitch"))));
}

TEST_F(Files, ThatAreTooShortSayWhy) {
  const std::string file = Write("in.csv", SlowSine({}));
  EXPECT_EQ(ErrorOf([&] { LoadRecording(file, {}, 5.0); }),
            file + ":302:1: the recording is 3 s long, must be longer than start_s 5");
  std::string text = "time_s,index_mcp\n";
  for (int i = 0; i < 300; ++i) text += "1,20\n";
  RecordingFormat repair;
  repair.handling = ProblemHandling::kRepair;
  const std::string repeats = Write("repeats.csv", text);
  EXPECT_EQ(ErrorOf([&] { LoadRecording(repeats, repair); }),
            repeats +
                ":301:1: the recording has 1 good rows, must have at least 2 (found: repeated "
                "time, row left out: 296 times, first in row 6); is the time too coarse? Map its "
                "column to "
                "ignore, and give file_rate_hz");
}

TEST_F(Files, OfASlowDeviceAreRemarked) {
  std::string text = "time_s,index_mcp\n0,1\n";
  for (int i = 1; i < 10; ++i) text += fmt::format("{},{}\n", 0.01 * i, i / 4 * 10);
  const std::string file = Write("in.csv", text);
  EXPECT_THAT(
      LoadRecording(file, {}).remarks,
      ElementsAre(file + ": rows that repeat the value before: index_mcp 60 % (at most 3 in a "
                         "row)"));
}

TEST_F(Files, AreMappedByAMapFile) {
  RecordingFormat format;
  format.map = Write("map.csv",
                     "column,channel,unit,scale,sign,offset\n"
                     "t,time,ms,,,\n"
                     "flex 1,index_pip,deg,0.5,-1,90\n"
                     "3,little_pip,share,,,\n");
  const std::string file = Write("in.csv", "t;flex 1;x;y\n0;20;0,25;a\n10;40;0,5;b\n");
  const Recording recording = LoadRecording(file, format);
  EXPECT_NEAR(recording.time_s[1], 0.01, 1e-12);
  EXPECT_NEAR(recording.angle_rad(1, ChannelIndex("index_pip")) * kDegPerRad, 70.0, 1e-9);
  EXPECT_NEAR(recording.angle_rad(0, ChannelIndex("little_pip")) * kDegPerRad, 25.0, 1e-9);
}

TEST_F(Files, OfMapsAreTablesLikeRecordings) {
  const std::string file = Write("in.csv", "a b,c\n0,1\n1,2\n");
  RecordingFormat format;
  format.rate_hz = 100.0;
  for (const std::string_view text :
       {"\xEF\xBB\xBF\"column\";\"channel\";\"scale\"\r\n\"a b\";\"index_mcp\";0,5\r\n",
        "# by hand\ncolumn\tchannel\tscale\na b\tindex_mcp\t+0.5",
        "\n'column' , channel,scale\n'a b', index_mcp ,0.5\n\n"}) {
    format.map = Write("map.csv", text);
    const Recording recording = LoadRecording(file, format);
    EXPECT_NEAR(recording.angle_rad(1, ChannelIndex("index_mcp")) * kDegPerRad, 0.5, 1e-12);
  }
}

TEST_F(Files, OfMapsAreReadStrictly) {
  const std::string file = Write("in.csv", "a,b\n0,1\n1,2\n");
  const auto error_of = [&](std::string_view text) -> std::string {
    RecordingFormat format;
    format.rate_hz = 100.0;
    format.map = Write("map.csv", text);
    try {
      LoadRecording(file, format);
    } catch (const UserError& error) {
      const std::string message = error.what();
      return message.substr(message.find("map.csv"));
    }
    return "no error";
  };
  EXPECT_EQ(error_of("column,channel\na,index_mcp\n"), "no error");
  EXPECT_EQ(error_of(""), "map.csv:1:1: the file holds no data");
  EXPECT_EQ(error_of("1,2\n"), "map.csv:1:1: there is no key column");
  EXPECT_EQ(error_of("column,channel,scale\na,index_mcp,1e999\n"),
            "map.csv:2:3: '1e999' is not a finite number");
  EXPECT_EQ(error_of("column,chanel\n"),
            "map.csv:1:2: unknown key 'chanel' (did you mean channel?)");
  EXPECT_EQ(error_of("column,channel\na,index_mpc\n"),
            "map.csv:2:2: unknown channel 'index_mpc' (did you mean index_mcp?)");
  EXPECT_EQ(error_of("column,channel,unit\na,index_mcp,m\n"),
            "map.csv:2:3: 'm' must be one of: deg, rad, counts, share, volts");
  EXPECT_EQ(error_of("column,channel,scale\na,index_mcp,two\n"),
            "map.csv:2:3: 'two' is not a number");
  EXPECT_EQ(error_of("column,channel,sign\na,index_mcp,2\n"), "map.csv:2:3: must be 1 or -1");
  EXPECT_THAT(error_of("column,channel\nc,index_mcp\n"), HasSubstr("has no column 'c'"));
  EXPECT_EQ(error_of("column,channel\na,index_mcp\nb,index_mcp\n"),
            "map.csv:3:2: index_mcp appears twice; its rows add up if each has a weight");
  EXPECT_EQ(error_of("column,channel\na\n"), "map.csv:2:1: the row has 1 of 2 values");
}

TEST_F(Files, CanBeReadInPart) {
  std::string text = "time_s,index_mcp\n";
  for (int i = 0; i < 1000; ++i) {
    text += std::to_string(100.0 + i * 0.01) + "," + std::to_string(i * 0.05) + "\n";
  }
  const std::string file = Write("in.csv", text);
  const Recording part = LoadRecording(file, {}, 5.0, 1.0);
  EXPECT_LE(part.time_s.size(), 105u);
  EXPECT_LE(part.time_s.front(), 5.0);
  EXPECT_GE(part.time_s.back(), 6.0);
  EXPECT_THROW(LoadRecording(file, {}, 50.0, 1.0), UserError);
}

TEST_F(Files, AreHeldWhereAGloveMeasuredAndInterpolatedWhereTheyAreTheTruth) {
  // A ramp of 1 deg per row at 50 Hz.
  std::string text = "time_s,index_mcp\n";
  for (int i = 0; i <= 100; ++i) text += fmt::format("{},{}\n", 0.02 * i, 0.5 * i);
  RecordedMotionConfig recording = {.file = Write("ramp.csv", text)};
  const auto steps = [&](const Signal& signal) {
    const auto column = signal.col(ChannelIndex("index_mcp"));
    return (column.head(2000).array() != column.segment(1, 2000).array()).count();
  };
  const auto measured = [&] {
    const MotionContext context;
    const Motion motion = MakeMotion(recording, context);
    return steps(recording.use == RecordingUse::kTruth ? motion.angle_rad : motion.measured_rad);
  };
  EXPECT_EQ(measured(), 2000);
  recording.resample = Resampling::kHold;
  EXPECT_EQ(measured(), 100);
  recording.resample.reset();
  recording.use = RecordingUse::kMeasured;
  EXPECT_EQ(measured(), 100);
  EXPECT_GT(steps(MakeMotion(recording, {}).angle_rad), 1900);  // the reference is smooth
  recording.resample = Resampling::kCubic;
  EXPECT_EQ(measured(), 2000);
}

TEST_F(Files, LongerThanAnyMotionNeedADuration) {
  std::string text = "time_s,index_mcp\n";
  for (int i = 0; i < 4000; ++i) text += std::to_string(i) + (i < 3700 ? ",10\n" : ",bad\n");
  GloveConfig config;
  RecordedMotionConfig recording = {.file = Write("long.csv", text), .longest_gap_ms = 2000.0};
  config.motion.settings = recording;
  try {
    SynthesiseGlove(config, 1);
    FAIL();
  } catch (const UserError& error) {  // the bad row at 3700 s is not reached
    EXPECT_THAT(error.what(), HasSubstr("is longer than 3600 s, duration_s must be given"));
  }
  recording.start_s = 100.0;
  recording.duration_s = 2.0;
  config.motion.settings = recording;
  EXPECT_EQ(SynthesiseGlove(config, 1).counts.rows(), 2000);
}

TEST(RecordingReader, KeepsItsMemoryFlatOnALongFile) {
  // 200 MB of rows, made while they are read.
  const std::string row = "12.5,13.25,14.125,15,16.5,17,18,19.75,20\n";
  std::size_t left = 200u << 20;
  bool first = true;
  std::size_t at = 0;
  const CsvReader::Source source = [&](char* buffer, std::size_t size) -> std::size_t {
    if (first) {
      const std::string header = "index_mcp,index_pip,a,b,c,d,e,f,g\n";
      std::memcpy(buffer, header.data(), header.size());
      first = false;
      return header.size();
    }
    std::size_t given = 0;
    while (given < size && left > 0) {
      const std::size_t count = std::min(row.size() - at, size - given);
      std::memcpy(buffer + given, row.data() + at, count);
      given += count;
      at = (at + count) % row.size();
      left = left > count ? left - count : 0;
    }
    return given;
  };
  rusage before{}, after{};
  RecordingFormat format;
  format.handling = ProblemHandling::kRepair;
  format.rate_hz = 1000.0;
  RecordingReader reader("made", source, format);
  std::vector<double> angles(18);
  double time_s = 0.0;
  std::size_t rows = 0;
  reader.NextRow(time_s, angles);
  getrusage(RUSAGE_SELF, &before);
  while (reader.NextRow(time_s, angles)) ++rows;
  getrusage(RUSAGE_SELF, &after);
  EXPECT_GT(rows, 4000000u);
  // Far below what is read; the address sanitizer holds on to some of what has been freed.
  EXPECT_LT(after.ru_maxrss - before.ru_maxrss, 16 * 1024);  // KiB
}

TEST(ZeroPhase, HasItsCutOffAndNoDelay) {
  constexpr double kPi = 3.14159265358979323846;
  for (const double frequency_hz : {0.5, 5.0, 20.0}) {
    std::vector<double> sine(8000);
    for (int i = 0; i < 8000; ++i) sine[i] = std::sin(2 * kPi * frequency_hz * i / 1000.0);
    std::vector<double> smooth = sine;
    SmoothZeroPhase(5.0, 1000.0, smooth);
    double product = 0.0, squares = 0.0, quadrature = 0.0;
    for (int i = 2000; i < 6000; ++i) {
      product += sine[i] * smooth[i];
      quadrature += std::cos(2 * kPi * frequency_hz * i / 1000.0) * smooth[i];
      squares += sine[i] * sine[i];
    }
    // Two second-order passes: 1 / (1 + (f / f1)^4), and 0.707 at the cut-off.
    const double f1 = 5.0 / std::pow(std::sqrt(2.0) - 1.0, 0.25);
    const double gain = 1.0 / (1.0 + std::pow(frequency_hz / f1, 4));
    EXPECT_NEAR(product / squares, gain, 0.002) << frequency_hz;
    EXPECT_NEAR(quadrature / squares, 0.0, 1e-3) << frequency_hz;
  }
}

TEST(ZeroPhase, KeepsAStraightLine) {
  std::vector<double> line(3000);
  for (int i = 0; i < 3000; ++i) line[i] = 0.01 * i - 3.0;
  std::vector<double> smooth = line;
  SmoothZeroPhase(3.0, 1000.0, smooth);
  double worst = 0.0;
  for (int i = 0; i < 3000; ++i) worst = std::max(worst, std::abs(smooth[i] - line[i]));
  EXPECT_LT(worst, 0.01);  // a sample's step: a delay of one sample would show
}

/// What a real glove measured, without simulated noise.
GloveConfig Played(const RecordedMotionConfig& recording) {
  GloveConfig config;
  config.motion.settings = recording;
  config.noise.kind = WhiteNoiseKind::kNone;
  return config;
}

RecordedMotionConfig Measured(const std::string& file) {
  return {.file = SourceDir() + "/scenarios/recordings/" + file,
          .problems = ProblemHandling::kRepair,
          .use = RecordingUse::kMeasured};
}

TEST(MeasuredRecording, OfDoorTargetsIsScoredAgainstItsTruth) {
  RecordedMotionConfig recording = Measured("door_opening/targets.csv");
  recording.start_s = 1.5;
  recording.duration_s = 2.0;
  recording.reference = SourceDir() + "/scenarios/recordings/door_opening/angles.csv";
  const GloveSignal glove = SynthesiseGlove(Played(recording), 1);
  EXPECT_EQ(glove.reference_name, "recorded reference");
  RecordedMotionConfig truth = recording;
  truth.file = recording.reference;
  truth.use = RecordingUse::kTruth;
  EXPECT_EQ(glove.true_angle_rad, SynthesiseGlove(Played(truth), 1).true_angle_rad);
  EXPECT_EQ(glove.counts, SynthesiseGlove(Played(recording), 2).counts);  // nothing is drawn
  EXPECT_FALSE(glove.counts.hasNaN());
}

TEST(MeasuredRecording, IsMissingWhereNothingWasRecordedForLong) {
  const GloveSignal glove = SynthesiseGlove(Played(Measured("door_opening/targets.csv")), 1);
  // Between the demonstrations 0.4 s are empty.
  const Eigen::Index missing = glove.counts.col(4).array().isNaN().count();
  EXPECT_GT(missing, 1500);
  EXPECT_LT(missing, 3800);
  EXPECT_FALSE(glove.true_angle_rad.hasNaN());
}

TEST_F(Files, OfAGloveKeepTheirGlitchesForTheControllersUnlessRemoved) {
  // 400 deg is far beyond the range: full scale. The sine is below 30 deg.
  RecordedMotionConfig recording = {.file = Write("in.csv", SlowSine({{101, 85}, {201, 400}})),
                                    .problems = ProblemHandling::kRepair,
                                    .use = RecordingUse::kMeasured};
  const int channel = ChannelIndex("index_mcp");
  const auto counts_at = [&](const GloveSignal& glove, int ms) {
    return glove.counts(ms, channel);
  };
  const GloveSignal repaired = SynthesiseGlove(Played(recording), 1);
  const double deg_85 = 102.3 + 818.4 * (85.0 + 45.0) / 135.0;
  EXPECT_NEAR(counts_at(repaired, 995), deg_85, 0.51);
  EXPECT_EQ(counts_at(repaired, 1995), 1023.0);
  recording.problems = ProblemHandling::kRemove;
  const GloveSignal removed = SynthesiseGlove(Played(recording), 1);
  EXPECT_LT(removed.counts.col(channel).maxCoeff(), 102.3 + 818.4 * (31.0 + 45.0) / 135.0);
  // The reference is the same, and every tick of it counts: a lost row is a short gap.
  EXPECT_EQ(repaired.true_angle_rad, removed.true_angle_rad);
  EXPECT_LT(repaired.true_angle_rad.col(channel).maxCoeff() * kDegPerRad, 31.0);
  EXPECT_TRUE(repaired.masked.empty());
  // A gap that is too long to fill is masked in both.
  recording.longest_gap_ms = 15.0;
  const GloveSignal no_filling = SynthesiseGlove(Played(recording), 1);
  recording.problems = ProblemHandling::kRepair;
  const GloveSignal unfilled = SynthesiseGlove(Played(recording), 1);
  EXPECT_TRUE(no_filling.counts.col(channel).hasNaN());
  EXPECT_FALSE(unfilled.counts.col(channel).hasNaN());
  EXPECT_FALSE(unfilled.masked.empty());
  // As the true motion a recording has none.
  recording.use = RecordingUse::kTruth;
  const GloveSignal truth = SynthesiseGlove(Played(recording), 1);
  EXPECT_LT(truth.true_angle_rad.col(channel).maxCoeff() * kDegPerRad, 31.0);
}

TEST_F(Files, OfAGloveInCountsHaveTheCalibrationOfTheirMap) {
  const auto taken = [this](const std::string& rows) {
    RecordedMotionConfig recording = {.file = Write("in.csv", "t,a,b\n0,300,3000\n1,500,2000\n"),
                                      .map = Write("map.csv",
                                                   "column,channel,unit,bits,raw_low,"
                                                   "raw_high,assumed\nt,time,s,,,,\n" +
                                                       rows),
                                      .use = RecordingUse::kMeasured};
    GloveConfig config = Played(recording);
    ApplyCalibrationOfMap(config);
    return config;
  };
  const GloveConfig points =
      taken("a,index_mcp,counts,,300,500,range\nb,index_pip,counts,,3000,2000,\n");
  EXPECT_EQ(points.converter.bits, std::vector{12.0});
  ASSERT_EQ(points.calibration.size(), 2U);
  EXPECT_EQ(points.calibration[0].assumed, "range");
  EXPECT_EQ(points.calibration[1].assumed, "");
  EXPECT_EQ(points.calibration[1].low_counts, 3000.0);
  EXPECT_EQ(points.calibration[1].high_counts, 2000.0);
  // The ends of the joint's range at 10 % and 90 % of full scale are a guess until confirmed.
  const std::string no_points = "a,index_mcp,counts,10,,,\n";
  EXPECT_EQ(taken(no_points).calibration.at(0).assumed, "range");
  EXPECT_NEAR(taken(no_points).calibration.at(0).low_counts, 102.3, 1e-6);
  EXPECT_EQ(taken(no_points + "all,confirmed,,,,,\n").calibration.at(0).assumed, "");
  // Each column has the converter that the map gives it; the others the scenario's.
  const ConverterConfig both =
      taken("a,index_mcp,counts,10,,,\nb,index_pip,counts,12,,,\n").converter;
  EXPECT_EQ(both.bits_of(ChannelIndex("index_mcp")), 10.0);
  EXPECT_EQ(both.bits_of(ChannelIndex("index_pip")), 12.0);
  const std::string twelve = "a,index_mcp,counts,12,,,\nb,index_pip,counts,12,,,\n";
  EXPECT_EQ(taken(twelve).converter.bits, std::vector{12.0});
  // Ten bits of the scenario would become twelve.
  try {
    taken("a,index_mcp,counts,,,,\nb,index_pip,counts,12,,,\n");
    FAIL();
  } catch (const UserError& error) {
    EXPECT_THAT(error.what(),
                HasSubstr("index_mcp: bits must be given, as other columns are of 12 bits"));
  }
}

TEST(MeasuredRecording, OfAHomeMadeGloveNamesItsReference) {
  RecordedMotionConfig recording = Measured("sign_glove/letters_v_h_r.csv");
  recording.map = SourceDir() + "/scenarios/recordings/sign_glove/map.csv";
  recording.file_rate_hz = 50.0;
  recording.duration_s = 20.0;
  const GloveSignal glove = SynthesiseGlove(Played(recording), 1);
  EXPECT_EQ(glove.reference_name, "recording smoothed at 5 Hz, zero phase");
  EXPECT_EQ(glove.counts.rows(), 20000);
  EXPECT_THAT(glove.remarks, Contains(HasSubstr("rows that repeat the value before")));
  // The letter V: index and middle finger straight, ring and little finger bent.
  const auto mean_deg = [&](std::string_view name) {
    return glove.true_angle_rad.col(ChannelIndex(name)).mean() * kDegPerRad;
  };
  EXPECT_LT(mean_deg("index_pip"), 20.0);
  EXPECT_LT(mean_deg("middle_pip"), 20.0);
  EXPECT_GT(mean_deg("ring_pip"), 60.0);
  EXPECT_GT(mean_deg("little_pip"), 60.0);
}

}  // namespace
}  // namespace gauntlet::sim
