#include "sim/trial/link/watchdog.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <vector>

#include "tests/link/two_motors.h"

namespace gauntlet::sim {
namespace {

using Tier = Watchdog::Tier;
constexpr controller::Timing kTickOf1Ms;

constexpr double kSpeed_deg_s = 90.0;
constexpr double kMostPerTick = 1000.0 * kSpeed_deg_s * 3.14159265358979 / 180.0 * 1e-3;

Watchdog Tiers() {
  return Watchdog({TieredWatchdog{.hold_after_ms = 50.0,
                                  .relax_after_ms = 200.0,
                                  .off_after_ms = 1000.0,
                                  .relax_deg_s = kSpeed_deg_s,
                                  .return_deg_s = 3.0 * kSpeed_deg_s,
                                  .good_frames = 5}},
                  test::TwoMotors(), kTickOf1Ms);
}

/// Frames every 10 ticks but in a gap; the wearer jumps in it.
class Gap : public testing::Test {
 protected:
  static constexpr int kGapBegin = 1000;  // the last frame before it is at 990

  void Run(int gap_ticks, int ticks) {
    Watchdog watchdog = Tiers();
    watchdog.Reset(std::vector<std::int32_t>{600, 600});
    std::vector<std::int32_t> wanted = {600, 600};
    for (int tick = 0; tick < ticks; ++tick) {
      const bool in_gap = tick >= kGapBegin && tick < kGapBegin + gap_ticks;
      const bool is_new = tick % 10 == 0 && !in_gap;
      if (is_new && tick > kGapBegin) wanted = {3000, -2000};
      watchdog.Watch(is_new);
      const auto command = watchdog.Command(wanted);
      tiers_.push_back(watchdog.tier());
      commands_.push_back({command.begin(), command.end()});
    }
  }

