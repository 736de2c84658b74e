#include "sim/score/error_split.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <numeric>

#include "tests/score/signals.h"

namespace gauntlet::sim {
namespace {

constexpr int kTicks = 40000;
constexpr double kRate_hz = 1000.0;

/// Frequency [Hz], amplitude [deg] and phase [turns] of the waves that the wearer's motion is made
/// of: an RMS of 14 deg, and speeds up to some 150 deg/s.
struct Wave {
  double hz;
  double amplitude_deg;
  double phase;
};
constexpr std::array<Wave, 5> kWaves{
    {{0.23, 11.0, 0.1}, {0.41, 13.0, 0.7}, {0.87, 9.0, 0.3}, {1.31, 6.0, 0.9}, {1.93, 3.0, 0.5}}};

double WearerAt(double t) {
  double angle_deg = 30.0;
  for (const auto& [hz, amplitude_deg, phase] : kWaves) {
    angle_deg += amplitude_deg * std::sin(2.0 * kPi * (hz * t + phase));
  }
  return angle_deg;
}

/// Why a hand is not where the wearer is.
struct Causes {
  double delay_ms = 40.0;
  double constant_deg = 1.0;
  double gain = 0.95;
  double frame_ms = 20.0;
  double noise_deg = 0.5;
  double largest_speed_deg_s = 1e6;
  double play_deg = 0.0;
};

/// One joint that follows the wearer as the causes say.
struct Trial {
  Signal reference{kTicks, 1};
  Signal hand{kTicks, 1};
  Signal noise_free_hand{kTicks, 1};
  IntegerSignal at_limit{kTicks, 1};
  std::vector<std::vector<int>> motors_of_joint{{0}};

