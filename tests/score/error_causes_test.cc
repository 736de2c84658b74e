// The mean square error by its cause, of signals whose causes are known.
#include "sim/score/error_causes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <vector>

#include "tests/controller/test_signal.h"

namespace gauntlet::sim {
namespace {

constexpr int kTicks = 5000;
const CountedTicks kAll = {{0, kTicks}};

std::vector<double> Noise(std::uint64_t seed) {
  controller::TestNoise noise(seed);
  std::vector<double> values(kTicks);
  for (double& value : values) value = noise.Normal();
  return values;
}

std::vector<double> Sum(const std::vector<double>& a, const std::vector<double>& b) {
  std::vector<double> sum = a;
  for (std::size_t n = 0; n < sum.size(); ++n) sum[n] += b[n];
  return sum;
}

/// A reference, and hands that lose one cause after the other, the last of which is beside it.
class ErrorCauses : public testing::Test {
 protected:
  ErrorCauses() {
    hands_.push_back(Sum(reference_, causes_.back()));
    for (std::size_t i = kCauseTrialCount; i-- > 0;) {
      hands_.insert(hands_.begin(), Sum(hands_.front(), causes_[i]));
    }
  }
  static std::vector<std::vector<double>> MadeUp() {
    std::vector<std::vector<double>> causes;
    for (std::size_t i = 0; i < kErrorCauseCount; ++i) causes.push_back(Noise(10 + i));
    return causes;
  }
  std::optional<ErrorByCauses> Parts(const CountedTicks& counted = kAll) const {
    return PartsOfError(reference_, hands_.front(), without_, counted);
  }
  void UseAllHands() {
    for (std::size_t i = 0; i < kCauseTrialCount; ++i) without_[i] = hands_[i + 1];
  }
  /// mean(part error), the definition.
  double Expected(const std::vector<double>& part, const CountedTicks& counted = kAll) const {
    double sum = 0.0;
    for (const auto& [begin, end] : counted) {
      for (int n = begin; n < end; ++n) sum += part[n] * (hands_.front()[n] - reference_[n]);
    }
    return sum / CountOf(counted);
  }

  std::vector<double> reference_ = Noise(1);
  std::vector<std::vector<double>> causes_ = MadeUp();
  std::vector<std::vector<double>> hands_;  // from the one with all causes on
  std::array<std::span<const double>, kCauseTrialCount> without_;
};

TEST_F(ErrorCauses, AreTheirSignalsTimesTheErrorAndSumToTheWhole) {
  UseAllHands();
  const auto parts = Parts();
  ASSERT_TRUE(parts);
  std::vector<double> error(kTicks, 0.0);
  for (const auto& cause : causes_) error = Sum(error, cause);
  for (std::size_t i = 0; i < kErrorCauseCount; ++i) {
    EXPECT_NEAR((*parts)[i], Expected(causes_[i]), 1e-9) << i;
  }
  EXPECT_NEAR(std::accumulate(parts->begin(), parts->end(), 0.0), Expected(error), 1e-9);
}

TEST_F(ErrorCauses, AreOfTheTicksThatCount) {
  UseAllHands();
  const CountedTicks some = {{100, 700}, {2000, 4100}};
  const auto parts = Parts(some);
  ASSERT_TRUE(parts);
  for (std::size_t i = 0; i < kErrorCauseCount; ++i) {
    EXPECT_NEAR((*parts)[i], Expected(causes_[i], some), 1e-9) << i;
  }
  EXPECT_FALSE(Parts({}));
}

/// What cannot be taken away is in the cause behind it, and has no number.
TEST_F(ErrorCauses, LeaveWhatCannotBeTakenAwayToTheNext) {
  UseAllHands();
  without_[0] = without_[1] = {};
  const auto parts = Parts();
  ASSERT_TRUE(parts);
  EXPECT_TRUE(std::isnan((*parts)[0]));
  EXPECT_TRUE(std::isnan((*parts)[1]));
  EXPECT_NEAR((*parts)[2], Expected(Sum(Sum(causes_[0], causes_[1]), causes_[2])), 1e-9);
  EXPECT_NEAR((*parts)[3], Expected(causes_[3]), 1e-9);
}

TEST_F(ErrorCauses, AreUnknownWithoutTheLastTrial) {
  UseAllHands();
  without_.back() = {};
  EXPECT_FALSE(Parts());
}

TEST_F(ErrorCauses, AreBelowZeroWhereTheyHelp) {
  for (auto& hand : hands_) hand = reference_;
  hands_[0] = Sum(reference_, std::vector<double>(kTicks, 1.0));
  hands_[3] = Sum(reference_, std::vector<double>(kTicks, 4.0));
  UseAllHands();
  const auto parts = Parts();
  ASSERT_TRUE(parts);
  EXPECT_NEAR((*parts)[0], 1.0, 1e-12);   // 1 - 0
  EXPECT_NEAR((*parts)[2], -4.0, 1e-12);  // 0 - 4
  EXPECT_NEAR((*parts)[3], 4.0, 1e-12);
}

}  // namespace
}  // namespace gauntlet::sim
