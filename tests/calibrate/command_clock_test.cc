// When frames were sent, from rows that see each of them up to a row late.
#include "sim/fit/command_clock.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <optional>
#include <utility>
#include <vector>

#include "tests/controller/test_signal.h"

namespace gauntlet::sim {
namespace {

/// Three sines, of which a person's motion could be made; t in seconds.
double Motion(double t) {
  return 20.0 * std::sin(0.7 * t) + 10.0 * std::sin(2.9 * t + 1.0) + 5.0 * std::sin(9.1 * t + 2.0);
}

double Rounded(double value, double step) {
  return step > 0.0 ? step * std::round(value / step) : value;
}

/// A command in frames, and when each was sent.
struct Framed {
  std::vector<double> command_deg;
  std::vector<double> sent_rows;
};

struct Frames {
  double period_rows;
  double first_row = 0.3;
  double spread_rows = 0.0;
  double step_deg = 0.0;  // that values are rounded to
  int rows = 1500;
};

/// Frames of about 20 ms, whatever the rows are.
Framed MakeFrames(const Frames& frames, const std::function<double(double)>& motion = Motion) {
  Framed result;
  controller::TestNoise random(3);
  double row = frames.first_row - 2.0 * frames.period_rows;
  for (int n = -2; row < frames.rows; ++n) {
    row = frames.first_row + n * frames.period_rows;
    result.sent_rows.push_back(row + frames.spread_rows * (random.Uniform() - 0.5));
  }
  std::size_t last = 0;
  for (int k = 0; k < frames.rows; ++k) {
    while (last + 1 < result.sent_rows.size() && result.sent_rows[last + 1] <= k) ++last;
    const double t = 0.02 * result.sent_rows[last] / frames.period_rows;
    result.command_deg.push_back(Rounded(motion(t), frames.step_deg));
  }
  return result;
}

std::optional<CommandClock> ClockOf(const std::vector<double>& command_deg) {
  return FindCommandClock(ChangesOf(command_deg));
}

/// How far from where they were sent the clock says that frames were sent, at most.
double WorstError(const CommandClock& clock, const Framed& framed) {
  double worst = 0.0;
  std::size_t last = 0;
  for (int k = 1; k < std::ssize(framed.command_deg); ++k) {
    while (last + 1 < framed.sent_rows.size() && framed.sent_rows[last + 1] <= k) ++last;
    if (framed.command_deg[k] == framed.command_deg[k - 1]) continue;
    worst = std::max(worst, std::abs(clock.SentAt(k) - framed.sent_rows[last]));
  }
  return worst;
}

TEST(CommandClock, SaysWhenFramesWereSentThatRowsBesideThemSawLate) {
  for (const double period_rows : {1.0851, 1.3103, 1.7, 2.17, 2.5, 3.3017, 10.85, 21.7}) {
    for (const double first_row : {0.0001, 0.3, 0.77}) {
      const Framed framed = MakeFrames({.period_rows = period_rows, .first_row = first_row});
      const auto clock = ClockOf(framed.command_deg);
      ASSERT_TRUE(clock) << period_rows << " " << first_row;
      EXPECT_NEAR(clock->period_rows, period_rows, 1e-3);
      EXPECT_LE(WorstError(*clock, framed), clock->open_rows + 0.02);
    }
  }
  // Half of a row is open of a period that rows see in two ways only.
  EXPECT_NEAR(ClockOf(MakeFrames({.period_rows = 2.5}).command_deg)->open_rows, 0.25, 1e-6);
  EXPECT_LT(ClockOf(MakeFrames({.period_rows = 2.17}).command_deg)->open_rows, 0.01);
}

TEST(CommandClock, TakesFramesOfAWholeNumberOfRowsToBeSentWithThem) {
  for (const double period_rows : {2.0, 4.0, 10.0}) {
    const Frames frames{.period_rows = period_rows, .first_row = 1.0};
    const Framed framed = MakeFrames(frames);
    const auto clock = ClockOf(framed.command_deg);
    ASSERT_TRUE(clock);
    EXPECT_EQ(clock->period_rows, period_rows);
    EXPECT_EQ(clock->open_rows, 0.0);
    EXPECT_EQ(WorstError(*clock, framed), 0.0);
  }
  std::vector<double> rounded = MakeFrames({.period_rows = 4.0}).command_deg;
  for (std::size_t k = 1; k < rounded.size(); k += 3) rounded[k] += 1e-9;
  EXPECT_EQ(ClockOf(rounded)->period_rows, 4.0);
}

TEST(CommandClock, GoesOnWhereFramesBringNoChange) {
  const auto resting = [](double t) { return Motion(std::min(t, 9.0) + std::max(t - 14.0, 0.0)); };
  for (const double period_rows : {1.085, 2.17, 10.85}) {
    const Frames frames{.period_rows = period_rows, .step_deg = 0.088, .rows = 12000};
    const Framed framed = MakeFrames(frames, resting);
    const auto clock = ClockOf(framed.command_deg);
    ASSERT_TRUE(clock) << period_rows;
    EXPECT_NEAR(clock->period_rows, period_rows, 1e-4);
    EXPECT_LE(WorstError(*clock, framed), clock->open_rows + 0.02);
  }
}

TEST(CommandClock, BearsFramesThatAreALittleBesideIt) {
  const Framed framed = MakeFrames({.period_rows = 2.17, .spread_rows = 0.2});
  const auto clock = ClockOf(framed.command_deg);
  ASSERT_TRUE(clock);
  EXPECT_NEAR(clock->period_rows, 2.17, 1e-3);
  EXPECT_LE(WorstError(*clock, framed), 0.2);
  EXPECT_EQ(clock->open_rows, 0.0);
  // Nor is another clock taken for it, of which fewer frames bring a change.
  for (const auto& [period_rows, spread_rows] :
       {std::pair{2.17, 0.3}, std::pair{2.17, 1.0}, std::pair{1.7, 0.3}, std::pair{1.7, 0.6}}) {
    const Frames frames{.period_rows = period_rows, .spread_rows = spread_rows};
    EXPECT_FALSE(ClockOf(MakeFrames(frames).command_deg)) << period_rows << " " << spread_rows;
  }
}

TEST(CommandClock, IsTheSameForAllCommandsOfAFrame) {
  // Each moves for a third of the time, too slowly for its own clock to be seen.
  const Frames frames{.period_rows = 2.17, .step_deg = 0.3, .rows = 3000};
  Signal commands(frames.rows, 3);
  for (int part = 0; part < 3; ++part) {
    const auto slow = [part](double t) { return 12.0 * std::sin(0.8 * t + 1.1 * part); };
    const Framed framed = MakeFrames(frames, slow);
    EXPECT_FALSE(ClockOf(framed.command_deg));
    for (int k = 0; k < frames.rows; ++k) commands(k, part) = framed.command_deg[k];
  }
  const auto clock = FindCommandClock(ChangesOf(commands));
  ASSERT_TRUE(clock);
  EXPECT_NEAR(clock->period_rows, 2.17, 1e-3);
}

TEST(CommandClock, IsNotSeenInFramesThatAreNoLongerThanARowOrFew) {
  for (const double period_rows : {0.31, 0.9, 1.0, 1.01}) {
    for (const double step_deg : {0.0, 0.088, 1.0}) {
      const Frames frames{.period_rows = period_rows, .step_deg = step_deg};
      EXPECT_FALSE(ClockOf(MakeFrames(frames).command_deg)) << period_rows << " " << step_deg;
    }
  }
  EXPECT_TRUE(ClockOf(MakeFrames({.period_rows = 10.3, .rows = 500}).command_deg));
  EXPECT_FALSE(ClockOf(MakeFrames({.period_rows = 10.3, .rows = 60}).command_deg));
  EXPECT_FALSE(ClockOf(MakeFrames({.period_rows = 10.0, .rows = 60}).command_deg));
  EXPECT_FALSE(ClockOf(MakeFrames({.period_rows = 1.085, .rows = 60}).command_deg));
  EXPECT_FALSE(ClockOf(std::vector<double>(400, 3.0)));
  EXPECT_FALSE(ClockOf({}));
}

TEST(CommandClock, IsNotSeenWhereEachRowChangesHoweverFewTheyAre) {
  for (int rows = 0; rows < 400; ++rows) {
    std::vector<double> command;
    for (int k = 0; k < rows; ++k) command.push_back(std::sin(0.01 * k));
    EXPECT_FALSE(ClockOf(command)) << rows;
  }
}

TEST(CommandClock, IsNotSeenInASmoothCommandHoweverItIsRounded) {
  for (const double rate_hz : {50.0, 100.0, 500.0, 1000.0}) {
    for (const double step_deg : {0.0, 1e-3, 0.01, 0.088, 0.5, 1.0, 4.0}) {
      for (const double speed : {0.2, 1.0}) {
        std::vector<double> command;
        for (int k = 0; k < 30.0 * rate_hz; ++k) {
          command.push_back(Rounded(Motion(speed * k / rate_hz), step_deg));
        }
        EXPECT_FALSE(ClockOf(command)) << rate_hz << " Hz, " << step_deg << " deg, " << speed;
      }
    }
  }
}

TEST(CommandClock, IsNotSeenInOneSineNorInNoiseNorInASteadyPaceThatIsRounded) {
  for (const double step_deg : {0.0, 0.01, 0.1, 0.3, 1.0}) {
    std::vector<double> sine, noise, pace;
    controller::TestNoise random(4);
    for (int k = 0; k < 3000; ++k) {
      sine.push_back(Rounded(20.0 * std::sin(2.0 * std::numbers::pi * 0.5 * k / 100.0), step_deg));
      noise.push_back(Rounded(random.Normal(), step_deg));
      const double way = std::fmod(0.0041 * k, 2.0);
      pace.push_back(Rounded(20.0 * std::min(way, 2.0 - way), step_deg));
    }
    std::vector<double> fast;  // rests in every 24th row, where it turns
    for (int k = 0; k < 1500; ++k) {
      fast.push_back(Rounded(20.0 * std::sin(2.0 * std::numbers::pi * 3.0 * k / 50.0), step_deg));
    }
    EXPECT_FALSE(ClockOf(sine)) << step_deg;
    EXPECT_FALSE(ClockOf(fast)) << step_deg;
    EXPECT_FALSE(ClockOf(noise)) << step_deg;
    EXPECT_FALSE(ClockOf(pace)) << step_deg;
  }
}

}  // namespace
}  // namespace gauntlet::sim
