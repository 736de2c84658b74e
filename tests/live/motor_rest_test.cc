#include "sim/live/motor_rest.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <vector>

#include "controller/angle.h"
#include "tests/link/two_motors.h"

namespace gauntlet::sim {
namespace {

constexpr controller::Timing kTickOf1Ms;

/// Sends of a session whose loop wants 900 counts every 20 ticks from the motors' 500.
class Motors {
 public:
  Motors() : rest_({}, test::TwoMotors(), kTickOf1Ms) { rest_.Reset(std::vector{500, 500}); }

  void Run(int ticks, bool may_follow, bool has_commands = true) {
    const std::vector<std::int32_t> wanted = {wanted_, 500};
    for (int end = tick_ + ticks; tick_ < end; ++tick_) {
      const bool is_due = has_commands && tick_ % 20 == 0;
      const auto sent = rest_.Frame(
          tick_, is_due ? std::span(wanted) : std::span<const std::int32_t>(), may_follow);
      if (sent.empty()) continue;
      most_per_frame_ = std::max(most_per_frame_, std::abs(sent[0] - place_));
      place_ = sent[0];
      last_sent_tick_ = tick_;
    }
  }

  MotorRest rest_;
  std::int32_t wanted_ = 900;
  int tick_ = 0;
  int place_ = 500;
  int most_per_frame_ = 0;
  int last_sent_tick_ = -1;
};

TEST(MotorRest, LetsMotorsFollowAndRestAtALimitedSpeedOnly) {
  Motors motors;
  motors.Run(4000, true);
  EXPECT_EQ(motors.place_, 900);
  motors.Run(4000, false);
  EXPECT_EQ(motors.place_, 500);
  EXPECT_EQ(motors.rest_.rests(), 1);
  motors.Run(4000, true);
  EXPECT_EQ(motors.place_, 900);
  // Frames of 20 ms, 1000 counts per rad, and one count for rounding.
  const TieredWatchdog limits;
  const double fastest_deg_s = std::max(limits.return_deg_s, limits.relax_deg_s);
  EXPECT_LE(motors.most_per_frame_, 1.0 + 1000.0 * fastest_deg_s * controller::kRadPerDeg * 0.02);
  EXPECT_EQ(motors.rest_.rests(), 1);
}

// Wrong: a gap that no watchdog watches ends with a jump of 400 counts.
TEST(MotorRest, LimitsTheSpeedBehindAGapOfTheSamples) {
  constexpr std::int64_t kTick_ns = 1'000'000;
  Motors motors;
  motors.rest_.NoteSample(kTick_ns);
  motors.wanted_ = 500;
  motors.Run(4000, true);
  for (const int gap_ms : {45, 55}) {
    motors.most_per_frame_ = 0;
    motors.wanted_ = 500;
    motors.Run(4000, true);
    const std::int64_t now_ns = motors.tick_ * kTick_ns;
    motors.rest_.NoteSample(now_ns - gap_ms * kTick_ns);
    motors.Run(4000, true);
    motors.wanted_ = 900;
    motors.most_per_frame_ = 0;
    motors.rest_.NoteSample(now_ns);
    motors.Run(4000, true);
    EXPECT_EQ(motors.place_, 900);
    EXPECT_EQ(motors.most_per_frame_ == 400, gap_ms == 45) << motors.most_per_frame_;
  }
}

TEST(MotorRest, GoesOnToRestWithoutCommandsOfTheLoop) {
  Motors motors;
  motors.Run(4000, true);
  motors.Run(4000, false, false);
  EXPECT_EQ(motors.place_, 500);
}

TEST(MotorRest, SendsNothingBeforeTheFirstCommand) {
  Motors motors;
  motors.Run(1000, false, false);
  EXPECT_EQ(motors.last_sent_tick_, -1);
  EXPECT_FALSE(motors.rest_.has_command());
}

}  // namespace
}  // namespace gauntlet::sim
