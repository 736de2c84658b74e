#include "sim/fit/command_kind.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <random>
#include <string>
#include <vector>

namespace gauntlet::sim {
namespace {

using Values = std::vector<double>;

constexpr double kPi = 3.14159265358979323846;
constexpr double kFine_hz = 1000.0;

/// A motion of a hand at 1000 Hz: reaches to random postures, with rests.
Values Motion(double seconds, std::mt19937& random) {
  std::uniform_real_distribution<double> target(-40.0, 40.0), time(0.4, 1.6), rest(0.0, 1.0);
  Values motion;
  double from = 0.0;
  while (motion.size() < seconds * kFine_hz) {
    const double to = target(random);
    const auto rows = static_cast<int>(time(random) * kFine_hz);
    for (int i = 0; i < rows; ++i) {
      motion.push_back(from + (to - from) * 0.5 * (1.0 - std::cos(kPi * i / rows)));
    }
    motion.insert(motion.end(), static_cast<std::size_t>(rest(random) * kFine_hz), to);
    from = to;
  }
  return motion;
}

/// A servo: dead time, a lag of first order, play, and gravity's offset.
Values Answer(const Values& target, double delay_s, std::mt19937& random) {
  std::uniform_real_distribution<double> share(0.2, 0.8), play(0.0, 1.5), offset(-3.0, 3.0);
  const double dead_s = share(random) * delay_s;
  const double alpha = 1.0 - std::exp(-1.0 / (kFine_hz * std::max(delay_s - dead_s, 1e-3)));
  const auto dead = static_cast<std::size_t>(dead_s * kFine_hz);
  const double half = 0.5 * play(random), beside = offset(random);
  double lagged = target.front(), angle = lagged;
  Values answer;
  for (std::size_t n = 0; n < target.size(); ++n) {
    lagged += alpha * (target[n < dead ? 0 : n - dead] - lagged);
    angle = std::clamp(angle, lagged - half, lagged + half);
    answer.push_back(angle + beside);
  }
  return answer;
}

Values Thinned(const Values& fine, double rate_hz) {
  Values rows;
  for (double at = 0.0; at < static_cast<double>(fine.size()); at += kFine_hz / rate_hz) {
    rows.push_back(fine[static_cast<std::size_t>(at)]);
  }
  return rows;
}

Values Measured(Values angle, double noise, double step, std::mt19937& random) {
  std::normal_distribution<double> gauss(0.0, 1.0);
  for (double& value : angle) {
    value += noise * gauss(random);
    if (step > 0.0) value = step * std::round(value / step);
  }
  return angle;
}

Values Rounded(Values values, double step) {
  for (double& value : values) value = step * std::round(value / step);
  return values;
}

/// The value `rows` later, the last one at the end.
Values Later(const Values& values, int rows) {
  Values later;
  for (int n = 0; n < std::ssize(values); ++n) {
    later.push_back(values[static_cast<std::size_t>(
        std::clamp(n + rows, 0, static_cast<int>(std::ssize(values)) - 1))]);
  }
  return later;
}

Values Scaled(Values values, double gain, double offset) {
  for (double& value : values) value = gain * value + offset;
  return values;
}

/// The change to the row after the next `late` ones.
Values Changes(const Values& angle, int late) {
  const Values to = Later(angle, late + 1), from = Later(angle, late);
  Values changes;
  for (std::size_t n = 0; n < angle.size(); ++n) changes.push_back(to[n] - from[n]);
  return changes;
}

TEST(CommandKind, IsThatOfSimulatedLogs) {
  using enum CommandKind;
  std::mt19937 random(7);
  std::map<CommandKind, int> logs, right;
  std::string wrong;
  for (int repetition = 0; repetition < 6; ++repetition) {
    for (const double rate_hz : {5.0, 10.0, 20.0, 30.0, 60.0, 200.0}) {
      for (const double delay_s : {0.03, 0.1, 0.25, 0.9}) {
        const Values target = Motion(40.0, random);
        const Values c = Thinned(target, rate_hz);
        const Values clean = Thinned(Answer(target, delay_s, random), rate_hz);
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
            // A delay far beyond what sums are searched for, or below a row, says nothing here.
            if (kind == kSteps && &command == &commands[10].second && delay_s * rate_hz > 3.0) {
              continue;
            }
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
    angle.push_back(20.0 * std::sin(2.0 * kPi * (0.5 * n / 30.0 - 0.25)));
  }
  EXPECT_EQ(FindCommandKind(command, angle, 30.0), CommandKind::kTarget);
}

}  // namespace
}  // namespace gauntlet::sim
