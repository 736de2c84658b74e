#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>

#include "sim/base/error.h"
#include "tests/hand/hand_fixture.h"
#include "tests/hand/small_hand.h"

namespace gauntlet::sim::testing {
namespace {

using ::testing::HasSubstr;

/// Weightless and without friction: at rest both cables have their pretension, k times 0.4 mm.
SmallHand Weightless(const WearConfig& wear) {
  SmallHand small{.gravity_m_s2 = 0.0, .config = FrictionFree()};
  small.config.wear = wear;
  return small;
}

TEST(Wear, TakesThePretensionOfEveryCableAtItsRate) {
  const SmallHand small = Weightless({.slack_mm_per_hour = {3600.0}, .snap = {}});  // 1 mm/s
  const auto model = small.Make();
  Hand hand(model);
  const std::int32_t middle = JointCommand(*model, 0.0);
  const double pretension_n = small.stiffness_n_m * 0.4e-3;
  for (const double second : {0.1, 0.2, 0.3}) {
    Hold(hand, middle, 100);
    EXPECT_NEAR(Read(hand).flexor_n, pretension_n - small.stiffness_n_m * 1e-3 * second, 0.03);
    EXPECT_NEAR(Read(hand).extensor_n, pretension_n - small.stiffness_n_m * 1e-3 * second, 0.03);
  }
  Hold(hand, middle, 200);
  EXPECT_EQ(Read(hand).flexor_n, 0.0);
  EXPECT_EQ(Read(hand).extensor_n, 0.0);
}

TEST(Wear, OfUseFollowsWhatTheDrumWinds) {
  constexpr double kPerTravel = 5e-3;  // 5000 mm per km
  const SmallHand small = Weightless({.slack_mm_per_km = {1e6 * kPerTravel}, .snap = {}});
  const auto model = small.Make();
  Hand hand(model);
  double travel_m = 0.0;
  double spool_rad = Read(hand).spool_rad;
  for (int swing = 0; swing < 4; ++swing) {
    const std::int32_t counts = JointCommand(*model, (swing % 2 == 0 ? 0.6 : 0.0));
    for (int i = 0; i < 400; ++i) {
      Hold(hand, counts, 1);
      travel_m += small.drum_radius_m * std::abs(Read(hand).spool_rad - spool_rad);
      spool_rad = Read(hand).spool_rad;
    }
  }
  EXPECT_GT(travel_m, 0.02);
  const double stretch_m = 0.4e-3 - kPerTravel * travel_m;
  EXPECT_NEAR(Read(hand).flexor_n + Read(hand).extensor_n, 2.0 * small.stiffness_n_m * stretch_m,
              0.05);
  StepTimes(hand, 500);  // a hand at rest does not wear by use
  EXPECT_NEAR(Read(hand).flexor_n + Read(hand).extensor_n, 2.0 * small.stiffness_n_m * stretch_m,
              0.05);
}

TEST(Wear, ACableThatSnapsPullsNeverAgainAndTheOtherGoesSlack) {
  const SmallHand small = Weightless({.snap = {.cable = "joint_flexor", .at_s = 0.1}});
  const auto model = small.Make();
  Hand hand(model);
  Hold(hand, JointCommand(*model, 0.0), 100);
  EXPECT_GT(Read(hand).flexor_n, 3.0);
  double most_n = 0.0;
  for (int i = 0; i < 1000; ++i) {
    Hold(hand, JointCommand(*model, i < 500 ? 0.0 : 0.8), 1);
    most_n = std::max(most_n, Read(hand).flexor_n);
  }
  EXPECT_EQ(most_n, 0.0);
  EXPECT_TRUE(hand.health().ok) << hand.health().problem;
  EXPECT_GT(Read(hand).spool_rad, 0.7);   // the motor turns
  EXPECT_LT(Read(hand).joint_rad, 0.02);  // for nothing
}

TEST(Wear, OfASnappedCableThereIsNoEnergyLeft) {
  HandConfig config;
  config.wear.snap = {.cable = "index_mcp_flexor", .at_s = 0.0};
  config.cable.backlash_deg = 2.0;  // the drum is where its cables together leave it
  const auto model = MakeModel(config);
  Hand hand(model);
  StepTimes(hand, 300);
  std::vector<double> tension(model->cable_names().size());
  hand.ReadCableTensions(tension);
  const auto snapped = std::ranges::find(model->cable_names(), "index_mcp_flexor");
  EXPECT_EQ(tension[snapped - model->cable_names().begin()], 0.0);
  EXPECT_TRUE(std::isfinite(hand.CableEnergy()));
  EXPECT_TRUE(hand.health().ok) << hand.health().problem;
}

TEST(Wear, EveryTrialBeginsWithNewCables) {
  const SmallHand small = Weightless({.snap = {.cable = "joint_flexor", .at_s = 0.05}});
  const auto model = small.Make();
  Hand hand(model);
  StepTimes(hand, 100);
  EXPECT_EQ(Read(hand).flexor_n, 0.0);
  const double angle = 0.0;
  hand.Reset({&angle, 1});
  EXPECT_GT(Read(hand).flexor_n, 3.0);
}

TEST(Wear, OfACableThatTheHandDoesNotHaveIsRefused) {
  HandConfig config;
  config.wear.snap.cable = "index_mcp_flexer";
  try {
    MakeModel(config);
    ADD_FAILURE() << "is accepted";
  } catch (const UserError& error) {
    EXPECT_THAT(error.what(), HasSubstr("hand.wear.snap.cable: the hand has no cable "
                                        "'index_mcp_flexer' (did you mean index_mcp_flexor?)"));
  }
}

}  // namespace
}  // namespace gauntlet::sim::testing
