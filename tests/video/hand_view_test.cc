#include "sim/show/video/hand_view.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>
#include <optional>

#include "tests/video/small_comparison.h"

namespace gauntlet::sim {
namespace {

constexpr int kWidth_px = 300;
constexpr int kHeight_px = 360;

double Distance(const Point& a, const Point& b) { return std::hypot(a.x - b.x, a.y - b.y); }

TEST(HandView, FingersThatMoveFillThePicture) {
  const SmallComparison comparison;
  const HandView view(comparison.input, TheHand(), kWidth_px, kHeight_px);
  const DataOfModel data = MakeData(TheHand());
  const mjModel& model = TheHand().model();
  const int camera = *FindCamera(model, comparison.input.camera, true);
  double left = 1e9, right = -1e9, top = 1e9, bottom = -1e9;
  for (int sample = 0; sample < SmallComparison::kSamples; sample += 50) {
    SetWearer(comparison.input, TheHand(), sample, *data);
    const auto window = view.WindowAt(*data);
    ASSERT_TRUE(window);
    for (const char* body : {"index_distal", "little_distal", "palm"}) {
      const int id = mj_name2id(&model, mjOBJ_BODY, body);
      ASSERT_GE(id, 0) << body;
      const auto seen =
          SeenFrom(*data, camera, std::span<const mjtNum, 3>(data->xipos + 3 * id, 3));
      const Point pixel = PixelOf(*window, seen->tangents, kWidth_px, kHeight_px);
      left = std::min(left, pixel.x), right = std::max(right, pixel.x);
      top = std::min(top, pixel.y), bottom = std::max(bottom, pixel.y);
    }
  }
  EXPECT_GT(left, 0.0);
  EXPECT_LT(right, kWidth_px);
  EXPECT_GT(top, 0.0);
  EXPECT_LT(bottom, kHeight_px);
  // From the middle of the last phalanx to that of the palm is less than the hand.
  EXPECT_GT(std::max((right - left) / kWidth_px, (bottom - top) / kHeight_px), 0.5);
}

/// The window at the first sample.
std::optional<CameraWindow> FirstWindow(const VideoInput& input) {
  const DataOfModel data = MakeData(TheHand());
  SetWearer(input, TheHand(), 0, *data);
  return HandView(input, TheHand(), kWidth_px, kHeight_px).WindowAt(*data);
}

// Four fingers bend at their first joint: all with the palm, without it, and the index alone.
TEST(HandView, FramesTheFingersOrTheOneOfTheChannel) {
  SmallComparison comparison;
  const auto size_of = [&](const char* camera) {
    comparison.input.camera = camera;
    return FirstWindow(comparison.input).value().height();
  };
  const double hand = size_of("hand"), fingers = size_of("fingers"), finger = size_of("close_up");
  EXPECT_LT(fingers, 0.95 * hand);
  EXPECT_LT(finger, 0.95 * fingers);
}

TEST(HandView, WhereTheChannelIsOfNoFingerACloseUpShowsWhatMoves) {
  SmallComparison comparison;
  Signal bent = Signal::Zero(SmallComparison::kSamples, std::ssize(kChannels));
  const auto wrist = std::ranges::find(kChannels, "wrist_flexion") - kChannels.begin();
  ASSERT_LT(wrist, std::ssize(kChannels));
  for (int i = 0; i < SmallComparison::kSamples; ++i) bent(i, wrist) = 0.001 * i;
  comparison.input.true_angle_rad = &bent;
  for (VideoPane& pane : comparison.input.panes) pane.hand_angle_rad = &bent;
  comparison.input.joint = static_cast<int>(wrist);
  comparison.input.camera = "hand";
  const auto hand = FirstWindow(comparison.input);
  comparison.input.camera = "close_up";
  const auto close_up = FirstWindow(comparison.input);
  ASSERT_TRUE(hand && close_up);
  EXPECT_EQ(close_up->height(), hand->height());
}

TEST(HandView, NothingIsFramedWhereNothingMoves) {
  SmallComparison comparison;
  const Signal still = Signal::Zero(SmallComparison::kSamples, std::ssize(kChannels));
  comparison.input.true_angle_rad = &still;
  for (VideoPane& pane : comparison.input.panes) pane.hand_angle_rad = &still;
  EXPECT_FALSE(FirstWindow(comparison.input));
  const HandView view(comparison.input, TheHand(), kWidth_px, kHeight_px, 100);
  EXPECT_TRUE(view.fingertip(0).places.empty());
  comparison.input.camera.clear();
  EXPECT_FALSE(FirstWindow(comparison.input));
}

// The wrist turns and the fingers stand: the palm stays where it is in the picture.
TEST(HandView, FollowsThePalm) {
  SmallComparison comparison;
  Signal bent = *comparison.input.true_angle_rad;
  const auto wrist = std::ranges::find(kChannels, "wrist_flexion") - kChannels.begin();
  for (int i = 0; i < SmallComparison::kSamples; ++i) bent(i, wrist) = 0.001 * i;
  comparison.input.true_angle_rad = &bent;
  for (VideoPane& pane : comparison.input.panes) pane.hand_angle_rad = &bent;
  const HandView view(comparison.input, TheHand(), kWidth_px, kHeight_px);
  const DataOfModel data = MakeData(TheHand());
  const int palm = mj_name2id(&TheHand().model(), mjOBJ_BODY, "palm");
  const int camera = *FindCamera(TheHand().model(), comparison.input.camera, true);
  const auto palm_at = [&](int sample) {
    SetWearer(comparison.input, TheHand(), sample, *data);
    const auto seen = SeenFrom(*data, camera, std::span<const mjtNum, 3>(data->xpos + 3 * palm, 3));
    return PixelOf(*view.WindowAt(*data), seen->tangents, kWidth_px, kHeight_px);
  };
  const Point first = palm_at(0);
  EXPECT_LT(Distance(palm_at(499), first), 1e-6);
}

// 0.005 rad at 20 Hz during a slow bend: far from the ends, the fingertip moves in its picture by
// the length of the finger times that angle and the magnification.
TEST(HandView, WhatMovesAtAMagnifiedFingertipIsItsJitter) {
  constexpr int kSamples = 4000, kInset_px = 100;
  constexpr double kAmplitude_rad = 0.005;
  SmallComparison comparison;
  Signal smooth = Signal::Zero(kSamples, std::ssize(kChannels));
  Signal spools = smooth;
  for (int i = 0; i < kSamples; ++i) {
    smooth(i, 4) = 0.5 - 0.5 * std::cos(2.0 * std::numbers::pi * i / kSamples);
  }
  Signal shaking = smooth;
  for (int i = 0; i < kSamples; ++i) {
    shaking(i, 4) += kAmplitude_rad * std::sin(2.0 * std::numbers::pi * 20.0 * i / 1000.0);
  }
  comparison.input.true_angle_rad = &smooth;
  comparison.input.panes = {comparison.PaneOf("a", shaking, 1), comparison.PaneOf("b", smooth, 2)};
  for (VideoPane& pane : comparison.input.panes) pane.spool_angle_rad = &spools;
  comparison.input.excerpt = {.from_s = 1.5, .to_s = 2.5, .speed = 0.25};
  const HandView view(comparison.input, TheHand(), kWidth_px, kHeight_px, kInset_px);
  const auto reach_px = [&](int pane) {
    const FingertipPath& path = view.fingertip(pane);
    EXPECT_EQ(path.rate_hz, 250.0);
    double low = 1e9, high = -1e9;
    for (int i = path.IndexAt(1.5); i <= path.IndexAt(2.4); ++i) {
      const auto& [tip, without] = path.places[i];
      const Point at = PixelOf(view.InsetAround({0.0, 0.0}), {tip.x - without.x, tip.y - without.y},
                               kInset_px, kInset_px);
      const double along =
          Distance(at, {0.5 * kInset_px, 0.5 * kInset_px}) * (at.y > 0.5 * kInset_px ? 1.0 : -1.0);
      low = std::min(low, along), high = std::max(high, along);
    }
    return high - low;
  };
  EXPECT_LT(reach_px(1), 0.01);
  // A finger of some 0.09 m; the window of 360 px shows some 0.25 m of it.
  const double expected_px = 2.0 * kAmplitude_rad * 0.09 / 0.25 * kHeight_px * 5.0;
  EXPECT_GT(reach_px(0), 0.4 * expected_px);
  EXPECT_LT(reach_px(0), 2.0 * expected_px);
}

}  // namespace
}  // namespace gauntlet::sim
