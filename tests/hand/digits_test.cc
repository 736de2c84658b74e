#include "sim/hand/digits.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "sim/glove/motions/motion.h"
#include "sim/glove/motions/postures.h"
#include "tests/hand/hand_fixture.h"
#include "tests/hand/small_hand.h"

namespace gauntlet::sim::testing {
namespace {

HandConfig WithContact(Contact contact) {
  HandConfig config;
  config.contact = contact;
  return config;
}

std::vector<double> FlatHand() { return std::vector<double>(GloveChannels().size(), 0.0); }

/// "index" of the body index_proximal; empty for a geom of the palm or of what carries it.
std::string DigitOf(const mjModel& model, int geom) {
  const std::string body = mj_id2name(&model, mjOBJ_BODY, model.geom_bodyid[geom]);
  for (const char* digit : {"thumb", "index", "middle", "ring", "little"}) {
    if (body.starts_with(digit)) return digit;
  }
  return "";
}

/// The deepest contact that the engine finds between two digits.
double DeepestContact(const mjModel& whole, const PhysicsModel& physics, const mjData& data) {
  std::vector<std::string> digits(physics.model().ngeom);
  for (int geom = 0; geom < whole.ngeom; ++geom) {
    if (physics.GeomOf(geom) >= 0) digits[physics.GeomOf(geom)] = DigitOf(whole, geom);
  }
  double deepest = 0.0;
  for (int index = 0; index < data.ncon; ++index) {
    const mjContact& contact = data.contact[index];
    const std::string& first = digits[contact.geom1];
    const std::string& second = digits[contact.geom2];
    if (first.empty() || second.empty() || first == second) continue;
    deepest = std::max(deepest, -contact.dist);
  }
  return deepest;
}

TEST(Digits, AreAsDeepInEachOtherAsTheEnginesContacts) {
  const auto model = MakeModel(WithContact(Contact::kHand));
  Hand hand(model);
  RandomStream random(1, "digits");
  int overlapping = 0;
  for (int i = 0; i < 500; ++i) {
    hand.Reset(RandomPosture(model->transmission(), random));
    const double deepest = DeepestContact(model->model(), model->physics(), hand.data());
    EXPECT_NEAR(hand.DigitOverlap(), deepest, 1e-6);
    overlapping += deepest > 2e-3;
  }
  EXPECT_GT(overlapping, 100);
}

TEST(Digits, OverlapIsTheSameWithoutContacts) {
  Hand without(MakeModel());
  Hand with(MakeModel(WithContact(Contact::kHand)));
  RandomStream random(2, "digits");
  for (int i = 0; i < 50; ++i) {
    const std::vector<double> angle = RandomPosture(without.hand_model().transmission(), random);
    without.Reset(angle);
    with.Reset(angle);
    EXPECT_NEAR(without.DigitOverlap(), with.DigitOverlap(), 1e-15);
  }
}

TEST(Digits, OfAFlatHandAreApart) {
  Hand hand(MakeModel());
  hand.Reset(FlatHand());
  EXPECT_TRUE(hand.hand_model().digits().exist());
  EXPECT_EQ(hand.DigitOverlap(), 0.0);
}

TEST(Digits, AreApartWhereverAGeneratedMotionGoes) {
  Hand hand(MakeModel());
  RandomStream random(3, "digits");
  std::vector<double> angle = FlatHand();
  for (int i = 0; i < 10'000; ++i) {
    for (std::size_t channel = 0; channel < angle.size(); ++channel) {
      const auto [middle_rad, half_rad] = ChannelExcursion(channel, 100.0);
      angle[channel] = random.Uniform(middle_rad - half_rad, middle_rad + half_rad);
    }
    hand.Reset(angle);
    ASSERT_EQ(hand.DigitOverlap(), 0.0) << i;
  }
}

// What presses on the bottle then is no finger on a finger.
TEST(Digits, OfAHandAroundABottleAreApartWithoutTheBottle) {
  Hand hand(MakeModel());
  for (const char* posture : {"around_bottle", "grip_bottle", "lift_bottle"}) {
    std::vector<double> angle = PostureAngles(PostureIndex(posture));
    angle.resize(GloveChannels().size());
    hand.Reset(angle);
    EXPECT_EQ(hand.DigitOverlap(), 0.0) << posture;
  }
}

TEST(Digits, AHandWithoutAPalmHasNone) {
  const auto model = SmallHand{}.Make();
  EXPECT_FALSE(model->digits().exist());
  Hand hand(model);
  hand.Step();
  EXPECT_EQ(hand.DigitOverlap(), 0.0);
}

/// Deepest overlap of thumb and index finger that are told to be where both cannot be.
double PressThumbIntoFinger(Contact contact) {
  const auto model = MakeModel(WithContact(contact));
  Hand hand(model);
  std::vector<double> angle = FlatHand();
  angle[ChannelIndex("thumb_abduction")] = 50.0 * kRadPerDeg;
  hand.Reset(angle);
  angle[ChannelIndex("thumb_rotation")] = 20.0 * kRadPerDeg;
  angle[ChannelIndex("thumb_abduction")] = 0.0;
  angle[ChannelIndex("thumb_mcp")] = 30.0 * kRadPerDeg;
  angle[ChannelIndex("index_mcp")] = 30.0 * kRadPerDeg;
  hand.SetCommand(CountsFor(model->transmission(), angle));
  StepTimes(hand, 1000);
  EXPECT_TRUE(hand.health().ok) << hand.health().problem;
  return hand.DigitOverlap();
}

TEST(Digits, PassThroughEachOtherOnlyWithoutContacts) {
  EXPECT_GT(PressThumbIntoFinger(Contact::kNone), 5e-3);
  EXPECT_LT(PressThumbIntoFinger(Contact::kHand), 1e-3);
}

TEST(Digits, AnyTwoCanTouchEachOther) {
  const auto model = MakeModel(WithContact(Contact::kHand));
  const mjModel& whole = model->model();
  std::vector<int> phalanges;
  for (int geom = 0; geom < whole.ngeom; ++geom) {
    const bool touches = whole.geom_contype[geom] != 0 || whole.geom_conaffinity[geom] != 0;
    if (touches && !DigitOf(whole, geom).empty()) phalanges.push_back(geom);
  }
  EXPECT_EQ(phalanges.size(), 15u);
  for (const int a : phalanges) {
    for (const int b : phalanges) {
      if (DigitOf(whole, a) == DigitOf(whole, b)) continue;
      EXPECT_TRUE((whole.geom_contype[a] & whole.geom_conaffinity[b]) != 0 ||
                  (whole.geom_contype[b] & whole.geom_conaffinity[a]) != 0)
          << DigitOf(whole, a) << " and " << DigitOf(whole, b);
    }
  }
}

}  // namespace
}  // namespace gauntlet::sim::testing