  std::vector<Tier> tiers_;
  std::vector<std::vector<std::int32_t>> commands_;
};

TEST_F(Gap, TiersComeAtTheirTimes) {
  Run(3000, 5000);
  constexpr int kLast = 990;
  EXPECT_EQ(tiers_[kLast + 49], Tier::kFollow);
  EXPECT_EQ(tiers_[kLast + 50], Tier::kHold);
  EXPECT_EQ(tiers_[kLast + 199], Tier::kHold);
  EXPECT_EQ(tiers_[kLast + 200], Tier::kRelax);
  EXPECT_EQ(tiers_[kLast + 999], Tier::kRelax);
  EXPECT_EQ(tiers_[kLast + 1000], Tier::kOff);
  EXPECT_EQ(tiers_[kGapBegin + 2999], Tier::kOff);
  EXPECT_EQ(tiers_[kGapBegin + 3000], Tier::kHold);    // the first frame again
  EXPECT_EQ(tiers_[kGapBegin + 3039], Tier::kHold);    // the fourth
  EXPECT_EQ(tiers_[kGapBegin + 3040], Tier::kFollow);  // the fifth
}

TEST_F(Gap, HoldKeepsTheCommandAndRelaxGoesToTheSafePosture) {
  Run(900, 1950);
  using testing::ElementsAre;
  EXPECT_THAT(commands_[990 + 199], ElementsAre(600, 600));
  EXPECT_THAT(commands_[990 + 890], ElementsAre(500, 500));
}

TEST_F(Gap, NoCommandIsFurtherFromTheLastThanTheSpeedAllows) {
  for (const int gap_ticks : {35, 60, 150, 300, 990, 3000}) {
    tiers_.clear();
    commands_.clear();
    Run(gap_ticks, 9000);
    const bool is_seen = gap_ticks > 50;
    double largest = 0.0;
    for (std::size_t i = 1; i < commands_.size(); ++i) {
      for (std::size_t motor = 0; motor < 2; ++motor) {
        largest =
            std::max<double>(largest, std::abs(commands_[i][motor] - commands_[i - 1][motor]));
      }
    }
    // One that is not seen is as without a watchdog.
    if (is_seen) {
      EXPECT_LE(largest, std::ceil(3.0 * kMostPerTick)) << gap_ticks;
    } else {
      EXPECT_EQ(largest, 2600.0) << gap_ticks;
    }
    EXPECT_THAT(commands_.back(), testing::ElementsAre(3000, -2000)) << gap_ticks;
  }
}

TEST(Watchdog, AFewFramesInAGapDoNotEndIt) {
  Watchdog watchdog = Tiers();
  watchdog.Reset(std::vector<std::int32_t>{600, 600});
  watchdog.Watch(true);
  for (int tick = 1; tick < 3000; ++tick) {
    watchdog.Watch(tick % 100 == 0);  // each 100 ms: later than the time until hold
    if (tick < 50) continue;
    ASSERT_NE(watchdog.tier(), Tier::kFollow) << tick;
  }
}

// The sender may begin later than the loop: nothing is missing yet.
TEST(Watchdog, CountsNoSilenceBeforeTheFirstFrame) {
  Watchdog watchdog = Tiers();
  watchdog.Reset(std::vector<std::int32_t>{600, 600});
  for (int tick = 0; tick < 3000; ++tick) {
    watchdog.Watch(false);
    ASSERT_EQ(watchdog.tier(), Tier::kFollow) << tick;
  }
  watchdog.Watch(true);
  for (int tick = 1; tick < 50; ++tick) {
    watchdog.Watch(false);
    ASSERT_EQ(watchdog.tier(), Tier::kFollow) << tick;
  }
  watchdog.Watch(false);
  EXPECT_EQ(watchdog.tier(), Tier::kHold);
}

TEST(Watchdog, CommandsAtRareFramesMoveForTheTimeBetweenThem) {
  Watchdog watchdog = Tiers();
  watchdog.Reset(std::vector<std::int32_t>{5000, 500});
  watchdog.Watch(true);
  for (int tick = 1; tick <= 200; ++tick) watchdog.Watch(false);
  watchdog.Command(std::vector<std::int32_t>{5000, 500});
  for (int tick = 0; tick < 20; ++tick) watchdog.Watch(false);
  EXPECT_NEAR(watchdog.Command(std::vector<std::int32_t>{5000, 500})[0],
              5000.0 - 221.0 * kMostPerTick, 1.0);
}

TEST(Watchdog, HoldAndOffKeepTheCommandWhateverIsWanted) {
  Watchdog watchdog = Tiers();
  watchdog.Reset(std::vector<std::int32_t>{600, 600});
  watchdog.Watch(true);
  std::vector<std::int32_t> at_rest;
  for (int tick = 1; tick < 2000; ++tick) {
    watchdog.Watch(false);
    const auto command =
        watchdog.Command(std::vector<std::int32_t>{tick < 50 ? 600 : 2000, tick < 50 ? 3000 : 0});
    if (tick < 50 || watchdog.tier() == Tier::kRelax) at_rest = {command.begin(), command.end()};
    ASSERT_THAT(command, testing::ElementsAreArray(at_rest)) << tick;
  }
  EXPECT_EQ(watchdog.tier(), Tier::kOff);
}

TEST(Watchdog, SettingsBeyondTheirRangeAreRefused) {
  EXPECT_THROW(Watchdog({TieredWatchdog{.relax_deg_s = 0.0}}, test::TwoMotors(), kTickOf1Ms),
               controller::SettingError);
}

TEST(Watchdog, TiersThatAreNotInOrderAreRefused) {
  WatchdogConfig config{TieredWatchdog{.hold_after_ms = 300.0}};
  try {
    config.Check();
    FAIL();
  } catch (const controller::SettingError& error) {
    EXPECT_STREQ(error.what(), "relax_after_ms: is 200, must be at least hold_after_ms, 300");
  }
}

}  // namespace
}  // namespace gauntlet::sim
