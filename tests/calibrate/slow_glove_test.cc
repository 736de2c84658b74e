// The trace of a slow glove has more rows than samples: the rows in between have no counts.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "sim/fit/pose_recording.h"
#include "tests/support/program.h"

namespace gauntlet::sim {
namespace {

/// Two poses of one second each; a row per millisecond, counts in every tenth but those from 500 to
/// 600 ms.
PoseRecording ReadSlowTrace() {
  std::string text = "t_s,counts.index_mcp,true_angle_rad.index_mcp\n";
  for (int k = 0; k < 2000; ++k) {
    const bool sample = k % 10 == 0 && (k < 500 || k >= 600);
    text += fmt::format("{},{},{}\n", 0.001 * k, sample ? "300" : "", k < 1000 ? 0.1 : 0.6);
  }
  const test::TemporaryDirectory folder;
  const std::filesystem::path file = folder.path() / "trace.csv";
  std::ofstream(file) << text;
  return LoadPoseRecording(file, {});
}

TEST(SlowGlove, HasTheRateOfItsSamples) {
  const PoseRecording recording = ReadSlowTrace();
  EXPECT_NEAR(recording.rate_hz, 100.0, 1e-6);
  EXPECT_EQ(recording.counts.rows(), 190);
  EXPECT_EQ(recording.rows_left_out, 10u) << "lost samples, not the rows in between";
}

TEST(SlowGlove, IsInPiecesWhereSamplesAreLost) {
  EXPECT_EQ(ReadSlowTrace().stretch_begins, (std::vector<Eigen::Index>{0, 50}));
}

// 33.3 Hz, whose times are written in whole ms, with a pause of 20 s.
TEST(SlowGlove, HasTheSameRateWithAPause) {
  std::string text = "time_ms,index_mcp_counts\n";
  for (int k = 0; k < 400; ++k) {
    text +=
        fmt::format("{},{}\n", std::lround(k * 1000.0 / 33.3) + (k < 150 ? 0 : 20'000), 300 + k);
  }
  const test::TemporaryDirectory folder;
  const std::filesystem::path file = folder.path() / "pause.csv";
  std::ofstream(file) << text;
  const PoseRecording recording = LoadPoseRecording(file, {});
  EXPECT_EQ(recording.stretch_begins, (std::vector<Eigen::Index>{0, 150}));
  EXPECT_NEAR(recording.rate_hz, 33.3, 0.01);
}

TEST(SlowGlove, PosesSettleAfterTheTimeThatWasAskedFor) {
  const PoseRecording recording = ReadSlowTrace();
  ASSERT_EQ(recording.angle_deg.cols(), 1);
  const auto settled = recording.angle_deg.col(0).array().isFinite();
  EXPECT_EQ(settled.head(90).count(), 70);  // 200 ms are 20 samples
  EXPECT_EQ(settled.tail(100).count(), 80);
}

}  // namespace
}  // namespace gauntlet::sim
