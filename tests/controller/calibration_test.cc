#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>

#include "controller/calibration/curve_fit.h"
#include "controller/calibration/noise_estimate.h"
#include "controller/filters/paper_noise.h"
#include "tests/controller/test_signal.h"

namespace gauntlet::controller {
namespace {

TEST(NormalQuantile, HasThePublishedValues) {
  // NIST/SEMATECH e-Handbook, 1.3.6.7.1, and symmetry.
  EXPECT_NEAR(NormalQuantile(0.975), 1.959963984540054, 1e-12);
  EXPECT_NEAR(NormalQuantile(0.995), 2.575829303548901, 1e-12);
  EXPECT_NEAR(NormalQuantile(0.025), -1.959963984540054, 1e-12);
  EXPECT_NEAR(NormalQuantile(1e-9), -5.997807015, 1e-8);
}

TEST(ChiSquaredQuantile, HasThePublishedValues) {
  // NIST/SEMATECH e-Handbook, 1.3.6.7.4.
  EXPECT_NEAR(10 * ChiSquaredQuantileRatio(0.975, 10), 20.483, 0.005 * 20.483);
  EXPECT_NEAR(10 * ChiSquaredQuantileRatio(0.025, 10), 3.247, 0.01 * 3.247);
  EXPECT_NEAR(100 * ChiSquaredQuantileRatio(0.975, 100), 129.561, 0.0005 * 129.561);
  EXPECT_NEAR(100 * ChiSquaredQuantileRatio(0.025, 100), 74.222, 0.0005 * 74.222);
}

/// A still hand whose channels have the paper's noise, rounded to counts.
Eigen::MatrixXd StillHand(int samples, std::uint64_t seed) {
  const std::vector<double> r = PaperMeasurementVariance();
  Eigen::MatrixXd counts(samples, 18);
  TestNoise noise(seed);
  for (int k = 0; k < samples; ++k) {
    for (int i = 0; i < 18; ++i) {
      counts(k, i) = std::round(400.3 + 10.7 * i + std::sqrt(r[i]) * noise.Normal());
    }
  }
  return counts;
}

TEST(EstimateNoise, GivesBackThePapersVariancesWithinItsConfidence) {
  const std::vector<double> r = PaperMeasurementVariance();
  int inside = 0;
  constexpr int kTrials = 20;
  for (int trial = 0; trial < kTrials; ++trial) {
    const NoiseEstimate estimate = EstimateNoise(StillHand(3000, 50 + trial), {{0, 3000}});
    for (int i = 0; i < 18; ++i) {
      inside += estimate.variance_low[i] <= r[i] && r[i] <= estimate.variance_high[i];
      EXPECT_NEAR(estimate.variance[i], r[i], 0.15 * r[i]);
    }
  }
  // 360 intervals of 95 %: 342 expected, standard deviation 4.1.
  EXPECT_GE(inside, 342 - 17);
  EXPECT_LE(inside, 342 + 17);
}

TEST(EstimateNoise, FindsTheCovarianceOfCoupledChannels) {
  Eigen::Matrix2d truth;
  truth << 9.0, 4.0, 4.0, 16.0;
  const Eigen::Matrix2d root = truth.llt().matrixL();
  TestNoise noise(5);
  Eigen::MatrixXd counts(20000, 2);
  for (int k = 0; k < 20000; ++k) {
    counts.row(k) = (root * Eigen::Vector2d(noise.Normal(), noise.Normal())).transpose();
  }
  const NoiseEstimate estimate =
      EstimateNoise(counts, {{0, 8000}, {9000, 20000}}, {.resolution_counts = 0.0});
  EXPECT_EQ(estimate.degrees_of_freedom, 7999 + 10999);
  for (int i = 0; i < 2; ++i) {
    for (int j = 0; j < 2; ++j) {
      EXPECT_NEAR(estimate.covariance(i, j), truth(i, j), 0.05 * truth(i, j));
      EXPECT_LE(estimate.covariance_low(i, j), truth(i, j));
      EXPECT_GE(estimate.covariance_high(i, j), truth(i, j));
    }
  }
}

TEST(EstimateNoise, IsLessSureOfNoiseThatIsNotWhite) {
  TestNoise noise(6);
  Eigen::MatrixXd counts(5000, 2);
  double slow = 0.0;
  for (int k = 0; k < 5000; ++k) {
    slow = 0.9 * slow + noise.Normal();
    counts.row(k) << noise.Normal(), slow;
  }
  const NoiseEstimate estimate = EstimateNoise(counts, {{0, 5000}}, {.resolution_counts = 0.0});
  EXPECT_NEAR(estimate.correlation[0], 0.0, 0.05);
  EXPECT_NEAR(estimate.correlation[1], 0.9, 0.03);
  const Eigen::ArrayXd width =
      (estimate.variance_high - estimate.variance_low).cwiseQuotient(estimate.variance);
  EXPECT_GT(width[1], 2.5 * width[0]);
}

TEST(FindStillStretches, FindsTheRestsBetweenMotions) {
  Eigen::MatrixXd counts = StillHand(6000, 9);
  for (int k = 2000; k < 3500; ++k) counts(k, 4) += 150.0 * std::sin(0.004 * (k - 2000));
  for (int k = 3500; k < 6000; ++k) counts(k, 4) += 150.0 * std::sin(0.004 * 1500);
  const auto stretches = FindStillStretches(counts, 1000.0);
  ASSERT_EQ(stretches.size(), 2u);
  EXPECT_EQ(stretches[0].begin, 0);
  EXPECT_NEAR(stretches[0].end, 2000, 60);
  EXPECT_NEAR(stretches[1].begin, 3500, 60);
  EXPECT_EQ(stretches[1].end, 6000);
}

TEST(FitTable, GivesBackTheCornersOfItsPoses) {
  TestNoise noise(7);
  Eigen::VectorXd counts(900), angle_deg(900);
  const double corner_counts[] = {820.0, 500.0, 240.0};
  for (int k = 0; k < 900; ++k) {
    const int pose = k / 300;
    angle_deg[k] = 45.0 * pose;
    counts[k] = corner_counts[pose] + 4.0 * noise.Normal();
  }
  const CurveFit fit = FitTable(counts, angle_deg);
  ASSERT_EQ(fit.curve.counts.size(), 3u);
  for (int i = 0; i < 3; ++i) {
    EXPECT_NEAR(fit.curve.counts[i], corner_counts[2 - i], 1.0);
    EXPECT_EQ(fit.curve.angle_deg[i], 90.0 - 45.0 * i);
    // 4 counts / sqrt(300) times 1.97, at 45 / 260 deg per count or 45 / 320.
    EXPECT_NEAR(fit.half_width_95_deg[i], 0.455 * 45.0 / (i == 2 ? 320.0 : 260.0), 0.01);
  }
}

TEST(FitTable, RefusesPosesThatAreNotInOrder) {
  Eigen::VectorXd counts(3), angle_deg(3);
  counts << 100, 300, 200;
  angle_deg << 0, 45, 90;
  EXPECT_THROW(FitTable(counts, angle_deg), SettingError);
  angle_deg << 30, 30, 30;
  EXPECT_THROW(FitTable(counts, angle_deg), SettingError);
}

TEST(FitPolynomial, GivesBackACurveWithinItsConfidence) {
  TestNoise noise(8);
  int inside = 0;
  for (int trial = 0; trial < 50; ++trial) {
    Eigen::VectorXd counts(400), angle_deg(400);
    for (int k = 0; k < 400; ++k) {
      counts[k] = 200.0 + 600.0 * k / 399.0;
      const double u = (counts[k] - 500.0) / 300.0;
      angle_deg[k] = 40.0 + 45.0 * u - 6.0 * u * u + noise.Normal();
    }
    const CurveFit fit = FitPolynomial(counts, angle_deg, 2);
    EXPECT_NEAR(fit.rms_error_deg, 1.0, 0.15);
    EXPECT_EQ(fit.curve.center_counts, 500.0);
    const double truth[] = {40.0, 45.0, -6.0};
    for (int i = 0; i < 3; ++i) {
      inside += std::abs(fit.curve.coefficients_deg[i] - truth[i]) <= fit.half_width_95_deg[i];
    }
  }
  // 150 intervals of 95 %: 142.5 expected, standard deviation 2.7 (the three are correlated).
  EXPECT_GE(inside, 130);
  EXPECT_LT(inside, 150);
}

TEST(FitPolynomial, RefusesADegreeThatTheDataCannotBear) {
  Eigen::VectorXd counts(4), angle_deg(4);
  counts << 100, 100, 200, 200;
  angle_deg << 0, 1, 50, 51;
  EXPECT_THROW(FitPolynomial(counts, angle_deg, 2), SettingError);
  counts << 100, 200, 300, 400;
  angle_deg << 0, 50, 50, 0;  // a hill
  EXPECT_THROW(FitPolynomial(counts, angle_deg, 2), SettingError);
}

}  // namespace
}  // namespace gauntlet::controller
