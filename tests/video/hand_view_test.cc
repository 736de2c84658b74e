#include "sim/video/hand_view.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>

#include "tests/video/small_comparison.h"

namespace gauntlet::sim {
namespace {

constexpr int kWidth_px = 300;
constexpr int kHeight_px = 360;

double Distance(const Point& a, const Point& b) { return std::hypot(a.x - b.x, a.y - b.y); }

TEST(HandView, FingersThatMoveFillThePicture) {
  const SmallComparison comparison;
  const HandView view(comparison.input, TheHand(), kWidth_px, kHeight_px);
  ASSERT_TRUE(view.window());
  const DataOfModel data = MakeData(TheHand());
  const mjModel& model = TheHand().model();
  const int camera = *FindCamera(model, comparison.input.camera, true);
  double left = 1e9, right = -1e9, top = 1e9, bottom = -1e9;
  for (int sample = 0; sample < SmallComparison::kSamples; sample += 50) {
    SetWearer(comparison.input, TheHand(), sample, *data);
    for (const char* body : {"index_distal", "little_distal", "palm"}) {
      const int id = mj_name2id(&model, mjOBJ_BODY, body);
      ASSERT_GE(id, 0) << body;
      const auto seen =
          SeenFrom(*data, camera, std::span<const mjtNum, 3>(data->xipos + 3 * id, 3));
      const Point pixel = PixelOf(*view.window(), seen->tangents, kWidth_px, kHeight_px);
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

// Four fingers bend at their first joint: all with the palm, without it, and the index alone.
TEST(HandView, FramesTheFingersOrTheOneOfTheChannel) {
  SmallComparison comparison;
  const auto size_of = [&](const char* camera) {
    comparison.input.camera = camera;
    const HandView view(comparison.input, TheHand(), kWidth_px, kHeight_px);
    return view.window().value().height();
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
  const auto hand = HandView(comparison.input, TheHand(), kWidth_px, kHeight_px).window();
  comparison.input.camera = "close_up";
  const auto close_up = HandView(comparison.input, TheHand(), kWidth_px, kHeight_px).window();
  ASSERT_TRUE(hand && close_up);
  EXPECT_EQ(close_up->height(), hand->height());
}

TEST(HandView, NothingIsFramedWhereNothingMoves) {
  SmallComparison comparison;
  const Signal still = Signal::Zero(SmallComparison::kSamples, std::ssize(kChannels));
  comparison.input.true_angle_rad = &still;
  for (VideoPane& pane : comparison.input.panes) pane.hand_angle_rad = &still;
  const HandView view(comparison.input, TheHand(), kWidth_px, kHeight_px);
  EXPECT_FALSE(view.window());
  EXPECT_TRUE(view.fingertip(0).points.empty());
  comparison.input.camera.clear();
  EXPECT_FALSE(HandView(comparison.input, TheHand(), kWidth_px, kHeight_px).window());
}

TEST(HandView, FingertipsOfHandsThatFollowAreTheWearers) {
  const SmallComparison comparison;
  const HandView view(comparison.input, TheHand(), kWidth_px, kHeight_px);
  const FingertipWay& wearer = view.wearers_fingertip();
  EXPECT_EQ(wearer.rate_hz, 250.0);
  ASSERT_EQ(wearer.points.size(), 125u);
  for (std::size_t i = 0; i < wearer.points.size(); ++i) {
    EXPECT_LT(Distance(view.fingertip(0).points[i], wearer.points[i]), 1e-6);
  }
  EXPECT_GT(Distance(view.fingertip(1).points[62], wearer.points[62]), 5.0);  // bends by half
}

// 0.02 deg at 20 Hz on the way of half a turn in 4 s: far from the ends the fingertip is as far off
// as with ten times that.
TEST(HandView, TremblingIsDrawnTenTimesAsLarge) {
  constexpr int kSamples = 4000;
  constexpr double kAmplitude_rad = 0.02 * std::numbers::pi / 180.0;
  SmallComparison comparison;
  Signal smooth = Signal::Zero(kSamples, std::ssize(kChannels));
  Signal spools = smooth;
  for (int i = 0; i < kSamples; ++i) {
    smooth(i, 4) = 0.5 - 0.5 * std::cos(2.0 * std::numbers::pi * i / kSamples);
  }
  Signal trembling = smooth, tenfold = smooth;
  for (int i = 0; i < kSamples; ++i) {
    const double wave = std::sin(2.0 * std::numbers::pi * 20.0 * i / 1000.0);
    trembling(i, 4) += kAmplitude_rad * wave;
    tenfold(i, 4) += HandView::kTremblingGain * kAmplitude_rad * wave;
  }
  comparison.input.true_angle_rad = &tenfold;  // the wearer's is drawn as it is
  comparison.input.raw_angle_rad = &tenfold;
  comparison.input.panes = {{"a", &trembling, &spools, &trembling},
                            {"b", &smooth, &spools, &smooth}};
  const HandView view(comparison.input, TheHand(), kWidth_px, kHeight_px);
  double largest_px = 0.0;
  for (int i = 200; i < 800; ++i) {
    const Point& wearer = view.wearers_fingertip().points[i];
    EXPECT_LT(Distance(view.fingertip(0).points[i], wearer), 0.02) << i;
    largest_px = std::max(largest_px, Distance(view.fingertip(1).points[i], wearer));
  }
  EXPECT_GT(largest_px, 0.3);
}

}  // namespace
}  // namespace gauntlet::sim
