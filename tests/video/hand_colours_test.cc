#include "sim/show/video/hand_colours.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/video/small_comparison.h"

namespace gauntlet::sim {
namespace {

constexpr int kMiddle = SmallComparison::kSamples / 2;  // bent most: 1 rad, the second hand 0.5 rad
constexpr double kOff_deg = 0.5 * 180.0 / std::numbers::pi;

float ShareOf(const SceneColours& colours, const char* body) {
  return colours.link_share[mj_name2id(&TheHand().model(), mjOBJ_BODY, body)];
}

// In the second pane 4 of 18 joints are off by up to 28.6 deg, more than 2 % of the time by more
// than 20.
TEST(HandColours, TheScaleIsAUsualStepThatHoldsAlmostAllErrors) {
  SmallComparison comparison;
  EXPECT_EQ(ColourScaleOf(comparison.input).full_error_deg, 30.0);
  comparison.input.measured_joints = {5, 7};  // these do not move
  EXPECT_EQ(ColourScaleOf(comparison.input).full_error_deg, 1.0);
}

TEST(HandColours, LinksSayHowFarTheirJointIsFromTheWearers) {
  const SmallComparison comparison;
  HandColours colours(comparison.input, TheHand(), {.full_error_deg = 30.0});
  for (const float share : colours.Of(0, kMiddle).link_share) EXPECT_EQ(share, 0.0f);
  const SceneColours off = colours.Of(1, kMiddle);
  EXPECT_NEAR(ShareOf(off, "index_proximal"), kOff_deg / 30.0, 1e-6);
  EXPECT_EQ(ShareOf(off, "index_middle"), 0.0f);  // its own joint follows
  EXPECT_EQ(ShareOf(off, "palm"), 0.0f);
  EXPECT_NEAR(ShareOf(colours.Of(1, 0), "index_proximal"), 0.0, 1e-6);
}

TEST(HandColours, NoMoreThanTheFullColour) {
  const SmallComparison comparison;
  HandColours colours(comparison.input, TheHand(), {.full_error_deg = 5.0});
  EXPECT_EQ(ShareOf(colours.Of(1, kMiddle), "index_proximal"), 1.0f);
}

TEST(HandColours, LinksWithoutAMeasuredJointAreAsWhatCarriesThem) {
  SmallComparison comparison;
  comparison.input.measured_joints = {4};
  HandColours colours(comparison.input, TheHand(), {.full_error_deg = 30.0});
  const SceneColours off = colours.Of(1, kMiddle);
  EXPECT_NEAR(ShareOf(off, "index_distal"), kOff_deg / 30.0, 1e-6);
  EXPECT_EQ(ShareOf(off, "middle_proximal"), 0.0f);
}

TEST(HandColours, NothingIsSaidWhereTheWearerIsNotKnown) {
  SmallComparison comparison;
  comparison.input.measured_joints = {4, 6};
  comparison.input.counted = {{{.begin = 0, .end = kMiddle}},
                              {{.begin = 0, .end = SmallComparison::kSamples}}};
  HandColours colours(comparison.input, TheHand(), {.full_error_deg = 30.0});
  EXPECT_GT(ShareOf(colours.Of(1, kMiddle - 1), "index_proximal"), 0.9f);
  EXPECT_EQ(ShareOf(colours.Of(1, kMiddle), "index_proximal"), 0.0f);
  EXPECT_GT(ShareOf(colours.Of(1, kMiddle), "middle_proximal"), 0.9f);
}

TEST(HandColours, CablesSayHowTheyPull) {
  SmallComparison comparison;
  const auto cables = std::ssize(TheHand().cable_names());
  EXPECT_EQ(ColourScaleOf(comparison.input).largest_tension_n, 0.0);
  HandColours unknown(comparison.input, TheHand(), {});
  EXPECT_TRUE(unknown.Of(0, 0).cable_share.empty());

  Signal tension_n = Signal::Zero(SmallComparison::kSamples, cables);
  tension_n(0, 0) = 8.0;
  tension_n(0, 1) = 2.0;
  comparison.input.panes[1].tension_n = &tension_n;
  const ColourScale scale = ColourScaleOf(comparison.input);
  EXPECT_EQ(scale.largest_tension_n, 8.0);
  HandColours colours(comparison.input, TheHand(), scale);
  const auto share_of = [&](int cable, std::span<const float> shares) {
    const char* name = TheHand().cable_names()[cable].c_str();
    return shares[mj_name2id(&TheHand().model(), mjOBJ_TENDON, name)];
  };
  EXPECT_EQ(share_of(0, colours.Of(1, 0).cable_share), 1.0f);
  EXPECT_EQ(share_of(1, colours.Of(1, 0).cable_share), 0.25f);
  EXPECT_EQ(share_of(2, colours.Of(1, 0).cable_share), 0.0f);
  EXPECT_EQ(share_of(0, colours.Of(1, 1).cable_share), 0.0f);
}

}  // namespace
}  // namespace gauntlet::sim
