#include "sim/fit/command_kind.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <random>
#include <string>
#include <vector>

#include "tests/calibrate/simulated_log.h"

namespace gauntlet::sim {
namespace {

using namespace simulated_log;

TEST(CommandKind, IsThatOfSimulatedLogs) {
  using enum CommandKind;
  std::mt19937 random(7);
  std::map<CommandKind, int> logs, right;
  std::string wrong;
  for (int repetition = 0; repetition < 6; ++repetition) {
    for (const double rate_hz : {5.0, 10.0, 20.0, 30.0, 60.0, 200.0}) {
      for (const double delay_s : {0.03, 0.1, 0.25, 0.9}) {
        const Values target = Reaches(40.0, random);
        const Values c = Thinned(target, rate_hz);
        const Values clean = Thinned(ServoAnswer(target, delay_s, random), rate_hz);
        for (const auto& [noise, step] : {std::pair(0.0, 0.0), {0.05, 0.0}, {0.0, 0.088}}) {
          const Values a = Measured(clean, noise, step, random);
          const std::pair<CommandKind, Values> commands[] = {
              {kTarget, c},
              {kTarget, Scaled(c, 1.0 / 0.9, 17.0)},
              {kCopy, Rounded(a, 0.001)},
              {kCopy, Scaled(a, 0.01, 0.5)},
              {kNextRow, Rounded(Later(a, 1), 0.001)},
              {kEarlierRow, Later(a, -1)},
              {kCopy, Scaled(a, -1.0, 100.0)},
              {kNextRow, Rounded(Later(a, 1), 0.1)},
              {kLaterRow, Later(a, 3)},
              {kSteps, Measured(Changes(clean, 0), 0.005, 0.0, random)},
              {kSteps, Changes(c, 0)},
              {kVelocity, Scaled(Changes(clean, 0), rate_hz, 0.0)},
          };
          for (const auto& [kind, command] : commands) {
            const CommandKind found = FindCommandKind(command, a, rate_hz);
            ++logs[kind];
            if (found == kind) {
              ++right[kind];
            } else {
              wrong += std::to_string(static_cast<int>(kind)) + " as " +
                       std::to_string(static_cast<int>(found)) + " at " + std::to_string(rate_hz) +
                       " Hz, " + std::to_string(delay_s) + " s, noise " + std::to_string(noise) +
                       ", step " + std::to_string(step) + "\n";
            }
          }
        }
      }
    }
  }
  for (const auto& [kind, count] : logs) {
    EXPECT_GE(right[kind], 0.99 * count) << static_cast<int>(kind) << "\n" << wrong;
    EXPECT_GT(count, 100);
  }
}

/// Coarse digits of command or angle, and long rests, make no copy. Wrong: half of the coarser step
/// as the tolerance; rows at rest that count.
TEST(CommandKind, OfCoarseOrRestingTargetsIsATarget) {
  std::mt19937 random(5);
  int wrong = 0, all = 0;
  for (const double rate_hz : {30.0, 50.0}) {
    for (const double command_step : {0.0, 0.088, 1.0}) {
      for (const double angle_step : {0.0, 0.088, 0.24, 0.5}) {
        for (int repetition = 0; repetition < 4; ++repetition) {
          const Values target = Reaches(40.0, random);
          const Values moved = command_step > 0.0 ? Rounded(target, command_step) : target;
          const Values c = Thinned(moved, rate_hz);
          const Values a = Measured(Thinned(ServoAnswer(moved, 0.073, random), rate_hz), 0.03,
                                    angle_step, random);
          ++all;
          wrong += FindCommandKind(c, a, rate_hz) == CommandKind::kTarget ? 0 : 1;
        }
      }
    }
  }
  EXPECT_LE(wrong, 0.01 * all) << wrong << " of " << all;
  // A gripper that closes once in ten seconds.
  Values command, angle;
  double lagged = 0.0;
  std::normal_distribution<double> noise(0.0, 0.05);
  for (int n = 0; n < 500; ++n) {
    command.push_back(std::clamp((n - 200) / 25.0, 0.0, 1.0) * 50.0);
    lagged += (command.back() - lagged) * 0.2;
    angle.push_back(lagged + noise(random));
  }
  EXPECT_EQ(FindCommandKind(command, angle, 50.0), CommandKind::kTarget);
}

/// Of two levels, the rows that move fit a copy of the opposite angle, or of a later row. Wrong: to
/// judge these rows alone.
TEST(CommandKind, OfStepsBetweenTwoLevelsIsATarget) {
  std::mt19937 random(8);
  std::uniform_real_distribution<double> rest_s(0.5, 1.2);
  for (const double rate_hz : {20.0, 50.0, 100.0}) {
    for (const double size : {10.0, 40.0, 100.0}) {
      Values target;
      for (double to = 0.0; target.size() < 30.0 * kFine_hz; to = size - to) {
        target.insert(target.end(), static_cast<std::size_t>(rest_s(random) * kFine_hz), to);
      }
      const Values angle =
          Measured(Thinned(SpeedLimited(target, 0.06, 300.0, 0.015), rate_hz), 0.1, 0.0, random);
      EXPECT_EQ(FindCommandKind(Thinned(target, rate_hz), angle, rate_hz), CommandKind::kTarget)
          << rate_hz << " Hz, " << size << " deg";
    }
  }
}

TEST(CommandKind, OfHalfFloatsIsACopy) {
  std::mt19937 random(6);
  const Values angle =
      Measured(Thinned(ServoAnswer(Reaches(40.0, random), 0.1, random), 50.0), 0.03, 0.0, random);
  Values halves = Later(angle, 1);
  for (double& value : halves) {
    int exponent = 0;
    const double digits = std::frexp(value, &exponent);
    value = std::ldexp(std::round(std::ldexp(digits, 11)), exponent - 11);
  }
  EXPECT_EQ(FindCommandKind(halves, angle, 50.0), CommandKind::kNextRow);
}

TEST(CommandKind, OfAStillOrShortLogIsATarget) {
  EXPECT_EQ(FindCommandKind(Values(100, 3.0), Values(100, 3.0), 30.0), CommandKind::kTarget);
  EXPECT_EQ(FindCommandKind(Values{1.0, 2.0}, Values{1.0, 2.0}, 30.0), CommandKind::kTarget);
}

/// A slow motion hardly differs from the row behind it, and is no copy.
TEST(CommandKind, OfASlowHandOneRowLateIsATarget) {
  for (const double delay_s : {0.0012, 0.0055, 0.021}) {
    Values command, angle;
    for (int n = 0; n < 4000; ++n) {
      command.push_back(35.0 * std::sin(2.0 * kPi * n / 50.0 / 40.0));
      angle.push_back(35.0 * std::sin(2.0 * kPi * (n / 50.0 - delay_s) / 40.0));
    }
    EXPECT_EQ(FindCommandKind(Rounded(command, 1e-4), Rounded(angle, 1e-4), 50.0),
              CommandKind::kTarget);
  }
}

TEST(CommandKind, OfASineThatLagsByAQuarterIsATarget) {
  Values command, angle;
  for (int n = 0; n < 1000; ++n) {
    command.push_back(20.0 * std::sin(2.0 * kPi * 0.5 * n / 30.0));
    angle.push_back(20.0 * std::sin(2.0 * kPi * (0.5 * n / 30.0 - 0.2375)));
  }
  EXPECT_EQ(FindCommandKind(command, angle, 30.0), CommandKind::kTarget);
}

}  // namespace
}  // namespace gauntlet::sim
