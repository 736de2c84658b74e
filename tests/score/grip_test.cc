#include "sim/score/grip.h"

#include <gtest/gtest.h>

#include "tests/score/signals.h"

namespace gauntlet::sim {
namespace {

double Ripple(const std::vector<double>& force_n) {
  Fourier fourier;
  return GripForceRipple(force_n, 1000.0, 10.0, All(force_n), fourier);
}

/// A grip of 20 N from 1 to 6 s that rises and falls within 50 ms, with a slow swing of 2 N and a
/// ripple on top.
std::vector<double> Grip(double ripple_n, double ripple_hz) {
  return Sampled(8.0, 1000.0, [=](double t) {
    const double share = std::clamp(std::min((t - 1.0) / 0.05, (6.0 - t) / 0.05), 0.0, 1.0);
    return share * (20.0 + 2.0 * std::sin(2.0 * kPi * 0.5 * t) +
                    ripple_n * std::sin(2.0 * kPi * ripple_hz * t));
  });
}

TEST(GripForceRipple, IsTheRmsOfWhatIsFastWhileTheHandHolds) {
  EXPECT_NEAR(Ripple(Grip(1.0, 25.0)), 1.0 / std::sqrt(2.0), 2e-3);
  EXPECT_NEAR(Ripple(Grip(0.3, 12.0)), 0.3 / std::sqrt(2.0), 2e-3);
}

TEST(GripForceRipple, DoesNotCountClosingOpeningAndSlowChanges) {
  EXPECT_LT(Ripple(Grip(0.0, 25.0)), 1e-3);
  EXPECT_LT(Ripple(Grip(1.0, 1.0)), 1e-3);
}

TEST(GripForceRipple, PoolsSeveralGrips) {
  std::vector<double> both = Grip(1.0, 25.0);
  const std::vector<double> calm = Grip(0.0, 25.0);
  both.insert(both.end(), calm.begin(), calm.end());
  EXPECT_NEAR(Ripple(both), 0.5, 2e-3);
}

TEST(GripForceRipple, BeginsAtATenthOfANewton) {
  const auto swings_around = [](double force_n) {
    return Sampled(5.0, 1000.0, [force_n](double t) {
      return force_n + 0.005 * std::sin(2.0 * kPi * 25.0 * t);
    });
  };
  EXPECT_NEAR(Ripple(swings_around(0.106)), 0.005 / std::sqrt(2.0), 1e-5);
  EXPECT_TRUE(std::isnan(Ripple(swings_around(0.094))));
}

TEST(GripForceRipple, DoesNotExistWithoutAGrip) {
  EXPECT_TRUE(std::isnan(Ripple({})));
  EXPECT_TRUE(std::isnan(Ripple(std::vector<double>(5000, 0.0))));
  EXPECT_TRUE(std::isnan(Ripple(std::vector<double>(1000, 20.0)))) << "too short";
}

}  // namespace
}  // namespace gauntlet::sim
