#include "sim/live/session_recording.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <sstream>
#include <string>
#include <vector>

#include "sim/base/error.h"
#include "sim/base/unfinished_mark.h"
#include "tests/support/program.h"
#include "tests/support/read_file.h"

namespace gauntlet::test {
namespace {

using sim::GrowingFile;
using sim::SessionRecording;
using sim::UserError;

class SessionRecordingTest : public testing::Test {
 protected:
  std::filesystem::path File(const std::string& name) const { return folder_.path() / name; }
  /// Times in a recording [us].
  std::vector<long> Times_us(const std::string& name) const {
    std::istringstream text(ReadFile(File(name)));
    std::vector<long> times_us;
    std::string line;
    std::getline(text, line);
    while (std::getline(text, line)) times_us.push_back(std::lround(1e6 * std::stod(line)));
    return times_us;
  }

  controller::GloveCalibration glove_{.channel_names = {"index_mcp"},
                                      .low_counts = {0.0},
                                      .high_counts = {1000.0},
                                      .low_angle_rad = {0.0},
                                      .high_angle_rad = {1.0}};
  TemporaryDirectory folder_;
};

// A device that bundles three samples. Wrong: one of them is recorded, or three at one time.
TEST_F(SessionRecordingTest, SpreadsBundlesOverTheTimeBeforeThem) {
  SessionRecording recording(glove_, 0.010, {.angles = File("a.csv"), .counts = {}});
  for (const double time_s : {0.0, 0.012, 0.012, 0.012, 0.512, 0.512}) {
    recording.Add(time_s, std::vector<double>{500.0});
  }
  recording.End();
  EXPECT_EQ(Times_us("a.csv"), (std::vector<long>{0, 4000, 8000, 12000, 502000, 512000}));
  EXPECT_EQ(recording.facts().kept, 6);
  EXPECT_EQ(recording.facts().problem, "");
}

TEST_F(SessionRecordingTest, IsThereBeforeItsEnd) {
  SessionRecording recording(glove_, 0.010, {.angles = File("a.csv"), .counts = File("c.csv")});
  recording.Add(0.0, std::vector<double>{500.0});
  recording.Add(0.01, std::vector<double>{NAN});
  recording.Add(0.02, std::vector<double>{1000.0});  // may be one of a bundle
  recording.Note(0.01, "the hand is marked still");
  recording.Flush();
  EXPECT_EQ(ReadFile(File("c.csv")), "time_s,index_mcp_counts\n0.000000,500\n0.010000,\n");
  EXPECT_EQ(Times_us("a.csv"), (std::vector<long>{0, 10000}));
  const std::string mark = ReadFile(sim::UnfinishedMark(File("a.csv")));
  EXPECT_NE(mark.find("0.010000 s: the hand is marked still\n"), std::string::npos) << mark;
  recording.End();
  EXPECT_EQ(Times_us("c.csv"), (std::vector<long>{0, 10000, 20000}));
  EXPECT_FALSE(std::filesystem::exists(sim::UnfinishedMark(File("a.csv"))));
}

TEST_F(SessionRecordingTest, LeavesNothingWithoutASample) {
  { const SessionRecording recording(glove_, 0.010, {.angles = File("a"), .counts = File("c")}); }
  EXPECT_TRUE(std::filesystem::is_empty(folder_.path()));
}

TEST_F(SessionRecordingTest, StaysIfTheSessionFails) {
  {
    SessionRecording recording(glove_, 0.010, {.angles = File("a.csv"), .counts = {}});
    recording.Add(0.0, std::vector<double>{500.0});
  }
  EXPECT_EQ(Times_us("a.csv"), std::vector<long>{0});
}

TEST_F(SessionRecordingTest, ReplacesNothing) {
  std::filesystem::create_symlink("nowhere", File("link"));
  EXPECT_THROW(GrowingFile{File("link")}, UserError);
  EXPECT_THROW(GrowingFile{folder_.path()}, UserError);
  EXPECT_THROW(GrowingFile{File("missing/a.csv")}, sim::RunError);
}

// Memory is bounded, and the file has whole lines only.
TEST_F(SessionRecordingTest, HoldsWhatADiskDoesNotTake) {
  GrowingFile file(File("a"));
  const std::string line = std::string(GrowingFile::kMostWaitingBytes / 2, 'x') + "\n";
  EXPECT_TRUE(file.Add(line));
  EXPECT_FALSE(file.Add(line));
  file.Flush();
  EXPECT_EQ(file.lines(), 1);
  EXPECT_TRUE(file.Add(line));
  file.End();
  EXPECT_EQ(std::filesystem::file_size(File("a")), 2 * line.size());
}

}  // namespace
}  // namespace gauntlet::test
