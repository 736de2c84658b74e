#include "sim/live/frame_channels.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <fstream>
#include <string>
#include <vector>

#include "sim/base/channels.h"
#include "sim/base/error.h"
#include "sim/base/signal.h"
#include "sim/recordings/recording_reader.h"
#include "tests/support/program.h"

namespace gauntlet::sim {
namespace {

FrameChannelsConfig TwoChannels() {
  FrameChannelsConfig config;
  config.glove = {.channel_names = {"index_mcp", "index_pip"},
                  .low_counts = {100.0, 200.0},
                  .high_counts = {900.0, 800.0},
                  .low_angle_rad = {0.0, 0.0},
                  .high_angle_rad = {80.0 * kRadPerDeg, 100.0 * kRadPerDeg}};
  config.source = "--glove test";
  return config;
}

std::string ProblemOf(const DeviceColumns& columns, const std::vector<double>& values) {
  FrameChannels channels(TwoChannels());
  try {
    channels.Counts(columns, 0.0, values);
  } catch (const UserError& error) {
    return error.what();
  }
  return "";
}

TEST(FrameChannels, PassesCountsInTheirOrderBesideNumberAndTime) {
  FrameChannels channels(TwoChannels());
  const DeviceColumns columns{
      .names = {}, .count = 4, .number = 0, .time = {{.column = 1}}, .version = 1};
  const std::array values = {17.0, 0.5, 512.0, kNaN};
  const auto counts = channels.Counts(columns, 0.0, values);
  EXPECT_EQ(counts[0], 512.0);
  EXPECT_TRUE(std::isnan(counts[1]));
}

TEST(FrameChannels, TakesChannelsByTheirNamesWhateverTheirOrder) {
  FrameChannels channels(TwoChannels());
  const DeviceColumns columns{
      .names = {"index_pip_counts", "index_mcp_deg"}, .count = 2, .version = 1};
  const auto counts = channels.Counts(columns, 0.0, std::array{300.0, 40.0});
  EXPECT_NEAR(counts[0], 500.0, 1e-9);
  EXPECT_NEAR(counts[1], 300.0, 1e-9);
}

TEST(FrameChannels, LeavesOutAColumnWithoutANameBesideOthers) {
  FrameChannels channels(TwoChannels());
  const DeviceColumns columns{
      .names = {"index_mcp_deg", "index_pip_counts", ""}, .count = 3, .version = 1};
  const auto counts = channels.Counts(columns, 0.0, std::array{40.0, 300.0, kNaN});
  EXPECT_NEAR(counts[0], 500.0, 1e-9);
  EXPECT_NEAR(counts[1], 300.0, 1e-9);
}

TEST(FrameChannels, AsksWhereTheNumberOfValuesIsNotThatOfTheGlove) {
  const std::string problem = ProblemOf({.names = {}, .count = 3, .version = 1}, {1.0, 2.0, 3.0});
  EXPECT_NE(problem.find("has 3 values, the glove has 2 channels; --map"), std::string::npos)
      << problem;
}

TEST(FrameChannels, SaysWhatItTakesTheColumnsFor) {
  struct Case {
    DeviceColumns columns;
    std::string says;  // as remark, else as error
  };
  const std::vector<double> values(3, 300.0);
  for (const Case& is : std::vector<Case>{
           {{.names = {}, .count = 2, .version = 1},
            "2 values a frame are the counts of index_mcp to index_pip in this order; --map says "
            "otherwise"},
           {{.names = {"frame", "x", ""}, .count = 3, .number = 0, .version = 1},
            "2 values a frame (x) are the counts of index_mcp to index_pip in this order; --map "
            "says otherwise"},
           {{.names = {"x"}, .count = 1, .version = 1},
            "--glove test: a frame has 1 value (x), the glove has 2 channels; --map FILE.csv names "
            "the channel of each column, and --set 'glove.channels=[..]' the channels of the "
            "glove"},
           {{.names = {"index_pip_deg", "thumb_ip_deg"}, .count = 2, .version = 1},
            "--glove test: no column gives index_mcp; a glove without them: --set "
            "'glove.channels=[index_pip]'"},
           {{.names = {"thumb_ip_deg", "ring_mcp_deg"}, .count = 2, .version = 1},
            "--glove test: no column gives index_mcp, index_pip; --map FILE.csv names the channel "
            "of each column"}}) {
    FrameChannels channels(TwoChannels());
    EXPECT_EQ(channels.remark(), "");
    std::string said;
    try {
      channels.Counts(is.columns, 0.0, std::span(values).first(is.columns.count));
      said = channels.remark();
    } catch (const UserError& error) {
      said = error.what();
    }
    EXPECT_EQ(said, is.says);
  }
}

TEST(FrameChannels, TakesNamesWithoutAUnitInTheUnitThatIsGiven) {
  for (const std::string unit : {"", "rad", "counts"}) {
    FrameChannelsConfig config = TwoChannels();
    config.unit = unit;
    FrameChannels channels(config);
    const DeviceColumns columns{.names = {"index_mcp", "index_pip"}, .count = 2, .version = 1};
    const double value = unit == "counts" ? 500.0 : unit == "rad" ? 40.0 * kRadPerDeg : 40.0;
    EXPECT_NEAR(channels.Counts(columns, 0.0, std::array{value, value})[0], 500.0, 1e-9) << unit;
  }
}

TEST(FrameChannels, TakesCountsOfEachChannelsOwnConverter) {
  FrameChannelsConfig config = TwoChannels();
  config.glove.low_counts[1] = -1500.0;
  config.glove.full_scale_counts = {1023.0, 2047.0};
  config.glove.min_counts = {0.0, -2048.0};
  const test::TemporaryDirectory folder;
  config.map = (folder.path() / "map.csv").string();
  const auto counts = [&](int bits) {
    std::ofstream(config.map) << "column,channel,unit,bits\n1,index_mcp,counts,10\n"
                              << "2,index_pip,counts," << bits << "\n";
    FrameChannels channels(config);
    const auto both =
        channels.Counts({.names = {}, .count = 2, .version = 1}, 0.0, std::array{700.0, -1700.0});
    EXPECT_EQ(both[0], 700.0);
    return both[1];
  };
  EXPECT_EQ(counts(12), -1700.0);
  EXPECT_NE(counts(10), -1700.0) << "counts of another converter";
}

TEST(FrameChannels, GivesTheEnvelopeThatARecordingHas) {
  FrameChannelsConfig config = TwoChannels();
  config.glove = {.channel_names = {"index_mcp"},
                  .low_counts = {100.0},
                  .high_counts = {900.0},
                  .low_angle_rad = {0.0},
                  .high_angle_rad = {80.0 * kRadPerDeg}};
  const test::TemporaryDirectory folder;
  config.map = (folder.path() / "map.csv").string();
  std::ofstream(config.map) << "column,channel,unit,raw_low,raw_high,envelope_ms\n"
                            << "1,time,s,,,\n2,index_mcp,counts,0,1,50\n";
  FrameChannels channels(config);
  const auto muscle = [](int k) { return (k % 2 == 0 ? 1.0 : -1.0) * (k < 150 ? 0.1 : 1.0); };
  std::string text;
  for (int k = 0; k < 300; ++k) text += fmt::format("{:.3f},{}\n", 1e-3 * k, muscle(k));
  RecordingFormat format;
  format.map = config.map;
  RecordingReader reader("in.csv", TextSource(text), format);
  std::vector<double> angle_rad(KnownChannels().size());
  double time_s = 0.0;
  double angle = 0.0;
  const DeviceColumns columns{.names = {}, .count = 2, .time = {{.column = 0}}, .version = 1};
  for (int k = 0; reader.NextRow(time_s, angle_rad); ++k) {
    // The stamps of a session have another origin.
    const auto counts = channels.Counts(columns, 77.0 + time_s, std::array{time_s, muscle(k)});
    angle = angle_rad[ChannelIndex("index_mcp")];
    ASSERT_NEAR((counts[0] - 100.0) / 800.0 * 80.0 * kRadPerDeg, angle, 1e-9) << k;
  }
  EXPECT_GT(angle, 20.0 * kRadPerDeg);
  EXPECT_NE(channels.remark().find("is the envelope of column 2"), std::string::npos);
}

TEST(FrameChannels, NamesTheGloveThatTheColumnsWouldFit) {
  const std::string problem =
      ProblemOf({.names = {"index_pip_deg"}, .count = 1, .version = 1}, {1.0});
  EXPECT_NE(problem.find("glove.channels=[index_pip]"), std::string::npos) << problem;
}

}  // namespace
}  // namespace gauntlet::sim
