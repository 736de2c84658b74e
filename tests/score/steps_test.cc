#include "sim/score/steps.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/score/signals.h"

namespace gauntlet::sim {
namespace {

constexpr double kRate_hz = 1000.0;

/// Two seconds of rest, then half a second of ramp to 1 rad, then rest.
double Ramp(double t) { return std::clamp((t - 2.0) / 0.5, 0.0, 1.0); }

struct StepScores {
  double overshoot = 0.0;
  double onset_delay = 0.0;
};

StepScores Score(const std::function<double(double)>& wearer_at,
                 const std::function<double(double)>& hand_at, double delay_samples,
                 double noise = 0.0) {
  const auto wearer = Sampled(5.0, kRate_hz, wearer_at);
  auto hand = Sampled(5.0, kRate_hz, hand_at);
  const auto random = Noise(hand.size(), 9);
  for (std::size_t n = 0; n < hand.size(); ++n) hand[n] += noise * random[n];
  const auto movements = AnalyseWearer(wearer, kRate_hz, {}).movements;
  return {Overshoot(wearer, hand, kRate_hz, movements, delay_samples, All(hand)),
          OnsetDelay(wearer, hand, kRate_hz, movements)};
}

TEST(OnsetDelay, OfALateHandIsItsDelay) {
  for (const double delay : {0.0, 37.0, 61.5, 240.0}) {
    const auto late = [&](double t) { return Ramp(t - delay / 1e3); };
    EXPECT_NEAR(Score(Ramp, late, delay).onset_delay, delay, 0.1);
    EXPECT_NEAR(Score(
                    Ramp, [&](double t) { return 0.3 + late(t); }, delay)
                    .onset_delay,
                delay, 0.1);
  }
}

TEST(OnsetDelay, IsNotTriggeredByNoiseAtRest) {
  EXPECT_NEAR(Score(
                  Ramp, [](double t) { return Ramp(t - 0.037); }, 37.0, 0.03)
                  .onset_delay,
              37.0, 15.0);
}

TEST(OnsetDelay, DoesNotExistForAHandThatStaysOrAWearerWhoNeverRests) {
  EXPECT_TRUE(std::isnan(Score(
                             Ramp, [](double) { return 0.0; }, 0.0)
                             .onset_delay));
  const auto sine = [](double t) { return std::sin(2.0 * kPi * t); };
  EXPECT_TRUE(std::isnan(Score(sine, sine, 0.0).onset_delay));
}

TEST(OnsetDelay, LooksAtNoTickThatDoesNotCount) {
  const auto wearer = Sampled(5.0, kRate_hz, Ramp);
  const auto hand = Sampled(5.0, kRate_hz, [](double t) { return Ramp(t - 0.037); });
  Movement movement{.begin = 2000,
                    .end = 2500,
                    .from_rad = 0.0,
                    .to_rad = 1.0,
                    .from_rest = true,
                    .within = {1700, 5000}};  // its rest is measured from tick 1700 on
  EXPECT_NEAR(OnsetDelay(wearer, hand, kRate_hz, {&movement, 1}), 37.0, 0.1);
  movement.within.begin = 1701;
  EXPECT_TRUE(std::isnan(OnsetDelay(wearer, hand, kRate_hz, {&movement, 1})));
  movement.within = {1700, 2250};  // the hand has come as far only later
  EXPECT_TRUE(std::isnan(OnsetDelay(wearer, hand, kRate_hz, {&movement, 1})));
}

TEST(Overshoot, OfADampedOscillationIsItsFirstPeak) {
  // A hand that swings beyond by 0.2 rad, once, 50 ms after the wearer stopped, and back in 50 ms.
  const auto hand = [](double t) {
    const double since = (t - 2.5) / 0.1;
    return Ramp(t) + (since > 0.0 && since < 1.0 ? 0.2 * std::sin(kPi * since) : 0.0);
  };
  const double offset = 0.2 * 2.0 / kPi * 0.1 / 5.0;  // mean of the bump over 5 s
  EXPECT_NEAR(Score(Ramp, hand, 0.0).overshoot, 0.2 - offset, 1e-4);
}

TEST(Overshoot, OfADelayedCopyWithAnOffsetIsNone) {
  const auto sine = [](double t) { return std::sin(2.0 * kPi * t); };
  const auto late = [&](double t) { return 0.3 + sine(t - 0.05); };
  EXPECT_NEAR(Score(sine, late, 50.0).overshoot, 0.0, 2e-3);
}

TEST(Overshoot, AtReversalsIsTheExcessOfTheAmplitude) {
  const auto sine = [](double t) { return std::sin(2.0 * kPi * t); };
  const auto larger = [&](double t) { return 1.1 * sine(t - 0.03); };
  EXPECT_NEAR(Score(sine, larger, 30.0).overshoot, 0.1, 2e-3);
}

TEST(Overshoot, DoesNotBlameAHandForTheNextMovement) {
  // Up by 1, rest, up by 1 again: the second movement is not an overshoot of the first.
  const auto stairs = [](double t) {
    return std::clamp((t - 1.0) / 0.3, 0.0, 1.0) + std::clamp((t - 2.0) / 0.3, 0.0, 1.0);
  };
  const auto late = [&](double t) { return stairs(t - 0.08); };
  EXPECT_NEAR(Score(stairs, late, 80.0).overshoot, 0.0, 0.04);  // the mean error is not quite 0
}

TEST(Overshoot, DoesNotExistWithoutMovements) {
  EXPECT_TRUE(std::isnan(Score([](double) { return 0.0; }, Ramp, 0.0).overshoot));
}

}  // namespace
}  // namespace gauntlet::sim
