#include "controller/sample_guard.h"

#include <gtest/gtest.h>

#include <limits>

namespace gauntlet::controller {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// One channel of a 10-bit converter at 1 kHz, starting at 100 counts.
class OneChannel {
 public:
  explicit OneChannel(const SampleGuardConfig& config = {})
      : guard_(config, {100.0}, 1023.0, 1000.0) {}

  double Take(double counts, std::int64_t number = 0) {
    guard_.Take({.counts = {&counts, 1}, .number = number}, [](int) {});
    return guard_.trusted_counts()[0];
  }
  std::int64_t Count(Untrusted kind) const { return guard_.untrusted_samples(kind)[0]; }
  std::int64_t total() const { return guard_.untrusted_samples()[0]; }

 private:
  SampleGuard guard_;
};

TEST(SampleGuard, HoldsTheLastGoodValueAndNamesTheReason) {
  OneChannel channel;
  EXPECT_EQ(channel.Take(kNan), 100.0);
  EXPECT_EQ(channel.Take(500.0), 500.0);
  EXPECT_EQ(channel.Take(kNan), 500.0);
  EXPECT_EQ(channel.Take(-kInfinity), 500.0);
  EXPECT_EQ(channel.Take(-0.5), 500.0);
  EXPECT_EQ(channel.Take(1e300), 500.0);
  EXPECT_EQ(channel.Take(1023.0), 500.0);
  EXPECT_EQ(channel.Take(0.0), 500.0);
  EXPECT_EQ(channel.Take(510.0), 510.0);
  EXPECT_EQ(channel.Count(Untrusted::kMissing), 2);
  EXPECT_EQ(channel.Count(Untrusted::kInfinite), 1);
  EXPECT_EQ(channel.Count(Untrusted::kOutOfRange), 2);
  EXPECT_EQ(channel.Count(Untrusted::kFullScale), 2);
  EXPECT_EQ(channel.total(), 7);
}

TEST(SampleGuard, TrustsTheEndsOfTheConverterIfTold) {
  OneChannel channel({.full_scale = false, .jump_share = 0.0});
  EXPECT_EQ(channel.Take(1023.0), 1023.0);
  EXPECT_EQ(channel.Take(0.0), 0.0);
  EXPECT_EQ(channel.total(), 0);
}

TEST(SampleGuard, CountsAStuckSensorAndLetsItRecover) {
  OneChannel channel({.stuck_after_ms = 50.0});
  for (int k = 0; k < 80; ++k) EXPECT_EQ(channel.Take(400.0), 400.0);
  EXPECT_EQ(channel.Count(Untrusted::kStuck), 30);
  EXPECT_EQ(channel.Take(401.0), 401.0);
  EXPECT_EQ(channel.total(), 30);
}

TEST(SampleGuard, IgnoresASpikeButFollowsAStepAfterConfirmation) {
  OneChannel channel({.jump_share = 0.25, .jump_confirm_ms = 10.0});
  channel.Take(300.0);
  EXPECT_EQ(channel.Take(900.0), 300.0);  // a spike
  EXPECT_EQ(channel.Take(301.0), 301.0);
  for (int k = 0; k < 10; ++k) EXPECT_EQ(channel.Take(800.0 + k), 301.0) << k;
  EXPECT_EQ(channel.Take(810.0), 810.0);
  EXPECT_EQ(channel.Count(Untrusted::kJumped), 11);
}

TEST(SampleGuard, NeverConfirmsValuesThatJumpAllTheTime) {
  OneChannel channel;
  channel.Take(500.0);
  for (int k = 0; k < 1000; ++k) EXPECT_EQ(channel.Take(k % 2 == 0 ? 10.0 : 1010.0), 500.0);
}

TEST(SampleGuard, RefusesLateAndRepeatedFrames) {
  OneChannel channel;
  EXPECT_EQ(channel.Take(500.0, 7), 500.0);
  EXPECT_EQ(channel.Take(510.0, 7), 500.0);   // repeated
  EXPECT_EQ(channel.Take(520.0, 6), 500.0);   // late
  EXPECT_EQ(channel.Take(530.0, 12), 530.0);  // frames lost in between are not this frame's fault
  EXPECT_EQ(channel.Count(Untrusted::kStale), 2);
}

TEST(SampleGuard, TellsWhichChannelsBecomeGood) {
  SampleGuard guard({}, {100.0, 100.0}, 1023.0, 1000.0);
  std::vector<int> started;
  const auto note = [&started](int channel) { started.push_back(channel); };
  const double first[] = {200.0, kNan};
  const double second[] = {200.0, 300.0};
  guard.Take({.counts = first}, note);
  EXPECT_EQ(started, std::vector<int>({0}));
  guard.Take({.counts = second}, note);
  guard.Take({.counts = second}, note);
  EXPECT_EQ(started, std::vector<int>({0, 1}));
}

}  // namespace
}  // namespace gauntlet::controller
