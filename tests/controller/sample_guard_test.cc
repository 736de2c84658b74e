#include "controller/sample_guard.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "controller/number.h"

namespace gauntlet::controller {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr ConverterRange kTenBits[2] = {};  // of two channels

/// One channel of a 10-bit converter at 1 kHz, starting at 400 counts.
class OneChannel {
 public:
  explicit OneChannel(const SampleGuardConfig& config = {}, int frame_number_bits = 64,
                      const ConverterRange& converter = {})
      : guard_(config, kStart, {&converter, 1}, 1000.0, frame_number_bits) {}

  double Step(double counts, std::optional<std::int64_t> number = {}) {
    guard_.Step({.counts = {&counts, 1}, .number = number}, [](int) {});
    return guard_.trusted_counts()[0];
  }
  std::int64_t Count(Untrusted kind) const { return guard_.untrusted_samples(kind)[0]; }
  std::int64_t total() const { return guard_.untrusted_samples()[0]; }

 private:
  static constexpr double kStart[] = {400.0};
  SampleGuard guard_;
};

/// Of frames with these numbers and a moving value, how many were not trusted.
std::int64_t StaleOf(const std::vector<std::int64_t>& numbers, int bits = 64) {
  OneChannel channel({}, bits);
  std::int64_t k = 0;
  for (const std::int64_t number : numbers) {
    channel.Step(400.0 + static_cast<double>(k++ % 7), number);
  }
  EXPECT_EQ(channel.Count(Untrusted::kStale), channel.total());
  return channel.total();
}

TEST(SampleGuard, HoldsTheLastGoodValueAndNamesTheReason) {
  OneChannel channel;
  EXPECT_EQ(channel.Step(kNaN), 400.0);
  EXPECT_EQ(channel.Step(500.0), 500.0);
  EXPECT_EQ(channel.Step(kNaN), 500.0);
  EXPECT_EQ(channel.Step(-kInfinity), 500.0);
  EXPECT_EQ(channel.Step(-0.5), 500.0);
  EXPECT_EQ(channel.Step(1e300), 500.0);
  EXPECT_EQ(channel.Step(1023.0), 500.0);
  EXPECT_EQ(channel.Step(0.0), 500.0);
  EXPECT_EQ(channel.Step(510.0), 510.0);
  EXPECT_EQ(channel.Count(Untrusted::kMissing), 2);
  EXPECT_EQ(channel.Count(Untrusted::kInfinite), 1);
  EXPECT_EQ(channel.Count(Untrusted::kOutOfRange), 2);
  EXPECT_EQ(channel.Count(Untrusted::kFullScale), 2);
  EXPECT_EQ(channel.total(), 7);
}

TEST(SampleGuard, TrustsTheEndsOfTheConverterIfTold) {
  OneChannel channel({.full_scale = false, .jump_share = 0.0});
  EXPECT_EQ(channel.Step(1023.0), 1023.0);
  EXPECT_EQ(channel.Step(0.0), 0.0);
  EXPECT_EQ(channel.total(), 0);
}

TEST(SampleGuard, KnowsTheEndsOfASignedConverter) {
  const ConverterRange range = {.min_counts = -2048.0, .full_scale_counts = 2047.0};
  OneChannel channel({.jump_share = 0.25, .jump_confirm_ms = 10.0}, 64, range);
  EXPECT_EQ(channel.Step(0.0), 0.0);
  EXPECT_EQ(channel.Step(-1000.0), -1000.0);
  EXPECT_EQ(channel.Step(23.0), 23.0) << "1023 of 4095 counts are no jump";
  EXPECT_EQ(channel.Step(-1001.0), 23.0) << "1024 of 4095 counts are a jump";
  EXPECT_EQ(channel.Count(Untrusted::kJumped), 1);
  EXPECT_EQ(channel.Step(-2048.0), 23.0);
  EXPECT_EQ(channel.Step(2047.0), 23.0);
  EXPECT_EQ(channel.Count(Untrusted::kFullScale), 2);
  EXPECT_EQ(channel.Step(-2049.0), 23.0);
  EXPECT_EQ(channel.Step(2048.0), 23.0);
  EXPECT_EQ(channel.Count(Untrusted::kOutOfRange), 2);

  OneChannel trusting({.full_scale = false, .jump_share = 0.0}, 64, range);
  EXPECT_EQ(trusting.Step(-2048.0), -2048.0);
  EXPECT_EQ(trusting.Step(2047.0), 2047.0);
  EXPECT_EQ(trusting.total(), 0);
}

TEST(SampleGuard, HasAConverterForEachChannel) {
  const ConverterRange ranges[] = {{},
                                   {.min_counts = -2048.0, .full_scale_counts = -1.0},
                                   {.min_counts = 0.0, .full_scale_counts = 4095.0}};
  const double start[] = {400.0, 400.0, 4000.0};
  SampleGuard guard({}, start, ranges, 1000.0);
  EXPECT_EQ(guard.trusted_counts()[1], -1.0) << "no start outside the range";
  EXPECT_EQ(guard.trusted_counts()[2], 4000.0);
  const double counts[] = {1023.0, -2048.0, 4000.0};
  guard.Step({.counts = counts}, [](int) {});
  EXPECT_EQ(guard.untrusted_samples(Untrusted::kFullScale)[0], 1);
  EXPECT_EQ(guard.untrusted_samples(Untrusted::kFullScale)[1], 1);
  EXPECT_EQ(guard.untrusted_samples()[2], 0);
}

TEST(SampleGuard, CountsAStuckSensorAndLetsItRecover) {
  OneChannel channel({.stuck_after_ms = 50.0});
  for (int k = 0; k < 80; ++k) EXPECT_EQ(channel.Step(400.0), 400.0);
  EXPECT_EQ(channel.Count(Untrusted::kStuck), 30);
  EXPECT_EQ(channel.Step(401.0), 401.0);
  EXPECT_EQ(channel.total(), 30);
}

TEST(SampleGuard, IgnoresASpikeButFollowsAStepAfterConfirmation) {
  OneChannel channel({.jump_share = 0.25, .jump_confirm_ms = 10.0});
  channel.Step(300.0);
  EXPECT_EQ(channel.Step(900.0), 300.0);  // a spike
  EXPECT_EQ(channel.Step(301.0), 301.0);
  for (int k = 0; k < 10; ++k) EXPECT_EQ(channel.Step(800.0 + k), 301.0) << k;
  EXPECT_EQ(channel.Step(810.0), 810.0);
  EXPECT_EQ(channel.Count(Untrusted::kJumped), 11);
}

TEST(SampleGuard, NeverConfirmsValuesThatJumpAllTheTime) {
  OneChannel channel;
  channel.Step(500.0);
  for (int k = 0; k < 1000; ++k) EXPECT_EQ(channel.Step(k % 2 == 0 ? 10.0 : 1010.0), 500.0);
}

TEST(SampleGuard, RefusesLateAndRepeatedFrames) {
  OneChannel channel;
  EXPECT_EQ(channel.Step(500.0, 7), 500.0);
  EXPECT_EQ(channel.Step(510.0, 7), 500.0);   // repeated
  EXPECT_EQ(channel.Step(520.0, 6), 500.0);   // late
  EXPECT_EQ(channel.Step(530.0, 12), 530.0);  // frames lost in between are not this frame's fault
  EXPECT_EQ(channel.Count(Untrusted::kStale), 2);
}

TEST(SampleGuard, RecoversFromOneWrongNumber) {
  // Every bit of a counter that has run for 1000 frames; then for 200,000.
  for (int bit = 0; bit < 63; ++bit) {
    std::vector<std::int64_t> numbers;
    for (std::int64_t k = 1; k <= 2000; ++k) numbers.push_back(k);
    numbers[1000] ^= std::int64_t{1} << bit;
    EXPECT_LE(StaleOf(numbers), 5) << bit;
  }
  std::vector<std::int64_t> numbers;
  for (std::int64_t k = 1; k <= 200000; ++k) numbers.push_back(k);
  numbers[1000] += std::int64_t{1} << 40;
  EXPECT_EQ(StaleOf(numbers), 4);
}

TEST(SampleGuard, CountsFramesOnACircleOfTheStatedWidth) {
  for (const int bits : {2, 8, 16, 32, 63, 64}) {
    std::vector<std::int64_t> numbers;
    const std::uint64_t last = ~std::uint64_t{0} >> (64 - bits);
    for (std::uint64_t k = last - 300; numbers.size() < 140000; ++k) {
      numbers.push_back(static_cast<std::int64_t>(k & last));
    }
    EXPECT_EQ(StaleOf(numbers, bits), 0) << bits;
  }
  // Late and repeated over the seam, and a lost frame.
  EXPECT_EQ(StaleOf({254, 255, 0, 255, 0, 1, 3}, 8), 2);
}

TEST(SampleGuard, LosesFewFramesOfACounterWhoseWidthNobodyStated) {
  std::vector<std::int64_t> numbers;
  for (std::int64_t k = 0; k < 10 * 256; ++k) numbers.push_back(k % 256);
  EXPECT_EQ(StaleOf(numbers), 9 * 4);
}

TEST(SampleGuard, FollowsAGloveThatCountsAnewAlsoIfItRepeatsEachFrame) {
  std::vector<std::int64_t> numbers = {5000, 5001, 5002};
  for (std::int64_t k = 1; k <= 100; ++k) numbers.insert(numbers.end(), {k, k});
  EXPECT_EQ(StaleOf(numbers), 4 * 2 + 96);  // of each of the first four both, then the repeated
}

TEST(SampleGuard, HoldsTheFirstValueAgainstWhereTheHandIs) {
  OneChannel channel;
  EXPECT_EQ(channel.Step(900.0), 400.0);  // a glitch
  EXPECT_EQ(channel.Step(410.0), 410.0);
  EXPECT_EQ(channel.Count(Untrusted::kJumped), 1);
}

TEST(SampleGuard, TellsWhichChannelsBecomeGood) {
  const double start[] = {100.0, 100.0};
  SampleGuard guard({}, start, kTenBits, 1000.0);
  std::vector<int> started;
  const auto note = [&started](int channel) { started.push_back(channel); };
  const double first[] = {200.0, kNaN};
  const double second[] = {200.0, 300.0};
  guard.Step({.counts = first}, note);
  EXPECT_EQ(started, std::vector<int>({0}));
  guard.Step({.counts = second}, note);
  guard.Step({.counts = second}, note);
  EXPECT_EQ(started, std::vector<int>({0, 1}));
}

TEST(SampleGuard, HandsOnWhatItHasSeenAndStartsOtherChannelsAnew) {
  const double start[] = {400.0, 400.0};
  const double counts[] = {500.0, kNaN};
  SampleGuard before({}, start, kTenBits, 1000.0);
  before.Step({.counts = counts}, [](int) {});
  SampleGuard after({}, start, kTenBits, 1000.0);
  const double other_start[] = {300.0, 700.0};
  after.SwapMemory(before, other_start);
  EXPECT_EQ(after.trusted_counts()[0], 500.0);
  EXPECT_EQ(after.trusted_counts()[1], 700.0);
}

}  // namespace
}  // namespace gauntlet::controller