  explicit Trial(const Causes& causes) {
    at_limit.setZero();
    const auto noise = Noise(kTicks, 7);
    const int frame = static_cast<int>(causes.frame_ms);
    double reached_deg = WearerAt(-0.001 * causes.delay_ms);
    double played_deg = reached_deg;
    double held_deg = reached_deg;
    for (int n = 0; n < kTicks; ++n) {
      reference(n, 0) = kRadPerDeg * WearerAt(0.001 * n);
      // A frame is half a frame late on the mean.
      const double target_deg = WearerAt(0.001 * (n - causes.delay_ms + 0.5 * (frame - 1)));
      const double step_deg = 0.001 * causes.largest_speed_deg_s;
      at_limit(n, 0) = std::abs(target_deg - reached_deg) > step_deg ? 1 : 0;
      reached_deg += std::clamp(target_deg - reached_deg, -step_deg, step_deg);
      played_deg = std::clamp(played_deg, reached_deg - 0.5 * causes.play_deg,
                              reached_deg + 0.5 * causes.play_deg);
      if (n % frame == 0) held_deg = played_deg;
      noise_free_hand(n, 0) =
          kRadPerDeg * (30.0 + causes.constant_deg + causes.gain * (held_deg - 30.0));
      hand(n, 0) = noise_free_hand(n, 0) + kRadPerDeg * causes.noise_deg * noise[n];
    }
  }
  ScoreInput Input() const {
    ScoreInput input;
    input.rate_hz = kRate_hz;
    input.reference_angle_rad = &reference;
    input.hand_angle_rad = &hand;
    input.noise_free_hand_angle_rad = &noise_free_hand;
    input.noise_free_motor_at_limit = &at_limit;
    input.motors_of_joint = motors_of_joint;
    input.earliest_delay_s = -0.1;
    return input;
  }
  /// [deg^2]
  ErrorSplit Split() const {
    Fourier fourier;
    ErrorSplit split = SplitErrors(Input(), fourier).at(0);
    for (double& part : split.mean_squares) part *= kDegPerRad * kDegPerRad;
    return split;
  }
};

double Sum(const ErrorSplit& split) {
  return std::accumulate(split.mean_squares.begin(), split.mean_squares.end(), 0.0);
}

/// A hand that does what the wearer does.
constexpr Causes kNone{
    .delay_ms = 0.0, .constant_deg = 0.0, .gain = 1.0, .frame_ms = 1.0, .noise_deg = 0.0};

TEST(ErrorSplit, SumsToTheMeanSquareWhateverTheHandDoes) {
  for (const Causes& causes :
       {kNone, Causes{}, Causes{.delay_ms = 333.3}, Causes{.delay_ms = -70.0, .gain = -0.3},
        Causes{.gain = 0.0}, Causes{.largest_speed_deg_s = 30.0},
        Causes{.constant_deg = -40.0, .noise_deg = 20.0, .play_deg = 15.0}}) {
    Trial trial(causes);
    const auto sum = [&] {
      const double mean_square = kDegPerRad * kDegPerRad *
                                 (trial.hand - trial.reference).squaredNorm() / trial.hand.rows();
      EXPECT_NEAR(Sum(trial.Split()), mean_square, 1e-9 * mean_square + 1e-20);
    };
    sum();
    // Whatever may be called noise-free and a limit.
    const auto noise = Noise(kTicks, 3);
    for (int n = 0; n < kTicks; ++n) {
      trial.noise_free_hand(n, 0) = 0.7 * noise[n] - 0.001 * n;
      trial.at_limit(n, 0) = noise[kTicks - 1 - n] > 3.0 ? 1 : 0;
    }
    sum();
  }
}

TEST(ErrorSplit, FindsEachCauseAlone) {
  const auto expect_alone = [](Causes causes, ErrorCause cause, double mean_square, double within) {
    const ErrorSplit split = Trial(causes).Split();
    const double sum = Sum(split);
    EXPECT_NEAR(split.Of(cause) / mean_square, 1.0, within) << static_cast<int>(cause);
    // Frames have no value within 0.63 s of both ends: 3 % of this trial.
    EXPECT_NEAR(split.Of(cause) / sum, 1.0, 0.04) << static_cast<int>(cause);
    for (const double part : split.mean_squares) EXPECT_GT(part, -0.02 * sum);
  };
  Causes causes = kNone;
  causes.constant_deg = -3.0;
  expect_alone(causes, ErrorCause::kConstant, 9.0, 1e-6);

  // Of a sum of sines: sum of (2 amplitude sin(pi f d))^2 / 2, and sum of amplitude^2 / 2.
  double late = 0.0;
  double motion = 0.0;
  for (const auto& [hz, amplitude_deg, phase] : kWaves) {
    late += 0.5 * std::pow(2.0 * amplitude_deg * std::sin(kPi * hz * 0.0804), 2);
    motion += 0.5 * amplitude_deg * amplitude_deg;
  }
  for (const double sign : {1.0, -1.0}) {  // late and early
    causes = kNone;
    causes.delay_ms = sign * 80.4;
    expect_alone(causes, ErrorCause::kDelay, late, 0.02);
  }
  for (const double gain : {0.7, 1.2, 0.0}) {
    causes = kNone;
    causes.gain = gain;
    expect_alone(causes, ErrorCause::kGain, (1.0 - gain) * (1.0 - gain) * motion, 0.03);
  }
  causes = kNone;
  causes.noise_deg = 0.8;
  expect_alone(causes, ErrorCause::kNoise, 0.64, 0.02);

  // Held for T the error is v (t - T / 2) within a frame: mean square v^2 T^2 / 12.
  double speed_deg2 = 0.0;
  for (const auto& [hz, amplitude_deg, phase] : kWaves) {
    speed_deg2 += 0.5 * std::pow(2.0 * kPi * hz * amplitude_deg, 2);
  }
  for (const double frame_ms : {5.0, 20.0}) {
    causes = kNone;
    causes.frame_ms = frame_ms;
    expect_alone(causes, ErrorCause::kFrames, speed_deg2 * (frame_ms * frame_ms - 1.0) / 12e6,
                 0.04);
  }
}

TEST(ErrorSplit, OfAHandAtItsLimitIsTheLimits) {
  Causes causes = kNone;
  causes.largest_speed_deg_s = 80.0;
  const Trial trial(causes);
  const ErrorSplit split = trial.Split();
  EXPECT_GT(Sum(split), 5.0);
  EXPECT_NEAR(split.Of(ErrorCause::kLimit) / Sum(split), 1.0, 0.02);
  // The same motion, and nobody says that it is a limit: a delay and a rest.
  Trial silent(causes);
  silent.at_limit.setZero();
  EXPECT_EQ(silent.Split().Of(ErrorCause::kLimit), 0.0);
  EXPECT_GT(silent.Split().Of(ErrorCause::kDelay), 0.3 * Sum(split));
}

TEST(ErrorSplit, CountsAQuarterOfASecondAfterALimitAndTheMotorsOfTheJointOnly) {
  // A hand that stands still beside a wearer who does, 5 deg off in the middle.
  Trial trial(kNone);
  trial.reference.setZero();
  trial.hand.setZero();
  trial.hand.middleRows(20000, 1000).setConstant(5.0 * kRadPerDeg);
  trial.noise_free_hand = trial.hand;
  IntegerSignal at_limit = IntegerSignal::Zero(kTicks, 2);
  at_limit.block(20300, 0, 100, 1).setConstant(1);   // and 250 more
  at_limit.block(20000, 1, 1000, 1).setConstant(1);  // of a motor that turns another joint
  at_limit.block(20050, 0, 19, 1).setConstant(1);    // a kick
  ScoreInput input = trial.Input();
  input.noise_free_motor_at_limit = &at_limit;
  Fourier fourier;
  const ErrorSplit split = SplitErrors(input, fourier).at(0);
  const double all = 25.0 * 1000.0 / kTicks;
  // Outside the limit the hand is 5 deg off in 650 of 39650 ticks: that is the constant.
  const double constant_deg = 5.0 * 650.0 / 39650.0;
  EXPECT_NEAR(kDegPerRad * kDegPerRad * split.Of(ErrorCause::kLimit),
              0.35 * all * (5.0 - constant_deg) / 5.0, 1e-6);
  EXPECT_NEAR(kDegPerRad * kDegPerRad * split.Of(ErrorCause::kConstant),
              5.0 * constant_deg * 1000.0 / kTicks, 1e-6);
  input.frame_ms = 101.0;  // then a motor at its limit for 100 ms has not missed a command
  EXPECT_EQ(SplitErrors(input, fourier).at(0).Of(ErrorCause::kLimit), 0.0);
  input.frame_ms = 1.0;  // but 20 ms are what it takes
  EXPECT_EQ(SplitErrors(input, fourier).at(0).Of(ErrorCause::kLimit), split.Of(ErrorCause::kLimit));
}

TEST(ErrorSplit, OfPlayIsDelayAndRest) {
  Causes causes = kNone;
  causes.play_deg = 2.0;
  const ErrorSplit split = Trial(causes).Split();
  EXPECT_NEAR((split.Of(ErrorCause::kDelay) + split.Of(ErrorCause::kRest)) / Sum(split), 1.0, 0.03);
  EXPECT_GT(split.Of(ErrorCause::kRest), 0.25 * Sum(split));
}

struct Change {
  const char* name;
  Causes causes;
  ErrorCause cause;
};

/// All causes act, and one of them changes.
class ErrorSplitOfAll : public testing::TestWithParam<Change> {};

TEST_P(ErrorSplitOfAll, ReactsToItsOwnCauseOnly) {
  const ErrorSplit before = Trial(Causes{}).Split();
  const ErrorSplit after = Trial(GetParam().causes).Split();
  const double changed = std::abs(after.Of(GetParam().cause) - before.Of(GetParam().cause));
  EXPECT_GT(changed, 0.7 * std::abs(Sum(after) - Sum(before)));
  EXPECT_GT(changed, 0.7 * std::max(after.Of(GetParam().cause), before.Of(GetParam().cause)));
  for (int i = 0; i < kErrorCauseCount; ++i) {
    const auto cause = static_cast<ErrorCause>(i);
    if (cause == GetParam().cause) continue;
    EXPECT_NEAR(after.Of(cause), before.Of(cause), 0.06 * Sum(after)) << i;
  }
}

INSTANTIATE_TEST_SUITE_P(
    Changes, ErrorSplitOfAll,
    testing::Values(Change{"Delay", {.delay_ms = 80.0}, ErrorCause::kDelay},
                    Change{"Constant", {.constant_deg = 3.0}, ErrorCause::kConstant},
                    Change{"Gain", {.gain = 0.8}, ErrorCause::kGain},
                    Change{"Frames", {.frame_ms = 5.0}, ErrorCause::kFrames},
                    Change{"Noise", {.noise_deg = 1.0}, ErrorCause::kNoise}),
    [](const auto& change) { return change.param.name; });

TEST(ErrorSplit, OfALimitTakesWhatItAddsAndSharesItWithTheDelayOnly) {
  const ErrorSplit before = Trial(Causes{}).Split();
  for (const double speed_deg_s : {120.0, 100.0, 80.0}) {
    const ErrorSplit after = Trial(Causes{.largest_speed_deg_s = speed_deg_s}).Split();
    const auto added = [&](ErrorCause cause) { return after.Of(cause) - before.Of(cause); };
    const double whole = Sum(after) - Sum(before);
    EXPECT_GT(added(ErrorCause::kLimit), 0.6 * whole);
    EXPECT_NEAR(added(ErrorCause::kLimit) + added(ErrorCause::kDelay), whole, 0.05 * Sum(after));
  }
}

TEST(ErrorSplit, OfAHandThatStandsStillIsGainAndConstant) {
  Trial trial(kNone);
  trial.noise_free_hand.setConstant(10.0 * kRadPerDeg);
  trial.hand = trial.noise_free_hand;
  const ErrorSplit split = trial.Split();
  EXPECT_NEAR(split.Of(ErrorCause::kConstant) + split.Of(ErrorCause::kGain), Sum(split),
              1e-9 * Sum(split));
  EXPECT_GT(split.Of(ErrorCause::kGain), 100.0);
  EXPECT_GT(split.Of(ErrorCause::kConstant), 300.0);
}

TEST(ErrorSplit, OfAWearerWhoStandsStillHasNeitherDelayNorGain) {
  Trial trial(kNone);
  trial.reference.setConstant(0.3);
  const ErrorSplit split = trial.Split();  // the hand moves, though
  EXPECT_EQ(split.Of(ErrorCause::kDelay), 0.0);
  EXPECT_EQ(split.Of(ErrorCause::kGain), 0.0);
  EXPECT_GT(split.Of(ErrorCause::kRest), 100.0);
}

TEST(ErrorSplit, AtTheLimitAllTheTimeIsFittedToAll) {
  Trial trial({.constant_deg = 2.0, .frame_ms = 20.0});
  trial.at_limit.setConstant(1);
  const ErrorSplit split = trial.Split();
  EXPECT_NEAR(split.Of(ErrorCause::kConstant), 4.0, 0.2);
  EXPECT_NEAR(split.Of(ErrorCause::kDelay), Trial(Causes{}).Split().Of(ErrorCause::kDelay), 0.2);
  EXPECT_GT(split.Of(ErrorCause::kLimit), 0.05);  // the staircase, too
  EXPECT_EQ(split.Of(ErrorCause::kFrames), 0.0);
  EXPECT_EQ(split.Of(ErrorCause::kRest), 0.0);
}

TEST(ErrorSplit, OfAShortHandIsThatOfItsTicks) {
  const Trial trial({});
  Fourier fourier;
  for (const int ticks : {1, 7, 100, 900, 1500, 12345}) {
    const Signal hand = trial.hand.topRows(ticks);
    ScoreInput input = trial.Input();
    input.hand_angle_rad = &hand;
    const double mean_square =
        (hand - trial.reference.topRows(ticks)).squaredNorm() / static_cast<double>(ticks);
    EXPECT_NEAR(Sum(SplitErrors(input, fourier).at(0)), mean_square, 1e-9 * mean_square) << ticks;
  }
}

TEST(ErrorSplit, NeedsTheNoiseFreeTrial) {
  const Trial trial({});
  Fourier fourier;
  ScoreInput input = trial.Input();
  EXPECT_EQ(SplitErrors(input, fourier).size(), 1u);
  input.noise_free_hand_angle_rad = nullptr;
  EXPECT_TRUE(SplitErrors(input, fourier).empty());
  input = trial.Input();
  input.noise_free_motor_at_limit = nullptr;
  EXPECT_TRUE(SplitErrors(input, fourier).empty());
  input = trial.Input();
  input.motors_of_joint = {};
  EXPECT_TRUE(SplitErrors(input, fourier).empty());
}

TEST(ErrorSplit, IsTheSameAtOtherRatesOfTicks) {
  // Every fourth and every second tick of the same trial.
  const Trial trial({.frame_ms = 1.0, .largest_speed_deg_s = 110.0, .play_deg = 2.0});
  const ErrorSplit whole = trial.Split();
  for (const int step : {2, 4}) {
    const Signal reference = EveryRow(trial.reference, step);
    const Signal hand = EveryRow(trial.hand, step);
    const Signal noise_free_hand = EveryRow(trial.noise_free_hand, step);
    IntegerSignal at_limit(reference.rows(), 1);
    for (int n = 0; n < at_limit.rows(); ++n) {
      at_limit(n, 0) = trial.at_limit.middleRows(n * step, step).maxCoeff();
    }
    ScoreInput input = trial.Input();
    input.rate_hz = kRate_hz / step;
    input.reference_angle_rad = &reference;
    input.hand_angle_rad = &hand;
    input.noise_free_hand_angle_rad = &noise_free_hand;
    input.noise_free_motor_at_limit = &at_limit;
    Fourier fourier;
    const ErrorSplit split = SplitErrors(input, fourier).at(0);
    for (int i = 0; i < kErrorCauseCount; ++i) {
      EXPECT_NEAR(kDegPerRad * kDegPerRad * split.mean_squares[i], whole.mean_squares[i],
                  0.01 * Sum(whole))
          << step << ' ' << i;
    }
  }
}

}  // namespace
}  // namespace gauntlet::sim
