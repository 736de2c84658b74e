// What every kind of filter must do, whatever its equation.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#if defined(__SSE2__)
#include <immintrin.h>
#endif

#include "controller/filters/filter_registry.h"
#include "tests/controller/allocation_counter.h"
#include "tests/controller/filter_cases.h"
#include "tests/controller/test_signal.h"

namespace gauntlet::controller {
namespace {

constexpr int kChannels = 18;
constexpr double kRateHz = 1000.0;

class FilterProperties : public testing::TestWithParam<FilterCase> {
 protected:
  std::unique_ptr<Filter> Make() const { return MakeFilter(GetParam().config, kChannels, kRateHz); }
};

TestSignal Filtered(Filter& filter, const TestSignal& input) {
  TestSignal output(input.rows(), input.cols());
  for (Eigen::Index k = 0; k < input.rows(); ++k) filter.Step(RowOf(input, k), RowOf(output, k));
  return output;
}

TEST_P(FilterProperties, StartsAgainAfterReset) {
  const auto used = Make();
  Filtered(*used, GloveCounts(300, kChannels, 1));
  used->Reset();
  const TestSignal input = GloveCounts(300, kChannels, 2);
  EXPECT_EQ(Filtered(*used, input), Filtered(*Make(), input));
}

TEST_P(FilterProperties, PassesConstantSignalUnchanged) {
  const auto filter = Make();
  TestSignal input(600, kChannels);
  for (int i = 0; i < kChannels; ++i) input.col(i).setConstant(100.0 + 37.3 * i);
  const TestSignal output = Filtered(*filter, input);
  EXPECT_LE(((output - input).array() / input.array()).abs().maxCoeff(), 1e-11);
}

TEST_P(FilterProperties, KeepsChannelsApartBitForBit) {
  const TestSignal input = GloveCounts(400, kChannels);
  TestSignal disturbed = input;
  constexpr int kQuiet = 7;
  for (int i = 0; i < kChannels; ++i) {
    if (i != kQuiet) disturbed.col(i) = disturbed.col(i) * -1.7 + TestSignal::Ones(400, 1) * 99.0;
  }
  EXPECT_EQ(Filtered(*Make(), input).col(kQuiet), Filtered(*Make(), disturbed).col(kQuiet));
}

TEST_P(FilterProperties, GivesTheSameBitsForOneChannelAsForMany) {
  const TestSignal input = GloveCounts(400, kChannels);
  const TestSignal together = Filtered(*Make(), input);
  for (const int channel : {0, 3, 16, 17}) {
    const auto alone = MakeFilter(ForOneChannel(GetParam().config, channel, kChannels), 1, kRateHz);
    EXPECT_EQ(Filtered(*alone, input.col(channel)).col(0), together.col(channel)) << channel;
  }
}

/// In parts of any length, in place, of few channels and of more than go through registers at once.
TEST_P(FilterProperties, ResetsOneChannelAndLeavesTheOthers) {
  const TestSignal before = GloveCounts(300, kChannels, 1);
  const TestSignal after = GloveCounts(300, kChannels, 2);
  const auto filter = Make();
  const auto untouched = Make();
  Filtered(*filter, before);
  Filtered(*untouched, before);
  constexpr int kChannel = 4;
  filter->ResetChannel(kChannel);
  const TestSignal output = Filtered(*filter, after);
  TestSignal expected = Filtered(*untouched, after);
  expected.col(kChannel) = Filtered(*Make(), after).col(kChannel);
  EXPECT_EQ(output, expected);
}

TEST_P(FilterProperties, TakesMemoryWithoutAChangedBit) {
  const TestSignal before = GloveCounts(333, kChannels, 1);
  const TestSignal after = GloveCounts(300, kChannels, 2);
  const auto filter = Make();
  const auto untouched = Make();
  Filtered(*filter, before);
  Filtered(*untouched, before);
  const auto successor = Make();
  Filtered(*successor, GloveCounts(7, kChannels, 3));  // so that its clock stands elsewhere
  ASSERT_TRUE(successor->SwapMemory(*filter));
  EXPECT_EQ(Filtered(*successor, after), Filtered(*untouched, after));
  EXPECT_FALSE(successor->SwapMemory(*successor));
  const auto narrow = MakeFilter(ForOneChannel(GetParam().config, 0, kChannels), 1, kRateHz);
  EXPECT_FALSE(narrow->SwapMemory(*successor));
}

TEST_P(FilterProperties, StartsWhereItIsTold) {
  TestSignal still(400, kChannels);
  for (int i = 0; i < kChannels; ++i) still.col(i).setConstant(100.0 + 37.3 * i);
  const auto used = Make();
  Filtered(*used, GloveCounts(300, kChannels));
  used->StartAt(RowOf(still, 0));
  const TestSignal output = Filtered(*used, still);
  EXPECT_LE(((output - still).array() / still.array()).abs().maxCoeff(), 1e-11);
  // As if that had been the first sample.
  const TestSignal input = GloveCounts(300, kChannels, 2);
  used->StartAt(RowOf(still, 0));
  const auto fresh = Make();
  Filtered(*fresh, still.topRows(1));
  EXPECT_EQ(Filtered(*used, input), Filtered(*fresh, input));
}

/// Whether the processor has met a subnormal number, or made one, since ForgetSubnormals(). Always
/// false where it cannot be asked.
#if defined(__SSE2__)
void ForgetSubnormals() { _mm_setcsr(_mm_getcsr() & ~(_MM_EXCEPT_DENORM | _MM_EXCEPT_UNDERFLOW)); }
bool MetSubnormals() { return (_mm_getcsr() & (_MM_EXCEPT_DENORM | _MM_EXCEPT_UNDERFLOW)) != 0; }
#else
void ForgetSubnormals() {}
bool MetSubnormals() { return false; }
#endif

TEST_P(FilterProperties, MeetsNoSubnormalNumberOnLongZeros) {
  const auto filter = Make();
  Filtered(*filter, GloveCounts(200, kChannels));
  const std::vector<double> zeros(kChannels, 0.0);
  std::vector<double> output(kChannels, 0.0);
  ForgetSubnormals();
  // The slowest, a low pass of 1 Hz, needs 100 s for 300 decades.
  for (int k = 0; k < 150000; ++k) {
    filter->Step(zeros, output);
    ASSERT_FALSE(std::fpclassify(output[3]) == FP_SUBNORMAL) << k;
  }
  EXPECT_FALSE(MetSubnormals());
}

TEST_P(FilterProperties, MakesNoSubnormalNumberOfADecayingInput) {
  const auto filter = Make();
  std::vector<double> input(kChannels, 500.0);
  std::vector<double> output(kChannels, 0.0);
  for (int k = 0; k < 20000; ++k) {
    for (double& value : input) value *= 0.99;  // subnormal itself in the end
    filter->Step(input, output);
    if (GetParam().config.kind() == "none") continue;
    ASSERT_FALSE(std::fpclassify(output[3]) == FP_SUBNORMAL) << k;
  }
}

TEST_P(FilterProperties, DoesNothingWithSpansThatDoNotFit) {
  const auto filter = Make();
  const TestSignal input = GloveCounts(100, kChannels);
  Filtered(*filter, input);
  std::vector<double> longer(kChannels + 1, 7.0);
  const std::span<double> fits(longer.data(), kChannels);
#ifndef GAUNTLET_ASSERTIONS
  filter->Step(longer, fits);
  filter->Step(fits, longer);
  filter->Step(fits.first(3), fits);
  filter->StartAt(longer);
  filter->ResetChannel(-1);
  filter->ResetChannel(9999);
  EXPECT_THAT(longer, testing::Each(7.0));
  const auto untouched = Make();
  Filtered(*untouched, input);
  EXPECT_EQ(Filtered(*filter, input), Filtered(*untouched, input));
#else
  EXPECT_DEATH(filter->Step(longer, fits), "fits");
  EXPECT_DEATH(filter->ResetChannel(9999), "exists");
#endif
}

TEST_P(FilterProperties, RefusesNoChannelsAndRatesThatAreNone) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  // Both of the registry and of each kind by itself.
  const auto refuses = [&](int channels, double rate_hz) {
    EXPECT_THROW(MakeFilter(GetParam().config, channels, rate_hz), SettingError);
    std::visit(
        [&](const auto& settings) {
          EXPECT_THROW(MakeFilter(settings, channels, rate_hz), SettingError);
        },
        GetParam().config.settings);
  };
  for (const int channels : {0, -1, std::numeric_limits<int>::min()}) refuses(channels, kRateHz);
  for (const double rate_hz : {0.0, -1.0, kInfinity, -kInfinity, std::nan("")}) {
    refuses(kChannels, rate_hz);
  }
}

TEST_P(FilterProperties, MayWriteOverItsInput) {
  const TestSignal input = GloveCounts(300, kChannels);
  const auto filter = Make();
  TestSignal in_place = input;
  for (Eigen::Index k = 0; k < input.rows(); ++k) {
    filter->Step(RowOf(in_place, k), RowOf(in_place, k));
  }
  EXPECT_EQ(in_place, Filtered(*Make(), input));
}

TEST_P(FilterProperties, StaysFiniteAndForgetsAnExtremeSample) {
  const auto filter = Make();
  const auto calm = Make();
  TestSignal input = GloveCounts(4000, kChannels);
  const TestSignal expected = Filtered(*calm, input);
  input.row(50).setConstant(1e9);
  input.row(51).setConstant(-1e9);
  const TestSignal output = Filtered(*filter, input);
  EXPECT_TRUE(output.allFinite());
  // A filter that learns may have learned otherwise, but no more than the noise of 4 counts tells.
  // Where jerk_limit turns is decided by the noise, too: its swings are of that size.
  const double most_counts = GetParam().config.kind() == "jerk_limit" ? 16.0 : 8.0;
  EXPECT_LE((output - expected).bottomRows(10).cwiseAbs().maxCoeff(), most_counts);
}

TEST_P(FilterProperties, DoesNotAllocateInStepNorReset) {
  const TestSignal input = GloveCounts(200, kChannels);
  TestSignal output(input.rows(), input.cols());
  const auto filter = Make();
  const auto other = Make();
  const long before = AllocationCount();
  for (Eigen::Index k = 0; k < input.rows(); ++k) filter->Step(RowOf(input, k), RowOf(output, k));
  filter->ResetChannel(3);
  filter->SwapMemory(*other);
  filter->StartAt(RowOf(input, 0));
  filter->Reset();
  EXPECT_EQ(AllocationCount(), before);
}

TEST(AllocationCounter, SeesNewAndEigen) {
  const long before = AllocationCount();
  { const auto memory = std::make_unique<int>(1); }
  { const Eigen::VectorXd vector(8); }
  { const auto filter = MakeFilter(FilterKinds()[1].defaults, 1, kRateHz); }
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
  EXPECT_GE(AllocationCount(), before + 3);
#else
  EXPECT_EQ(AllocationCount(), before);
#endif
}

INSTANTIATE_TEST_SUITE_P(All, FilterProperties, testing::ValuesIn(FilterCases()),
                         [](const auto& tested) { return tested.param.name; });

}  // namespace
}  // namespace gauntlet::controller
