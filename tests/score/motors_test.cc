#include "sim/score/motors.h"

#include <gtest/gtest.h>

#include "tests/score/signals.h"

namespace gauntlet::sim {
namespace {

double Centroid(const std::vector<double>& speed, double rate_hz = 1000.0) {
  Fourier fourier;
  return SpectralCentroid(speed, rate_hz, All(speed), fourier);
}

TEST(SpectralCentroid, OfASineIsItsFrequency) {
  for (const double hz : {3.0, 25.0, 180.0}) {
    const auto sine =
        Sampled(7.3, 1000.0, [&](double t) { return 4.0 + std::sin(2 * kPi * hz * t); });
    EXPECT_NEAR(Centroid(sine), hz, 0.02);
  }
}

TEST(SpectralCentroid, OfTwoSinesIsWeightedByPower) {
  const auto both = Sampled(10.0, 1000.0, [](double t) {
    return 2.0 * std::sin(2.0 * kPi * 10.0 * t) + std::sin(2.0 * kPi * 60.0 * t);
  });
  EXPECT_NEAR(Centroid(both), (4.0 * 10.0 + 60.0) / 5.0, 0.05);
}

TEST(SpectralCentroid, OfWhiteNoiseIsAQuarterOfTheRate) {
  EXPECT_NEAR(Centroid(Noise(60000, 6)), 250.0, 3.0);
}

TEST(SpectralCentroid, DoesNotExistForShortOrConstantSpeeds) {
  EXPECT_TRUE(std::isnan(Centroid(Noise(900, 6))));
  EXPECT_TRUE(std::isnan(Centroid(std::vector<double>(5000, 0.0))));
  EXPECT_TRUE(std::isnan(Centroid(std::vector<double>(5000, 0.1))));
  EXPECT_TRUE(std::isnan(Centroid({})));
}

TEST(SlackShare, CountsCablesThatHangThrough) {
  const std::vector<double> tension_n{0.0, 0.01, 0.02, 5.0};
  EXPECT_DOUBLE_EQ(SlackShare(tension_n, All(tension_n)), 0.5);
  EXPECT_DOUBLE_EQ(SlackShare(tension_n, {{1, 4}}), 1.0 / 3.0);
}

}  // namespace
}  // namespace gauntlet::sim
