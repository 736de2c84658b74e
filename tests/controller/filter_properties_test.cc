// What every kind of filter must do, whatever its equation.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

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

TEST_P(FilterProperties, CopiesChannelsWithoutAChangedBit) {
  const TestSignal before = GloveCounts(333, kChannels, 1);
  const TestSignal after = GloveCounts(300, kChannels, 2);
  const auto filter = Make();
  Filtered(*filter, before);
  const auto successor = Make();
  Filtered(*successor, GloveCounts(7, kChannels, 3));  // so that its clock stands elsewhere
  for (int i = 0; i < kChannels; ++i) ASSERT_TRUE(successor->CopyChannel(*filter, i));
  EXPECT_EQ(Filtered(*successor, after), Filtered(*filter, after));
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
  EXPECT_LE((output - expected).bottomRows(10).cwiseAbs().maxCoeff(), 8.0);
}

TEST_P(FilterProperties, DoesNotAllocateInStepNorReset) {
  const TestSignal input = GloveCounts(200, kChannels);
  TestSignal output(input.rows(), input.cols());
  const auto filter = Make();
  const auto other = Make();
  const long before = AllocationCount();
  for (Eigen::Index k = 0; k < input.rows(); ++k) filter->Step(RowOf(input, k), RowOf(output, k));
  filter->ResetChannel(3);
  filter->CopyChannel(*other, 3);
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
