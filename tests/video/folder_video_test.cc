// What a video shows of an output folder.
#include "sim/show/video/folder_video.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <numbers>
#include <optional>
#include <utility>
#include <vector>

#include "sim/answers/compare/study_files.h"
#include "sim/answers/compare/summary.h"
#include "sim/base/quantile.h"
#include "sim/show/video/comparison_picture.h"
#include "sim/show/video/hand_view.h"
#include "sim/show/video/osmesa_renderer.h"
#include "sim/study/scenario/scenario_reader.h"
#include "sim/study/study_run.h"
#include "tests/support/source_dir.h"
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
  WriteStudyFiles(folder, finished);
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

/// One run of the door with its baseline, its tuned Kalman filter and its prediction.
class DoorVideo {
 public:
  DoorVideo() {
    FinishedStudy finished;
    finished.folder = folder_.path();
    Scenario scenario = LoadScenario(SourceDir() + "/scenarios/door_opening.yaml", {});
    KeepControllers({"raw", "tuned_kalman", "prediction"}, scenario);
    finished.study = PrepareStudy(std::move(scenario));
    finished.result = RunStudy(finished.study, {.keep_first_traces = true});
    finished.summary = Summarise(finished.study, finished.result);
    WriteStudyFiles(folder_.path(), finished);
    video_.emplace(RenderOptions{.folder = folder_.path(),
                                 .controllers = {"raw", "tuned_kalman", "prediction"}});
  }
  const FolderVideo& video() const { return *video_; }
  VideoInput again() const {
    VideoInput input = video_->input();
    input.excerpt = input.again.value();
    return input;
  }

 private:
  TemporaryFolder folder_;
  std::optional<FolderVideo> video_;
};

const DoorVideo& Door() {
  static const DoorVideo door;
  return door;
}

/// Rows of a picture between the highest and the lowest pixel of the hand.
int HeightIn(const Image& picture) {
  int top = picture.height_px, bottom = -1;
  for (int y = 0; y < picture.height_px; ++y) {
    const std::uint32_t* row = picture.Row(y);
    const bool any = std::any_of(row, row + picture.width_px,
                                 [](std::uint32_t pixel) { return pixel >> 24 > 127; });
    if (any) top = std::min(top, y), bottom = y;
  }
  return bottom - top + 1;
}

// Palm and fingers, without the arm.
TEST(DoorVideo, EachHandFillsMostOfItsPicture) {
  const VideoInput& input = Door().video().input();
  const HandModel& hand = Door().video().hand();
  const ComparisonPicture picture(input);
  const HandView view(input, hand, picture.view_width_px(), picture.view_height_px());
  OsmesaRenderer renderer(hand.model(), view.RendererOf(input));
  const DataOfModel data = MakeData(hand);
  Image drawn;
  for (const VideoPane& pane : input.panes) {
    std::vector<double> heights;
    for (int frame = 0; frame < picture.frame_count(); frame += 5) {
      const int sample = picture.clock().Sample(frame);
      SetWearer(input, hand, sample, *data);
      renderer.SetWindow(view.WindowAt(*data));
      SetPane(pane, hand, sample, *data);
      renderer.DrawBodies(*data, view.bodies(), drawn);
      heights.push_back(HeightIn(drawn));
    }
    EXPECT_GE(Quantile(heights, 0.5), 0.6 * picture.view_height_px()) << pane.title;
  }
}

/// Of a fingertip above 10 Hz in slow motion, in pixels of its magnified picture: the largest
/// extent along any direction.
double JitterOf(const VideoInput& input, const HandView& view, int pane) {
  const FingertipPath& path = view.fingertip(pane);
  const int begin = path.IndexAt(input.excerpt.from_s), end = path.IndexAt(input.excerpt.to_s);
  double largest_px = 0.0;
  for (double angle = 0.0; angle < std::numbers::pi; angle += 0.1) {
    double low = INFINITY, high = -INFINITY;
    for (int i = begin; i < end; ++i) {
      const auto& [tip, smooth] = path.places[i];
      const Point at = PixelOf(view.InsetAround({0.0, 0.0}), {tip.x - smooth.x, tip.y - smooth.y},
                               view.inset_px(), view.inset_px());
      const double along = std::cos(angle) * at.x + std::sin(angle) * at.y;
      low = std::min(low, along), high = std::max(high, along);
    }
    largest_px = std::max(largest_px, high - low);
  }
  return largest_px;
}

TEST(DoorVideo, SlowMotionShowsWhatATunedFilterTakesAway) {
  const VideoInput input = Door().again();
  const ComparisonPicture picture(input);
  const HandView view(input, Door().video().hand(), picture.view_width_px(),
                      picture.view_height_px(), picture.inset_px());
  const double raw_px = JitterOf(input, view, 0), tuned_px = JitterOf(input, view, 1);
  EXPECT_GE(raw_px, 1.7 * tuned_px);
  EXPECT_GE(raw_px - tuned_px, 5.0);
  RecordProperty("raw_px", fmt::to_string(raw_px));
  RecordProperty("tuned_px", fmt::to_string(tuned_px));
}

// At the moment of the largest difference.
TEST(DoorVideo, SlowMotionShowsThatAPredictionIsLessBehindTheWearer) {
  const VideoInput input = Door().again();
  const HandModel& hand = Door().video().hand();
  const ComparisonPicture picture(input);
  const int width = picture.view_width_px(), height = picture.view_height_px();
  const HandView view(input, hand, width, height);
  const DataOfModel data = MakeData(hand);
  const int tip = mj_name2id(&hand.model(), mjOBJ_BODY, "index_distal");
  const int camera = *FindCamera(hand.model(), input.camera, width < height);
  double largest_px = 0.0;
  for (int frame = 0; frame < picture.frame_count(); ++frame) {
    const int sample = picture.clock().Sample(frame);
    SetWearer(input, hand, sample, *data);
    const CameraWindow window = view.WindowAt(*data).value();
    const auto place = [&] {
      const auto seen =
          SeenFrom(*data, camera, std::span<const mjtNum, 3>(data->xipos + 3 * tip, 3));
      return PixelOf(window, seen.value().tangents, width, height);
    };
    const Point wearer = place();
    double behind_px[3];
    for (int pane = 0; pane < 3; ++pane) {
      SetPane(input.panes[pane], hand, sample, *data);
      behind_px[pane] = std::hypot(place().x - wearer.x, place().y - wearer.y);
    }
    largest_px = std::max(largest_px, behind_px[0] - behind_px[2]);
  }
  EXPECT_GE(largest_px, 20.0);
  RecordProperty("largest_px", fmt::to_string(largest_px));
}

}  // namespace
}  // namespace gauntlet::sim
