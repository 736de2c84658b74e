#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "sim/base/channels.h"
#include "sim/base/error.h"
#include "sim/recordings/pchip.h"
#include "sim/recordings/recording.h"
#include "sim/tables/csv_reader.h"
#include "tests/support/program.h"
#include "tests/support/source_dir.h"

namespace gauntlet::sim {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

std::vector<std::vector<double>> ReadAll(std::string_view text) {
  CsvReader reader("in.csv", TextSource(text), ProblemHandling::kStrict);
  std::vector<std::vector<double>> rows;
  std::vector<double> row(reader.column_count());
  while (reader.NextRow(row)) rows.push_back(row);
  return rows;
}

std::string ErrorOf(std::string_view text) {
  try {
    ReadAll(text);
  } catch (const UserError& error) {
    return error.what();
  }
  return "no error";
}

TEST(CsvReader, ReadsTheSameNumbersWithAnySeparatorAndLineEnd) {
  const std::vector<std::vector<double>> expected = {{1, -2.5, 3e-3}, {4, 5, 6}};
  EXPECT_EQ(ReadAll("a,b,c\n1,-2.5,3e-3\n4,5,6\n"), expected);
  EXPECT_EQ(ReadAll("a,b,c\r\n1, -2.5 ,3e-3\r\n4,5,6\r\n"), expected);
  EXPECT_EQ(ReadAll("a;b;c\n1;-2,5;3e-3\n4;5;6"), expected);
  EXPECT_EQ(ReadAll("1\t-2.5\t3e-3\n4\t5\t6\n"), expected);
  EXPECT_EQ(ReadAll("\xEF\xBB\xBF  1   -2.5 +3e-3\n\n# said by hand\n4 5  6  \n"), expected);
}

TEST(CsvReader, TakesASeparatorInQuotesForText) {
  CsvReader reader("in.csv", TextSource("time_s,\"note; or so\",a,b\n0,\"fist, slow\",1,2\n"),
                   ProblemHandling::kStrict);
  EXPECT_THAT(reader.header(), ElementsAre("time_s", "note; or so", "a", "b"));
  std::vector<std::string> cells;
  ASSERT_TRUE(reader.NextRow(cells));
  EXPECT_THAT(cells, ElementsAre("0", "fist, slow", "1", "2"));
  // Which of 1234 and 1.234 this is, nobody knows.
  EXPECT_EQ(ErrorOf("a,b\n\"1,234\",2\n"), "in.csv:2:1: '\"1,234\"' is not a number");
  EXPECT_EQ(SeparatorOf("\"time s\" \"a b\""), ' ');
  EXPECT_EQ(SeparatorOf("6\" drum;a"), ';');
}

TEST(CsvReader, JoinsLinesWithinQuotes) {
  CsvReader reader("in.csv", TextSource("\"time\r\n(s)\",\"a\n\n\"\"b\"\"\"\n0,1\n\n2,x\n"),
                   ProblemHandling::kRepair);
  EXPECT_THAT(reader.header(), ElementsAre("time (s)", "a  \"\"b\"\""));
  std::vector<double> row(2);
  ASSERT_TRUE(reader.NextRow(row));
  EXPECT_THAT(row, ElementsAre(0.0, 1.0));
  EXPECT_EQ(reader.row(), 5u);
  ASSERT_TRUE(reader.NextRow(row));
  EXPECT_EQ(reader.row(), 7u);
  EXPECT_EQ(ErrorOf("a,\"note\non two\"\n1,2\n\"one\ncell\",x\n"),
            "in.csv:4:1: '...' is not a number");
  // Sixteen lines at most.
  const auto names_over = [](int lines) {
    std::string text = "\"a";
    for (int i = 1; i < lines; ++i) text += "\nx";
    return CsvReader("in.csv", TextSource(text + "\",b\n1,2\n"), ProblemHandling::kRepair)
        .header()
        .size();
  };
  EXPECT_EQ(names_over(16), 2U);
  EXPECT_EQ(names_over(17), 1U);
  // A quote that nothing closes is a letter, as is one within a cell or a comment.
  EXPECT_EQ(ErrorOf("a,b\n\"1,2\n3,4\n"), "in.csv:2:1: '\"1' is not a number");
  EXPECT_EQ(ErrorOf("6\" drum,b\n1,2\n3,4\" x\n"), "in.csv:3:2: '...' is not a number");
  EXPECT_EQ(ReadAll("# \"said\n1,2\n# so\"\n3,4\n"),
            (std::vector<std::vector<double>>{{1, 2}, {3, 4}}));
  EXPECT_EQ(ReadAll("\"a,b\n1,2\n3,4\n").size(), 2u);
}

TEST(CsvReader, GivesItsFirstRowsAgain) {
  CsvReader reader("in.csv", TextSource("a,b\n1,2,\n3\n4,x\n# here\n5,6\n7,8\n"),
                   ProblemHandling::kRepair);
  using Rows = std::vector<std::vector<std::string>>;
  EXPECT_EQ(reader.FirstRows(9, 6), (Rows{{"1", "2"}, {"4", "x"}, {"5", "6"}}));
  EXPECT_EQ(reader.FirstRows(1, 9), (Rows{{"1", "2"}}));
  std::vector<double> row(2);
  std::vector<std::size_t> lines;
  while (reader.NextRow(row)) lines.push_back(reader.row());
  EXPECT_THAT(lines, ElementsAre(2, 3, 4, 6, 7));
  std::vector<double> wide(3);
  EXPECT_THROW(reader.NextRow(wide), std::logic_error);
}

TEST(CsvReader, TakesTheFirstLineAsNamesOnlyIfItHoldsText) {
  CsvReader named("in.csv", TextSource("\"time_s\",index mcp\n0,1\n"), ProblemHandling::kStrict);
  EXPECT_THAT(named.header(), ElementsAre("time_s", "index mcp"));
  CsvReader unnamed("in.csv", TextSource("0,1\n"), ProblemHandling::kStrict);
  EXPECT_TRUE(unnamed.header().empty());
}

TEST(CsvReader, NamesFileRowAndColumnOfEveryMistake) {
  EXPECT_EQ(ErrorOf("a,b\n1,2\n3,oops\n"), "in.csv:3:2: 'oops' is not a number");
  EXPECT_EQ(ErrorOf("a,b\n1,2\n3\n"), "in.csv:3:1: the row has 1 of 2 values");
  EXPECT_EQ(ErrorOf("a,b\n1,2\n1,2,3\n"), "in.csv:3:3: the row has more than 2 values");
  EXPECT_EQ(ErrorOf("a,b\n1,2,3\n"), "in.csv:1:2: the header has 2 names for 3 values");
  EXPECT_EQ(ErrorOf("a,b\n1,\n"), "in.csv:2:2: the value is missing");
  EXPECT_EQ(ErrorOf("a,b\n1,nan\n"), "in.csv:2:2: the value is missing (nan)");
  EXPECT_EQ(ErrorOf("a,b\n1,1e999\n"), "in.csv:2:2: '1e999' is not a finite number");
  EXPECT_EQ(ErrorOf("a,b\n1,inf\n"), "in.csv:2:2: 'inf' is not a finite number");
  EXPECT_EQ(ErrorOf("a,b\n1,2 3\n"), "in.csv:2:2: '2 3' is not a number");
  EXPECT_EQ(ErrorOf(""), "in.csv:1:1: the file holds no data");
  EXPECT_EQ(ErrorOf("\r\n\n"), "in.csv:1:1: the file holds no data");
  EXPECT_EQ(ErrorOf(std::string("a,b\n1,\0\x01\n", 9)), "in.csv:2:2: '\\x00\\x01' is not a number");
}

TEST(CsvReader, StopsAtALineWithoutEnd) {
  const std::string endless(3 << 20, '7');
  EXPECT_THAT(ErrorOf("a,b\n" + endless), HasSubstr("in.csv:2:1: the line is longer than"));
  // With its end a line has a megabyte at most.
  constexpr std::size_t kLongest = (std::size_t{1} << 20) - 1;
  const std::string begin = "1,2\n", zeros(kLongest - 2, '0');
  EXPECT_EQ(ReadAll(begin + "1," + zeros + "\n3,4\n").size(), 3U);
  EXPECT_THAT(ErrorOf(begin + "1,0" + zeros + "\n3,4\n"),
              HasSubstr("in.csv:2:1: the line is longer than 1048576 bytes"));
}

TEST(Pchip, KeepsOrderOfConvergenceOnAMonotoneCurve) {
  const auto worst_error = [](int points) {
    std::vector<double> t, y;
    for (int i = 0; i < points; ++i) {
      t.push_back(2.0 * i / (points - 1));
      y.push_back(std::exp(t.back()));
    }
    std::vector<double> result(20001);
    InterpolatePchip(t, y, 0.0, 10000.0, result);
    double worst = 0.0;
    for (std::size_t i = 0; i < result.size(); ++i) {
      worst = std::max(worst, std::abs(result[i] - std::exp(static_cast<double>(i) / 10000.0)));
    }
    return worst;
  };
  // The harmonic mean of two secants is a second-order slope, so the curve is of third order.
  const double order = std::log2(worst_error(41) / worst_error(81));
  EXPECT_GT(order, 2.8);
  EXPECT_LT(worst_error(81), 1e-4);
}

TEST(Pchip, NeverLeavesTheIntervalOfItsNeighbours) {
  const std::vector<double> t = {0, 0.1, 0.15, 0.4, 0.5, 0.9, 1.0};
  const std::vector<double> y = {0, 0, 10, 10, 3, 3.5, -20};
  std::vector<double> result(1001);
  InterpolatePchip(t, y, 0.0, 1000.0, result);
  std::size_t k = 0;
  for (int i = 0; i <= 1000; ++i) {
    while (k + 2 < t.size() && t[k + 1] <= i / 1000.0) ++k;
    EXPECT_GE(result[i], std::min(y[k], y[k + 1]) - 1e-12) << i;
    EXPECT_LE(result[i], std::max(y[k], y[k + 1]) + 1e-12) << i;
  }
  EXPECT_EQ(result[100], 0.0);
  EXPECT_EQ(result[400], 10.0);
}

TEST(Pchip, IsALineThroughTwoOrMorePointsOfIt) {
  for (const std::vector<double>& t : {std::vector<double>{0, 4}, {0, 1, 4}, {0, 1, 3, 4}}) {
    std::vector<double> y, result(9);
    for (const double at : t) y.push_back(3.0 - 2.0 * at);
    InterpolatePchip(t, y, 0.0, 2.0, result);
    for (std::size_t i = 0; i < result.size(); ++i) {
      EXPECT_NEAR(result[i], 3.0 - static_cast<double>(i), 1e-12) << t.size();
    }
  }
}

TEST(Pchip, IsThatOfScipy) {  // PchipInterpolator of scipy 1.10.1, every half second
  const struct {
    std::vector<double> time_s, value, expected;
  } known[] = {
      {{0, 1, 1.5, 3, 4, 7, 8},
       {0, 2, 5, 6, 4, 4.5, 9},
       {0, 0.602941176471, 2, 5, 5.56695156695, 5.89458689459, 6, 5, 4, 4.01062858633,
        4.04512258738, 4.1073943662, 4.20135628586, 4.33092070944, 4.5, 6.0996185446, 9}},
      {{0, 1, 3}, {0, 4, 5}, {0, 2.52421171171, 4, 4.42989864865, 4.74324324324, 4.93496621622, 5}},
      {{0, 1, 3}, {0, 1, -8}, {0, 0.854166666667, 1, 0.359375, -1.45833333333, -4.296875, -8}},
      {{0, 1, 3},
       {0, 0.2, 8},
       {0, 0.0567733990148, 0.2, 0.919134852217, 2.5947865353, 5.02304495074, 8}},
  };
  for (const auto& [time_s, value, expected] : known) {
    std::vector<double> result(expected.size());
    InterpolatePchip(time_s, value, 0.0, 2.0, result);
    for (std::size_t i = 0; i < result.size(); ++i) EXPECT_NEAR(result[i], expected[i], 1e-10) << i;
  }
}

TEST(Pchip, HoldsTheEndsBeyondTheData) {
  std::vector<double> result(5);
  InterpolatePchip(std::vector<double>{1, 2}, std::vector<double>{3, 5}, 0.0, 1.0, result);
  EXPECT_THAT(result, ElementsAre(3, 3, 5, 5, 5));
}

class RecordingFile : public ::testing::Test {
 protected:
  void Write(std::string_view text) { std::ofstream(path_, std::ios::binary) << text; }
  std::string LoadError() {
    try {
      LoadRecording(path_, {});
    } catch (const UserError& error) {
      return error.what();
    }
    return "no error";
  }
  const test::TemporaryDirectory folder_;
  const std::filesystem::path path_ = folder_.path() / "in.csv";
};

TEST_F(RecordingFile, GivesAnglesInRadiansUnderTheChannelsNames) {
  Write("time_s,elbow_flexion,index_mcp\n0,90,-45\n0.01,120,45\n");
  const Recording recording = LoadRecording(path_, {});
  EXPECT_EQ(recording.angle_rad.rows(), 2);
  EXPECT_NEAR(recording.angle_rad(0, ChannelIndex("elbow_flexion")), 1.5707963267948966, 1e-15);
  EXPECT_NEAR(recording.angle_rad(1, ChannelIndex("index_mcp")), 0.78539816339744828, 1e-15);
  EXPECT_FALSE(recording.has_channel[ChannelIndex("index_pip")]);
}

TEST_F(RecordingFile, RejectsWhatCannotBeARecording) {
  EXPECT_EQ(LoadError(), path_.string() + ": no such file");
  Write("time_s,index_mpc\n0,1\n");
  EXPECT_EQ(LoadError(),
            path_.string() + ":1:2: unknown column 'index_mpc' (did you mean index_mcp?)");
  Write("time_s,index_mcp\n0,1\n0.01,2\n0.01,3\n");
  EXPECT_EQ(LoadError(),
            path_.string() + ":4:1: the time is 0.01 s, must be above 0.01 s of the row before");
  Write("index_mcp\n1\n2\n");
  EXPECT_EQ(LoadError(), path_.string() +
                             ":1:1: there is no column of time; without one file_rate_hz must be "
                             "given");
  Write("time_s,index_mcp,index_mcp\n0,1,1\n");
  EXPECT_EQ(LoadError(), path_.string() + ":1:3: index_mcp appears twice");
}

TEST(DoorOpening, LiesInsideTheJointRangesAndMovesEveryChannel) {
  const Recording recording = LoadRecording(
      std::filesystem::path(SourceDir()) / "scenarios/recordings/door_opening/angles.csv", {});
  EXPECT_GT(recording.time_s.back(), 10.0);
  for (std::size_t channel = 0; channel < GloveChannels().size(); ++channel) {
    const auto column = recording.angle_rad.col(static_cast<Eigen::Index>(channel)) * kDegPerRad;
    EXPECT_TRUE(recording.has_channel[channel]);
    EXPECT_GE(column.minCoeff(), GloveChannels()[channel].min_deg - 1e-9);
    EXPECT_LE(column.maxCoeff(), GloveChannels()[channel].max_deg + 1e-9);
    EXPECT_GT(column.maxCoeff() - column.minCoeff(), 5.0) << GloveChannels()[channel].name;
  }
}

}  // namespace
}  // namespace gauntlet::sim
