// What a video shows of an output folder.
#include "sim/video/folder_video.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <numbers>

#include "sim/comparison/study_files.h"
#include "sim/comparison/summary.h"
#include "sim/scenario/scenario_reader.h"
#include "sim/study/study_run.h"
#include "sim/video/comparison_picture.h"
#include "tests/video/test_files.h"

namespace gauntlet::sim {
namespace {

/// A run of one controller on a recording of one finger that swings for 8 s, of which two seconds
/// are missing.
FinishedStudy RunWithGap(const std::filesystem::path& folder) {
  {
    std::ofstream rows(folder / "glove.csv");
    rows << "time_s,index_mcp,index_pip\n";
    for (int i = 0; i < 800; ++i) {
      const double t = 0.01 * i;
      if (t > 3.0 && t < 5.0) continue;
      const auto swing = [t](double hz) { return std::sin(2.0 * std::numbers::pi * hz * t); };
      rows << fmt::format("{:.2f},{:.3f},{:.3f}\n", t, 30.0 + 30.0 * swing(0.23),
                          50.0 + 40.0 * swing(0.31));
    }
  }
  FinishedStudy finished;
  finished.folder = folder;
  finished.study = PrepareStudy(ParseScenario(
      {.file = folder / "s.yaml",
       .text = "question: Same?\n"
               "glove:\n  rate_hz: 100\n  channels: [index_mcp, index_pip]\n  noise: none\n"
               "  motion: {kind: recording, file: glove.csv, use: measured, problems: repair}\n"
               "controllers:\n  raw: {filter: none}\n"}));
  finished.result = RunStudy(finished.study, {.keep_first_traces = true});
  finished.summary = Summarise(finished.study, finished.result);
  WriteStudyFiles(folder, finished, false);
  return finished;
}

TEST(FolderVideo, NumbersEndAtThoseOfTheTableWhereTheRecordingHasAGap) {
  const TemporaryFolder folder;
  const FinishedStudy finished = RunWithGap(folder.path());
  const std::vector<double>& table = finished.result.seeds[0].controllers[0].scores.summary;
  const FolderVideo video({.folder = folder.path()});
  ASSERT_EQ(video.input().counted.size(), 2u);
  EXPECT_LT(CountOf(video.input().counted[0]), 6000);  // of 8000 ticks
  const ComparisonPicture picture(video.input());
  EXPECT_NEAR(picture.scores(0).tracking_rmse_deg.back(), table[MetricIndex("tracking_rmse_deg")],
              1e-5);
  EXPECT_NEAR(picture.scores(0).jitter_rms_deg.back(), table[MetricIndex("jitter_rms_deg")], 1e-5);
  // With the gap it would be another number.
  VideoInput whole = video.input();
  whole.counted.clear();
  EXPECT_GT(std::abs(ComparisonPicture(whole).scores(0).tracking_rmse_deg.back() -
                     table[MetricIndex("tracking_rmse_deg")]),
            0.1);
}

}  // namespace
}  // namespace gauntlet::sim
