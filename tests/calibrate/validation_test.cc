// The simulated servo beside one by other equations: it holds for a servo, and not for a hand that
// is stopped by an object.
#include "sim/fit/validation.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>
#include <string>
#include <utility>

#include "sim/base/data_folder.h"
#include "sim/base/error.h"
#include "tests/calibrate/made_up_servo.h"

namespace gauntlet::sim {
namespace {

using test::MadeUpServo;
using test::MakeUpEpisode;
using testing::HasSubstr;

ChainEpisodes Episodes(const MadeUpServo& servo, int count) {
  ChainEpisodes episodes;
  for (int e = 0; e < count; ++e) episodes.logs.push_back(MakeUpEpisode(servo, e, e));
  return episodes;
}

TEST(Validation, HoldsForAServo) {
  const Validation validation = Validate(Episodes({}, 6), {});
  ASSERT_EQ(validation.parts.size(), 1U);
  const ValidatedPart& part = validation.parts[0];
  EXPECT_EQ(part.problem, "");
  EXPECT_EQ(part.episodes, 3U);
  EXPECT_NEAR(part.simulated_delay_ms, part.measured_delay_ms, 5.0);
  EXPECT_LT(part.share_of_motion(), 0.05);
  EXPECT_LT(part.rms_deg, part.shifted_rms_deg);
  EXPECT_EQ(VerdictOf(validation).recommended, "holds");
}

TEST(Validation, DoesNotHoldWhereAnObjectStopsTheHand) {
  const Validation validation = Validate(Episodes({.object_deg = 28.0}, 6), {});
  const Verdict verdict = VerdictOf(validation);
  EXPECT_EQ(verdict.recommended, "");
  ASSERT_FALSE(verdict.Doubts().empty());
  EXPECT_THAT(verdict.Doubts().front(), HasSubstr("of the motion"));
}

/// Its error is that of a limited servo, and its delay the measured one, whatever the size of
/// steps.
TEST(Validation, HoldsForAServoWithASpeedLimit) {
  std::mt19937 random(3);
  ChainEpisodes episodes;
  for (const double most_deg : {100.0, 40.0, 40.0, 100.0, 10.0, 10.0}) {
    episodes.logs.push_back(test::LimitedSteps(most_deg, true, 0.06, 50.0, 0.0, random, 12.0));
  }
  const Validation validation = Validate(std::move(episodes), {});
  const ValidatedPart& part = validation.parts[0];
  EXPECT_EQ(part.problem, "");
  EXPECT_LT(part.share_of_motion(), 0.06);
  EXPECT_NEAR(part.simulated_delay_ms, part.measured_delay_ms, 5.0);
  EXPECT_EQ(VerdictOf(validation).recommended, "holds");
}

TEST(Validation, CutsALogWithoutEpisodes) {
  ChainEpisodes one;
  one.logs.push_back(MakeUpEpisode({}, 1, 1, 40.0));
  const Validation validation = Validate(one, {});
  EXPECT_EQ(validation.identified.judged, 2U);
  EXPECT_EQ(VerdictOf(validation).recommended, "holds");
}

TEST(Validation, AsksForWhatIsMissing) {
  const auto refusal = [](ChainEpisodes episodes, const std::string& hand = "") {
    try {
      Validate(std::move(episodes), hand);
    } catch (const UserError& error) {
      return std::string(error.what());
    }
    return std::string("none");
  };
  ChainEpisodes unknown = Episodes({}, 4);
  for (ChainLog& log : unknown.logs) log.unit_known = false;
  EXPECT_THAT(refusal(unknown), HasSubstr("say --unit deg or --unit rad"));
  EXPECT_THAT(refusal(Episodes({}, 2)), HasSubstr("fewer than four episodes"));
  ChainEpisodes brief;
  brief.logs.push_back(MakeUpEpisode({}, 1, 1, 19.0));
  EXPECT_THAT(refusal(brief), HasSubstr("must be at least 20 s"));
  EXPECT_THAT(refusal(Episodes({}, 4), "no_hand.xml"), HasSubstr("--hand no_hand.xml: "));
  EXPECT_THAT(refusal(Episodes({}, 4), (DataFolder("models") / "three_finger_hand.xml").string()),
              HasSubstr("has no joint with a finger servo and the name of a part of the log"));
}

}  // namespace
}  // namespace gauntlet::sim
