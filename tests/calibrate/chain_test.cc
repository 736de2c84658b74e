// From what a log says of a command and an angle back to what stands between them.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <numbers>
#include <optional>

#include "sim/base/error.h"
#include "sim/fit/chain_fit.h"
#include "sim/fit/chain_log.h"
#include "sim/fit/chain_model.h"
#include "sim/fit/identified_hand.h"
#include "tests/calibrate/simulated_chain.h"
#include "tests/support/program.h"

namespace gauntlet::sim {
namespace {

using testing::HasSubstr;

std::vector<double> Simulated(const ChainModel& model, const std::vector<double>& command,
                              double rate_hz) {
  std::vector<double> angle(command.size());
  SimulateChain(model, RefineCommand(command, rate_hz), angle);
  return angle;
}

TEST(ChainModel, DelaysARampByDeadTimeAndLagWhenItHasSettled) {
  std::vector<double> ramp;
  for (int k = 0; k < 4000; ++k) ramp.push_back(10.0 * k * 1e-3);
  for (const double dead_time_s : {0.0, 0.03, 0.0304}) {
    for (const double inertia_s2 : {0.0, 1e-6, 4e-4}) {
      const ChainModel model{.dead_time_s = dead_time_s,
                             .lag_s = 0.05,
                             .inertia_s2 = inertia_s2,
                             .gain = 0.9,
                             .play_deg = 1.5,
                             .offset_deg = 3.0};
      const double expected = 0.9 * (ramp.back() - 10.0 * (dead_time_s + 0.05)) - 1.5 + 3.0;
      EXPECT_NEAR(Simulated(model, ramp, 1000.0).back(), expected, 1e-6);
    }
  }
}

TEST(ChainModel, IsExactForASineOfItsOwn) {
  // Steady state of the second order: |H| and its phase at 2 Hz.
  const double omega = 2.0 * std::numbers::pi * 2.0;
  const ChainModel model{.dead_time_s = 0.02, .lag_s = 0.04, .inertia_s2 = 6e-4};
  std::vector<double> sine;
  for (int k = 0; k < 3000; ++k) sine.push_back(20.0 * std::sin(omega * k * 1e-3));
  const std::vector<double> angle = Simulated(model, sine, 1000.0);
  const double real = 1.0 - omega * omega * model.inertia_s2;
  const double imaginary = omega * model.lag_s;
  const double amplitude = 20.0 / std::hypot(real, imaginary);
  const double phase = -std::atan2(imaginary, real) - omega * model.dead_time_s;
  for (int k = 2000; k < 3000; k += 37) {  // 20 deg in straight lines of 1 ms: (omega h)^2 / 12
    EXPECT_NEAR(angle[k], amplitude * std::sin(omega * k * 1e-3 + phase), 20.0 * 2e-5);
  }
}

TEST(ChainModel, LosesMotionBehindTheLagAtEveryTurn) {
  const ChainModel model{.lag_s = 0.02, .inertia_s2 = 1e-4, .play_deg = 1.0, .lost_play_deg = 2.5};
  std::vector<double> up_and_down;
  for (int k = 0; k < 16000; ++k) up_and_down.push_back(k < 8000 ? 0.005 * k : 80.0 - 0.005 * k);
  const std::vector<double> angle = Simulated(model, up_and_down, 1000.0);
  // At the same command, up and down: the width of both plays and twice the way of 20 ms.
  EXPECT_NEAR(angle[12000] - angle[4000], 2.0 * (1.0 + 2.5 + 5.0 * 0.02), 1e-3);
  // 5 deg/s: 7 deg take 1.4 s, in which the joint stands as it did at the turn.
  EXPECT_NEAR(angle[9300], 40.0 - 1.0 - 2.5, 0.15);
  EXPECT_NEAR(angle[9300], angle[8200], 1e-3);
}

TEST(RefineCommand, TellsASmoothCommandBetweenItsRows) {
  const auto sine = [](double t_s) { return 20.0 * std::sin(2.0 * std::numbers::pi * 2.0 * t_s); };
  std::vector<double> rows;
  for (int k = 0; k < 200; ++k) rows.push_back(sine(k / 50.0));
  const FineCommand fine = RefineCommand(rows, 50.0);
  ASSERT_EQ(fine.steps_per_row, 10);
  EXPECT_EQ(fine.rate_hz, 500.0);
  ASSERT_EQ(fine.values_deg.size(), 1991u);
  for (std::size_t i = 10; i < 1980; ++i) {
    // 3/128 (omega h)^4; straight lines would be off by (omega h)^2 / 8, 0.16 deg.
    EXPECT_NEAR(fine.values_deg[i], sine(static_cast<double>(i) / 500.0), 2e-3);
  }
}

TEST(RefineCommand, LeavesRowsAsTheyAreWhereTheyStepOrAreMostlyNoiseOrCloseTogether) {
  std::vector<double> held, noise, dense;
  controller::TestNoise random(1);
  for (int k = 0; k < 400; ++k) {
    held.push_back(20.0 * std::sin(0.2 * (k / 2)));  // each for two rows
    noise.push_back(20.0 * std::sin(0.05 * k) + random.Normal());
    dense.push_back(20.0 * std::sin(0.02 * k));
  }
  EXPECT_EQ(RefineCommand(held, 100.0).values_deg, held);
  EXPECT_EQ(RefineCommand(noise, 100.0).values_deg, noise);
  EXPECT_EQ(RefineCommand(dense, 500.0).values_deg, dense);
  EXPECT_EQ(RefineCommand(dense, 200.0).steps_per_row, 3);
}

TEST(RefineCommand, HoldsEachRowUntilTheNextIfEachIsAFrame) {
  const FineCommand fine = RefineCommand({{1.0, 5.0, 2.0}}, 250.0, CommandClock());
  EXPECT_THAT(fine.values_deg, testing::ElementsAre(1.0, 1.0, 5.0, 5.0, 2.0));
  EXPECT_EQ(fine.rate_hz, 500.0);
  // Half of a step is done when its row comes, and all of it a fine step later.
  std::vector<double> angle(3);
  SimulateChain({.dead_time_s = 0.004}, fine, angle);
  EXPECT_THAT(angle, testing::ElementsAre(1.0, 1.0, 3.0));
}

TEST(RefineCommand, PutsAStepBetweenRowsWhereItsFrameWasSent) {
  // Frames at rows -0.3, 1.4, 3.1: steps are seen at rows 2 and 4.
  const CommandClock frames{.period_rows = 1.7, .first_row = 1.4};
  const FineCommand fine = RefineCommand({{1.0, 1.0, 5.0, 5.0, 2.0}}, 100.0, frames);
  ASSERT_EQ(fine.steps_per_row, 5);
  const std::vector<double> expected = {1, 1, 1, 1, 1,   1, 1, 5, 5, 5, 5,
                                        5, 5, 5, 5, 3.5, 2, 2, 2, 2, 2};
  ASSERT_EQ(fine.values_deg.size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) {
    EXPECT_NEAR(fine.values_deg[i], expected[i], 1e-9) << i;
  }
}

void ExpectWithin(double share, const ChainEstimate& estimate, double truth) {
  EXPECT_NEAR(estimate.value, truth, share * truth);
  EXPECT_LT(estimate.low, estimate.value);
  EXPECT_GT(estimate.high, estimate.value);
  EXPECT_LT(estimate.high - estimate.low, truth);  // says something
}

TEST(FitChain, FindsTwelveHiddenValuesWithinTenPercent) {
  const HiddenChain hidden[] = {{},
                                {.dead_time_ms = 62.0,
                                 .lag_ms = 28.0,
                                 .natural_frequency_hz = 7.5,
                                 .gain = 0.85,
                                 .hysteresis_deg = 6.5,
                                 .offset_deg = -4.0}};
  for (const HiddenChain& chain : hidden) {
    const SimulatedLog log = SimulateLog(chain, {.duration_s = 20.0, .rate_hz = 200.0}, 5);
    const ChainFit fit = FitChain(log.command_deg, log.angle_deg, 200.0);
    ASSERT_EQ(fit.problem + fit.split_problem, "");
    ExpectWithin(0.1, fit.dead_time_ms, chain.dead_time_ms);
    ExpectWithin(0.1, fit.lag_ms, chain.lag_ms);
    ExpectWithin(0.1, fit.natural_frequency_hz, chain.natural_frequency_hz);
    ExpectWithin(0.1, fit.gain, chain.gain);
    ExpectWithin(0.1, fit.hysteresis_deg, chain.hysteresis_deg);
    EXPECT_NEAR(fit.model.offset_deg, chain.offset_deg, 0.2);
    EXPECT_TRUE(std::isnan(fit.lost_motion_deg.value));  // there is none
    EXPECT_EQ(fit.model.lost_play_deg, 0.0);
    EXPECT_NEAR(fit.residual_rms_deg, 0.3, 0.03);  // nothing but the noise
    const double damping = 1e-3 * chain.lag_ms * std::numbers::pi * chain.natural_frequency_hz;
    ExpectWithin(0.1, fit.damping_ratio, damping);
    // As late as dead time and lag together, play on top.
    EXPECT_GT(fit.delay_ms.value, chain.dead_time_ms + 0.8 * chain.lag_ms);
    EXPECT_GT(fit.shifted_rms_deg, fit.residual_rms_deg);
  }
}

TEST(FitChain, TellsLostMotionFromPlayBeforeTheLagWithoutAMotorsAngle) {
  const HiddenChain hidden[] = {{.hysteresis_deg = 2.0, .lost_motion_deg = 4.0},
                                {.dead_time_ms = 62.0,
                                 .lag_ms = 28.0,
                                 .natural_frequency_hz = 7.5,
                                 .gain = 0.85,
                                 .hysteresis_deg = 4.0,
                                 .offset_deg = -4.0,
                                 .lost_motion_deg = 2.5}};
  for (const HiddenChain& chain : hidden) {
    const SimulatedLog log = SimulateLog(chain, {.duration_s = 30.0, .rate_hz = 500.0}, 5);
    const ChainFit fit = FitChain(log.command_deg, log.angle_deg, 500.0);
    ASSERT_EQ(fit.problem + fit.split_problem, "");
    // Other models that explain the log as well widen the intervals.
    EXPECT_NEAR(fit.dead_time_ms.value, chain.dead_time_ms, 0.1 * chain.dead_time_ms);
    EXPECT_NEAR(fit.lag_ms.value, chain.lag_ms, 0.1 * chain.lag_ms);
    EXPECT_NEAR(fit.lost_motion_deg.value, chain.lost_motion_deg, 0.25 * chain.lost_motion_deg);
    EXPECT_NEAR(fit.motor_hysteresis_deg.value, chain.hysteresis_deg, 0.25 * chain.hysteresis_deg);
    ExpectWithin(0.01, fit.hysteresis_deg, chain.hysteresis_deg + chain.lost_motion_deg);
    EXPECT_EQ(2.0 * fit.model.lost_play_deg, fit.lost_motion_deg.value);
    EXPECT_NEAR(fit.residual_rms_deg, 0.3, 0.01);  // nothing but the noise
  }
}

TEST(FitChain, ClaimsLostMotionOfNoPartWhereNoneOfManyHasAny) {
  constexpr int kLogs = 20;
  constexpr int kLosingLogs = 10;
  int claimed = 0, found = 0;
  for (int i = 0; i < kLogs; ++i) {
    const auto loses = [&](double lost_motion_deg, double duration_s) {
      const ChainRecording recording = {.duration_s = duration_s, .rate_hz = 100.0};
      const SimulatedLog log = SimulateLog({.lost_motion_deg = lost_motion_deg}, recording,
                                           static_cast<std::uint64_t>(500 + i));
      const ChainFit fit = FitChain(log.command_deg, log.angle_deg, recording.rate_hz, 20);
      return !std::isnan(fit.lost_motion_deg.value);
    };
    claimed += loses(0.0, 15.0);
    if (i < kLosingLogs) found += loses(3.0, 20.0);
  }
  EXPECT_EQ(claimed, 0);
  EXPECT_EQ(found, kLosingLogs);
}

TEST(FitChain, WaitsUntilALogHasForgottenWhereInItsHysteresisItBegan) {
  // The first turn of the hidden plays is seconds away, and the fit's begin in their middle.
  std::vector<double> command, angle;
  for (int k = 0; k < 6000; ++k) {
    const double t = k / 200.0;
    command.push_back((t < 8.0 ? 4.0 : 20.0) * (std::sin(0.9 * t) + 0.5 * std::sin(7.1 * t)));
  }
  const ChainModel hidden{.dead_time_s = 0.04,
                          .lag_s = 0.05,
                          .inertia_s2 = 1e-3,
                          .play_deg = 3.0,
                          .lost_play_deg = 4.0};
  std::vector<double> led = command;
  led.insert(led.begin(), 400, -30.0);  // before the log: at the lower end of its way
  angle = Simulated(hidden, led, 200.0);
  angle.erase(angle.begin(), angle.begin() + 400);
  controller::TestNoise random(3);
  for (double& value : angle) value += 0.2 * random.Normal();
  const ChainFit fit = FitChain(command, angle, 200.0);
  EXPECT_NEAR(fit.hysteresis_deg.value, 14.0, 0.7);
  EXPECT_NEAR(fit.residual_rms_deg, 0.2, 0.02);
}

TEST(FitChain, FindsHysteresisOfRowsThatAreFarApart) {
  const HiddenChain chain;
  for (const double rate_hz : {50.0, 100.0}) {
    const SimulatedLog log =
        SimulateLog(chain, {.rate_hz = rate_hz, .noise_deg = 0.02, .motor_step_deg = 0.01}, 5);
    ChainFit fit = FitChain(log.command_deg, log.angle_deg, rate_hz);
    EXPECT_NEAR(fit.hysteresis_deg.value, chain.hysteresis_deg, 0.005);
    EXPECT_NEAR(fit.dead_time_ms.value, chain.dead_time_ms, 1.0);
    AddMotor(log.command_deg, log.motor_deg, log.angle_deg, rate_hz, fit);
    EXPECT_NEAR(fit.motor_hysteresis_deg.value, chain.hysteresis_deg, 0.01);
  }
}

TEST(FitChain, FindsTheDeadTimeBehindFramesThatAreLoggedWhereTheyAreSentOrBeside) {
  HiddenChain chain;
  struct Case {
    double rate_hz;
    double held_s;
    std::optional<CommandClock> said;
  };
  for (const auto& [rate_hz, held_s, said] :
       {Case{500.0, 0.02, {}}, Case{100.0, 0.02, {}}, Case{50.0, 0.02, CommandClock()},
        Case{500.0, 0.0217, {}}, Case{100.0, 0.0217, {}}, Case{50.0, 0.0217, {}}}) {
    const SimulatedLog log =
        SimulateLog(chain, {.rate_hz = rate_hz, .held_s = held_s, .noise_deg = 0.02}, 5);
    const ChainFit fit = FitChain(log.command_deg, log.angle_deg, rate_hz, 1, said);
    ASSERT_TRUE(fit.frames);
    EXPECT_NEAR(fit.frames->period_rows, held_s * rate_hz, 1e-3);
    EXPECT_NEAR(fit.dead_time_ms.value, chain.dead_time_ms, 1.0) << rate_hz << " Hz, " << held_s;
    EXPECT_NEAR(fit.lag_ms.value, chain.lag_ms, 1.0);
    EXPECT_NEAR(fit.hysteresis_deg.value, chain.hysteresis_deg, 0.05);
  }
  // Not told so, rows with a new frame each count as a smooth command, which is half a row early.
  const SimulatedLog log =
      SimulateLog(chain, {.rate_hz = 50.0, .held_s = 0.02, .noise_deg = 0.02}, 5);
  const ChainFit fit = FitChain(log.command_deg, log.angle_deg, 50.0);
  EXPECT_NEAR(fit.dead_time_ms.value + fit.lag_ms.value, chain.dead_time_ms + chain.lag_ms + 10.0,
              2.0);
}

TEST(FitChain, WidensTheIntervalOfDeadTimeByWhatIsOpenOfWhenFramesWereSent) {
  const SimulatedLog log = SimulateLog({}, {.rate_hz = 100.0, .held_s = 0.02}, 5);
  const CommandClock frames{.period_rows = 2.0};
  CommandClock open = frames;
  open.open_rows = 0.25;
  const ChainFit sure = FitChain(log.command_deg, log.angle_deg, 100.0, 1, frames);
  const ChainFit unsure = FitChain(log.command_deg, log.angle_deg, 100.0, 1, open);
  EXPECT_NEAR(unsure.dead_time_ms.low, sure.dead_time_ms.low - 2.5, 1e-9);
  EXPECT_NEAR(unsure.dead_time_ms.high, sure.dead_time_ms.high + 2.5, 1e-9);
  EXPECT_EQ(unsure.lag_ms.high, sure.lag_ms.high);
}

TEST(FitChain, IntervalsHoldTheTruthAsOftenAsTheySay) {
  constexpr int kLogs = 25;
  const HiddenChain chain;
  int held = 0;
  for (int i = 0; i < kLogs; ++i) {
    const SimulatedLog log =
        SimulateLog(chain, {.duration_s = 10.0, .rate_hz = 100.0, .noise_correlation = 0.8},
                    static_cast<std::uint64_t>(300 + i));
    const ChainFit fit = FitChain(log.command_deg, log.angle_deg, 100.0);
    const auto holds = [](const ChainEstimate& e, double truth) {
      return e.low <= truth && truth <= e.high;
    };
    held += holds(fit.dead_time_ms, chain.dead_time_ms) + holds(fit.lag_ms, chain.lag_ms) +
            holds(fit.gain, chain.gain) + holds(fit.hysteresis_deg, chain.hysteresis_deg);
  }
  // 100 intervals of 95 % that are not independent; chain_coverage counts exactly.
  EXPECT_GE(held, 87);
}

/// A servo with a dead time of 30 ms and a speed limit, tested with steps of this size, in whole
/// degrees every 51 ms.
ChainFit FitSlowServo(double step_deg) {
  std::vector<double> command, angle;
  controller::TestNoise random(9);
  const auto wanted = [&](double t_s) {
    return 20.0 + (static_cast<int>(std::floor(t_s / 3.0)) % 2 != 0 ? step_deg : 0.0);
  };
  constexpr double kFine_s = 1e-3;
  double position = 20.0;
  for (int k = 0; k < 60'000; ++k) {
    const double t_s = k * kFine_s;
    position += std::clamp(wanted(std::max(t_s - 0.03, 0.0)) - position, -0.2, 0.2);
    if (k % 51 != 0) continue;
    command.push_back(wanted(t_s));
    angle.push_back(std::round(position + 0.5 * random.Normal()));
  }
  return FitChain(command, angle, 1.0 / 0.051);
}

TEST(FitChain, FindsTheSpeedLimitOfAServoWhateverTheSizeOfItsSteps) {
  for (const double step_deg : {70.0, 140.0}) {
    const ChainFit fit = FitSlowServo(step_deg);
    EXPECT_NEAR(fit.speed_limit_deg_s.value, 200.0, 6.0);
    if (std::isfinite(fit.dead_time_ms.value)) {  // else withheld: its interval is too wide
      EXPECT_LE(fit.dead_time_ms.low, 30.0);
      EXPECT_GE(fit.dead_time_ms.high, 30.0);
    }
    EXPECT_NEAR(fit.gain.value, 1.0, 0.01);
    EXPECT_TRUE(std::isnan(fit.delay_ms.value));  // depends on the size of the step
    EXPECT_THAT(fit.remarks, testing::Contains(HasSubstr("limited to 2")));
  }
}

TEST(FitChain, HasAsWideAnIntervalOfTheDelayForFramesAsForASmoothCommand) {
  const ChainRecording recording{.duration_s = 20.0, .rate_hz = 500.0};
  SimulatedLog log = SimulateLog({}, recording, 8);
  const ChainEstimate smooth = FitChain(log.command_deg, log.angle_deg, 500.0).delay_ms;
  for (std::size_t k = 0; k < log.command_deg.size(); ++k) {
    log.command_deg[k] = log.command_deg[k - k % 10];  // held for 20 ms
  }
  const ChainEstimate framed = FitChain(log.command_deg, log.angle_deg, 500.0).delay_ms;
  EXPECT_NEAR(framed.value, smooth.value - 9.0, 1.0);  // a frame is 0 to 18 ms old
  EXPECT_NEAR(framed.high - framed.low, smooth.high - smooth.low, 0.2 * (smooth.high - smooth.low));
}

TEST(AddMotor, TellsWhatIsLostBehindAMotorFromItsOwnHysteresis) {
  const HiddenChain hidden[] = {{.hysteresis_deg = 4.0, .lost_motion_deg = 2.5},
                                {.dead_time_ms = 62.0,
                                 .lag_ms = 28.0,
                                 .natural_frequency_hz = 7.5,
                                 .gain = 0.85,
                                 .hysteresis_deg = 1.5,
                                 .offset_deg = -4.0,
                                 .lost_motion_deg = 7.0}};
  for (const HiddenChain& chain : hidden) {
    SimulatedLog log = SimulateLog(chain, {.duration_s = 20.0, .rate_hz = 200.0}, 5);
    for (double& motor_deg : log.motor_deg) motor_deg = 100.0 - 2.3 * motor_deg;  // as it is built
    ChainFit fit = FitChain(log.command_deg, log.angle_deg, 200.0);
    AddMotor(log.command_deg, log.motor_deg, log.angle_deg, 200.0, fit);
    EXPECT_EQ(fit.motor_problem, "");
    ExpectWithin(0.1, fit.lost_motion_deg, chain.lost_motion_deg);
    ExpectWithin(0.1, fit.motor_hysteresis_deg, chain.hysteresis_deg);
  }
}

TEST(AddMotor, FindsNothingLostWhereTheJointFollowsItsMotor) {
  SimulatedLog log = SimulateLog({}, {.duration_s = 20.0, .rate_hz = 200.0}, 6);
  // The joint's sensor is 15 ms quicker than the motor's, which is no play.
  log.motor_deg.insert(log.motor_deg.begin(), 3, log.motor_deg.front());
  log.motor_deg.resize(log.angle_deg.size());
  ChainFit fit = FitChain(log.command_deg, log.angle_deg, 200.0);
  AddMotor(log.command_deg, log.motor_deg, log.angle_deg, 200.0, fit);
  EXPECT_LT(fit.lost_motion_deg.value, 0.1);
  EXPECT_LT(fit.lost_motion_deg.high, 0.3);
  EXPECT_NEAR(fit.motor_hysteresis_deg.value, 3.0, 0.15);
}

TEST(AddMotor, SaysWhyAMotorTellsNothing) {
  const SimulatedLog log = SimulateLog({}, {.duration_s = 20.0, .rate_hz = 200.0}, 7);
  const SimulatedLog other = SimulateLog({}, {.duration_s = 20.0, .rate_hz = 200.0}, 8);
  const auto problem = [&](const std::vector<double>& motor_deg) {
    ChainFit fit = FitChain(log.command_deg, log.angle_deg, 200.0);
    AddMotor(log.command_deg, motor_deg, log.angle_deg, 200.0, fit);
    EXPECT_TRUE(std::isnan(fit.lost_motion_deg.value));
    return fit.motor_problem;
  };
  EXPECT_EQ(problem(std::vector<double>(log.angle_deg.size(), 12.0)), "its motor does not move");
  EXPECT_THAT(problem(other.motor_deg), HasSubstr("its motor's angle is not its own"));
}

TEST(FitChain, SaysInOneSentenceWhatALogLacks) {
  std::vector<double> command, angle, still(4000, 3.0);
  for (int k = 0; k < 4000; ++k) {
    const double t = k / 200.0;
    command.push_back(20.0 * std::sin(t) + 10.0 * std::sin(5.0 * t));
    angle.push_back(20.0 * std::sin(t - 0.1) + 10.0 * std::sin(5.0 * (t - 0.1)));
  }
  const auto problem = [](const std::vector<double>& u, const std::vector<double>& y) {
    return FitChain(u, y, 200.0).problem;
  };
  EXPECT_EQ(problem(command, angle), "");
  EXPECT_EQ(problem(still, angle), "its command does not move");
  EXPECT_EQ(problem(command, still), "it does not move");
  EXPECT_THAT(problem(angle, command), HasSubstr("is ahead of its command by 100"));
  const std::vector<double> a(command.begin(), command.begin() + 900);
  EXPECT_EQ(problem(a, a), "is 4.5 s long, must be at least 5 s");
  std::vector<double> opposite = command;
  for (double& value : opposite) value = -value;
  EXPECT_THAT(problem(command, opposite), HasSubstr("its angle falls where its command rises"));
  std::vector<double> other;
  for (int k = 0; k < 4000; ++k) {
    other.push_back(20.0 * std::sin(0.37 * k / 200.0) + 15.0 * std::sin(9.1 * k / 200.0));
  }
  EXPECT_THAT(problem(command, other), HasSubstr("it does not follow its command"));
}

TEST(FitChain, GivesTheDelayAloneWhereOneSineDoesNotTellThePartsApart) {
  std::vector<double> command, angle;
  for (int k = 0; k < 4000; ++k) {
    const double phase = 4.0 * k / 200.0;
    command.push_back(20.0 * std::sin(phase));
    angle.push_back(18.0 * std::sin(phase - 4.0 * 0.08));
  }
  const ChainFit fit = FitChain(command, angle, 200.0);
  EXPECT_EQ(fit.problem, "");
  EXPECT_NEAR(fit.delay_ms.value, 80.0, 0.5);
  // Either it says so, or its intervals do.
  const bool wide = fit.dead_time_ms.high - fit.dead_time_ms.low > 30.0;
  EXPECT_TRUE(!fit.split_problem.empty() || wide)
      << fit.dead_time_ms.low << " " << fit.dead_time_ms.high;
}

ChainLog LoadOnly(const std::filesystem::path& file, const ChainLogOptions& options = {}) {
  ChainEpisodes episodes = LoadChainEpisodes(file, options);
  EXPECT_EQ(episodes.logs.size(), 1U);
  return episodes.logs.front();
}

class ChainLogTest : public testing::Test {
 protected:
  ChainLog Load(const std::string& csv) {
    const auto file = folder_.path() / "log.csv";
    std::ofstream(file) << csv;
    return LoadOnly(file);
  }
  std::string Refusal(const std::string& csv) {
    try {
      Load(csv);
    } catch (const UserError& error) {
      return std::string(error.what()).substr(folder_.path().string().size() + 1);
    }
    return "";
  }
  test::TemporaryDirectory folder_;
};

TEST_F(ChainLogTest, RefusesRowsThatComeInBunches) {
  std::string csv = "t_s,a_command_deg,a_deg\n";
  for (int k = 0; k < 100; ++k) csv += fmt::format("{:.9f},1,2\n", 0.05 * (k / 10) + 1e-6 * k);
  EXPECT_EQ(Refusal(csv),
            "log.csv:1:1: most rows come 1e-06 s after the one before, but all 100 take 0.450099 "
            "s, must come at an about even rate");
}

TEST_F(ChainLogTest, BringsUnevenRowsOfAnyUnitToAnEvenRate) {
  std::string csv = "time_ms,a_command_rad,a_deg,b_command_deg,b_deg\n";
  for (int k = 0; k < 100; ++k) {
    const double time_ms = 10.0 * k + (k % 3);
    csv += std::to_string(time_ms) + "," + std::to_string(time_ms * 1e-3) + "," +
           (k == 50 ? "" : std::to_string(2.0 * time_ms)) + ",1,2\n";
  }
  const ChainLog log = Load(csv);
  EXPECT_EQ(log.parts, (std::vector<std::string>{"a", "b"}));
  EXPECT_EQ(log.values_missing, 1u);
  const double period_ms = 1e3 / log.rate_hz;
  for (const Eigen::Index k : {0, 17, 49, 50, 51, 80}) {
    const double time_ms = period_ms * static_cast<double>(k);
    EXPECT_NEAR(log.command_deg(k, 0), time_ms * 1e-3 * kDegPerRad, 1e-3);
    EXPECT_NEAR(log.angle_deg(k, 0), 2.0 * time_ms, 1e-3);
    EXPECT_EQ(log.angle_deg(k, 1), 2.0);
  }
}

TEST_F(ChainLogTest, KeepsTheStepsOfACommandWhoseRowsAreNotEven) {
  const SimulatedLog log =
      SimulateLog({}, {.rate_hz = 100.0, .held_s = 0.0217, .noise_deg = 0.02}, 5);
  std::string csv = "t_s,a_command_deg,a_deg,b_command_deg,b_deg\n";
  for (std::size_t k = 0; k < log.command_deg.size(); ++k) {
    const double off_s[] = {0.0, 2e-4, 0.0, -1e-4, 0.0};  // of a clock that reads 0.1 ms
    csv +=
        fmt::format("{:.4f},{:.4f},{:.4f},{:.4f},1\n", 0.01 * static_cast<double>(k) + off_s[k % 5],
                    log.command_deg[k], log.angle_deg[k], 0.1 * static_cast<double>(k));
  }
  const ChainLog loaded = Load(csv);
  const auto frames = FramesOf(loaded);
  ASSERT_EQ(frames.size(), 2u);
  ASSERT_TRUE(frames[0]);
  EXPECT_NEAR(frames[0]->period_rows, 2.17, 1e-3);
  EXPECT_FALSE(frames[1]);
  EXPECT_NEAR(loaded.command_deg(1, 1), 0.1 * 0.98, 1e-3);  // on straight lines
  const std::vector<ChainFit> fits = FitChains(loaded);
  EXPECT_NEAR(fits[0].dead_time_ms.value, HiddenChain().dead_time_ms, 0.7);
  EXPECT_EQ(
      WhatFramesAre(loaded, fits),
      "Commands step every 21.70 ms, between the rows of the log, where a clock that fits all "
      "steps says.");
  EXPECT_EQ(WhatFramesAre(loaded, {fits[1]}), "");
}

TEST_F(ChainLogTest, TakesTheAnglesOfMotorsUnlessAPartIsCalledSo) {
  const ChainLog log = Load(
      "t_s,a_command_deg,a_deg,a_motor_rad,b_command_deg,b_deg,c_command_deg,c_deg,"
      "c_motor_command_deg,c_motor_deg\n0,1,2,3,4,5,6,7,8,9\n0.01,1,2,3,4,5,6,7,8,9\n");
  EXPECT_EQ(log.parts, (std::vector<std::string>{"a", "b", "c", "c_motor"}));
  ASSERT_EQ(log.motor_deg.rows(), log.angle_deg.rows());
  EXPECT_NEAR(log.motor_deg(1, 0), 3.0 * kDegPerRad, 1e-9);
  for (const Eigen::Index part : {1, 2, 3}) EXPECT_TRUE(std::isnan(log.motor_deg(1, part)));
  EXPECT_EQ(log.angle_deg(1, 3), 9.0);
  EXPECT_EQ(Load("t_s,a_command_deg,a_deg\n0,1,2\n1,1,2\n").motor_deg.size(), 0);
}

TEST_F(ChainLogTest, ReadsUsualNamesOfColumnsAndIgnoresOthers) {
  const char* const headers[] = {"t_s,target,actual",
                                 "t_s,goal_position,present_position",
                                 "t_s,cmd,pos",
                                 "t_s,command_angle,feedback_angle",
                                 "t_s,targetPos,actualPos",
                                 "t_s,f_cmd,f",
                                 "t_s,f_target_deg,f_actual_deg",
                                 "t_s,action.f.pos,observation.state.f.pos"};
  for (const char* const header : headers) {
    const ChainLog log = Load(std::string(header) + ",current_mA\n0,1,2,3\n0.01,4,5,6\n");
    EXPECT_EQ(log.parts.size(), 1u) << header;
    EXPECT_EQ(log.command_deg(1, 0), 4.0) << header;
    EXPECT_EQ(log.angle_deg(1, 0), 5.0) << header;
    EXPECT_THAT(log.columns_ignored, testing::ElementsAre("current_mA"));
  }
}

TEST_F(ChainLogTest, SaysThatAUnitIsUnknownUnlessNamesOrValuesTellIt) {
  EXPECT_TRUE(Load("t_s,a_target_deg,a_actual\n0,1,2\n0.01,4,5\n").unit_known);
  EXPECT_TRUE(Load("t_s,target_angle,actual_angle\n0,1,2\n0.01,4,50\n").unit_known);
  const ChainLog log = Load("t_s,target_pos,actual_pos\n0,1,2\n0.01,4,50\n");
  EXPECT_FALSE(log.unit_known);
  EXPECT_THAT(log.unit_note, HasSubstr("unknown"));
  EXPECT_FALSE(Load("t_s,target_angle,actual_angle\n0,1,2\n0.01,1,2\n").unit_known);
  std::ofstream(folder_.path() / "log.csv") << "t_s,target_pos,actual_pos\n0,1,2\n0.01,1,2\n";
  EXPECT_NEAR(LoadOnly(folder_.path() / "log.csv", {.array = {}, .unit = "rad", .episode = {}})
                  .angle_deg(0, 0),
              2.0 * kDegPerRad, 1e-9);
}

TEST_F(ChainLogTest, TakesRolesUnitsAndTimeFromAColumnMap) {
  const auto load = [this](const std::string& map) {
    std::ofstream(folder_.path() / "map.csv") << map;
    std::ofstream(folder_.path() / "log.csv")
        << "bench 3\nc1,x,y,z\n0,1000,0.5,7\n10,1100,0.6,8\n20,1200,0.7,9\n";
    return LoadOnly(folder_.path() / "log.csv", {.map = (folder_.path() / "map.csv").string()});
  };
  const std::string head = "column,channel,unit,offset,raw_low,raw_high,deg_low,deg_high,joint\n";
  const std::string rows = head +
                           "c1,time,ms,,,,,,\nx,command,,,1000,1100,0,9,wrist\n"
                           "y,angle,rad,0.1,,,,,wrist\n";
  const ChainLog log = load(rows + "z,motor,,,,,,,wrist\n");
  EXPECT_THAT(log.parts, testing::ElementsAre("wrist"));
  EXPECT_NEAR(log.rate_hz, 100.0, 1e-9);
  EXPECT_NEAR(log.command_deg(2, 0), 18.0, 1e-9);
  EXPECT_NEAR(log.angle_deg(0, 0), 0.6 * kDegPerRad, 1e-9);
  EXPECT_NEAR(log.motor_deg(1, 0), 8.0, 1e-9);
  const auto refusal = [&load](const std::string& map) {
    try {
      load(map);
    } catch (const UserError& error) {
      return std::string(error.what());
    }
    return std::string("none");
  };
  EXPECT_THAT(refusal(rows + "z,index_mcp,,,,,,,\n"), HasSubstr("must be one of: time, command"));
  EXPECT_THAT(refusal(rows + "z,motor,counts,,,,,,wrist\n"), HasSubstr("must be deg or rad"));
  EXPECT_THAT(refusal(head + "c1,time,ms,,,,,,\nx,command,,,1,2,,,\n"),
              HasSubstr("must be given beside raw_low"));
  EXPECT_THAT(refusal(head + "c1,time,ms,,,,,,\nx,command,,,,,,,a\ny,angle,,,,,,,b\n"),
              HasSubstr("'a' has a command but no angle"));
}

TEST_F(ChainLogTest, ReadsClocksAndNamesAboveUnits) {
  const ChainLog log = Load(
      "Time,a command,a angle\n[h],[deg],[deg]\n14:10:49.00,1,2\n"
      "14:10:49.02,3,4\n14:10:49.04,5,6\n");
  EXPECT_NEAR(log.rate_hz, 50.0, 1e-6);
  EXPECT_EQ(log.angle_deg(2, 0), 6.0);
  EXPECT_TRUE(log.unit_known);
}

TEST_F(ChainLogTest, HasTheEpisodesOfItsFile) {
  const auto load = [this](const std::string& csv, const ChainLogOptions& options = {}) {
    std::ofstream(folder_.path() / "log.csv") << csv;
    return LoadChainEpisodes(folder_.path() / "log.csv", options);
  };
  const std::string anew = "t_s,a_command_deg,a_deg\n0,1,2\n0.01,3,4\n0,5,6\n0.01,7,8\n";
  const ChainEpisodes both = load(anew);
  ASSERT_EQ(both.logs.size(), 2U);
  EXPECT_EQ(both.logs[1].angle_deg(0, 0), 6.0);
  EXPECT_EQ(both.logs[1].episode, 1);
  const ChainEpisodes second = load(anew, {.array = {}, .unit = {}, .episode = 1});
  ASSERT_EQ(second.logs.size(), 1U);
  EXPECT_EQ(second.logs[0].angle_deg(1, 0), 8.0);
  // One row is no episode, and does not take the others with it.
  const ChainEpisodes cut =
      load("episode_index,t_s,a_command_deg,a_deg\n3,0,1,2\n3,1,1,2\n4,2,1,2\n");
  ASSERT_EQ(cut.logs.size(), 1U);
  EXPECT_THAT(cut.left_out, testing::ElementsAre("episode 4: the log has fewer than two rows"));
  // The unit is that of all episodes, not of the one with the small angles.
  const ChainEpisodes unit =
      load("t_s,target_angle,actual_angle\n0,1,2\n0.01,3,4\n0,50,60\n0.01,7,8\n");
  EXPECT_TRUE(unit.logs[0].unit_known);
  EXPECT_EQ(unit.logs[0].angle_deg(0, 0), 2.0);
}

TEST_F(ChainLogTest, RefusesAnEpisodeThatIsNone) {
  const auto refusal = [this](const std::string& csv, int episode) {
    std::ofstream(folder_.path() / "log.csv") << csv;
    try {
      LoadChainEpisodes(folder_.path() / "log.csv", {.array = {}, .unit = {}, .episode = episode});
    } catch (const UserError& error) {
      return std::string(error.what()).substr(folder_.path().string().size() + 1);
    }
    return std::string("none");
  };
  const std::string head = "episode_index,t_s,a_command_deg,a_deg\n";
  EXPECT_EQ(refusal(head + "3,0,1,2\n3,1,1,2\n4,2,1,2\n4,3,1,2\n", 5),
            "log.csv:1:1: the log has 2 episodes (3 to 4): --episode 5 does not exist");
  EXPECT_EQ(refusal(head + "3,0,1,2\n3,1,1,2\n", 0),
            "log.csv:1:1: the log has one episode, 3: --episode 0 does not exist");
  EXPECT_EQ(refusal(head + "0.5,0,1,2\n", 0),
            "log.csv:2:1: the episode is 0.5, must be a whole number of 0 to 1e+09");
}

TEST_F(ChainLogTest, RefusesWhatIsNoLogInOneLine) {
  EXPECT_THAT(Refusal("a_command_deg,a_deg\n0,0\n"), HasSubstr("there is no column of time"));
  EXPECT_THAT(Refusal("t_s,a_deg\n0,0\n"), HasSubstr("no part with a command and an angle"));
  EXPECT_THAT(Refusal("t_s,a_command_deg,b_deg\n0,0,0\n"),
              HasSubstr("'a' has a command but no angle, add a column a_deg"));
  EXPECT_THAT(Refusal("t_s,a_command_deg,a_deg,a_rad\n0,0,0,0\n"),
              HasSubstr("log.csv:1:4: 'a_deg' and 'a_rad' are both the angle of 'a'"));
  EXPECT_THAT(Refusal("t_s,a_command_deg,a_deg\n0,0,0\n0,0,0\n"), HasSubstr("must be above"));
  EXPECT_THAT(Refusal("t_s,a_command_deg,a_deg\n0,0,0\n0.01,0,0\n0.02,0,0\n9,0,0\n"),
              HasSubstr("'a' has no value for 8.98 s from 0.02 s on"));
  EXPECT_THAT(Refusal("t_s,a_command_deg,a_deg\n0,0,\n1,0,\n"), HasSubstr("'a' has no values"));
  EXPECT_THAT(Refusal("t_s,a_command_deg,a_deg\n0,0,0\n"), HasSubstr("fewer than two rows"));
}

TEST(IdentifiedChain, GivesAPartThatStoodStillTheMeanOfTheOthers) {
  ChainLog log;
  log.name = "log.csv";
  log.parts = {"a", "b", "c"};
  ChainFit a, b;
  a.delay_ms = {90.0, 88.0, 92.0};
  a.hysteresis_deg = {4.0, 3.0, 5.0};
  a.dead_time_ms = {20.0, 18.0, 22.0};
  a.natural_frequency_hz = {4.5, 4.0, 5.0};
  a.residual_rms_deg = 0.5;
  b.problem = "it does not move";
  ChainFit c = a;
  c.delay_ms = {110.0, 108.0, 112.0};
  c.dead_time_ms = {40.0, 38.0, 42.0};
  const IdentifiedChain chain = MakeIdentifiedChain(log, {a, b, c});
  EXPECT_THAT(chain.horizon_ms, testing::ElementsAre(72.0, 80.0, 88.0));  // 0.8 of it
  EXPECT_EQ(chain.expected_delay_ms, 100.0);
  EXPECT_THAT(chain.friction_deg, testing::Each(2.0));
  EXPECT_THAT(chain.dead_time_ms, testing::ElementsAre(20.0, 30.0, 40.0));
  EXPECT_THAT(chain.lag_ms, testing::IsEmpty());  // of no part
  EXPECT_THAT(chain.natural_frequency_hz, testing::Each(4.5));
  EXPECT_THAT(chain.parts[1].delay_ms, testing::IsEmpty());
  EXPECT_THAT(chain.parts[2].delay_ms, testing::ElementsAre(110.0, 108.0, 112.0));
}

}  // namespace
}  // namespace gauntlet::sim
