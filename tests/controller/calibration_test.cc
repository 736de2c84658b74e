#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>

#include "controller/calibration/curve_fit.h"
#include "controller/calibration/noise_correlation.h"
#include "controller/calibration/noise_estimate.h"
#include "controller/calibration/rounded_noise.h"
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

/// What a matrix, samples x channels, holds; a temporary one lives as long as the call.
std::span<const double> Of(const Eigen::MatrixXd& values) {
  return {values.data(), static_cast<std::size_t>(values.size())};
}
std::span<const double> Of(const Eigen::VectorXd& values) {
  return {values.data(), static_cast<std::size_t>(values.size())};
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
    const NoiseEstimate estimate = EstimateNoise(Of(StillHand(3000, 50 + trial)), 18, {{0, 3000}});
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
      EstimateNoise(Of(counts), static_cast<int>(counts.cols()), {{0, 8000}, {9000, 20000}},
                    {.resolution_counts = 0.0});
  EXPECT_EQ(estimate.degrees_of_freedom, 7999 + 10999);
  for (int i = 0; i < 2; ++i) {
    for (int j = 0; j < 2; ++j) {
      EXPECT_NEAR(estimate.covariance[2 * i + j], truth(i, j), 0.05 * truth(i, j));
      EXPECT_LE(estimate.covariance_low[2 * i + j], truth(i, j));
      EXPECT_GE(estimate.covariance_high[2 * i + j], truth(i, j));
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
  const NoiseEstimate estimate = EstimateNoise(Of(counts), static_cast<int>(counts.cols()),
                                               {{0, 5000}}, {.resolution_counts = 0.0});
  EXPECT_NEAR(estimate.correlation[0], 0.0, 0.05);
  EXPECT_NEAR(estimate.correlation[1], 0.9, 0.03);
  const auto width = [&](int i) {
    return (estimate.variance_high[i] - estimate.variance_low[i]) / estimate.variance[i];
  };
  EXPECT_GT(width(1), 2.5 * width(0));
}

/// Still samples around `level` with first-order noise, rounded to counts.
Eigen::VectorXd StillChannel(int samples, double level, double deviation, double correlation,
                             TestNoise& noise) {
  Eigen::VectorXd counts(samples);
  double state = noise.Normal();
  for (int k = 0; k < samples; ++k) {
    state = correlation * state + std::sqrt(1.0 - correlation * correlation) * noise.Normal();
    counts[k] = std::round(level + deviation * state);
  }
  return counts;
}

TEST(EstimateNoise, LeavesSpikesOutAndCountsThem) {
  TestNoise noise(11);
  Eigen::MatrixXd counts = StillChannel(10000, 400.3, 3.0, 0.0, noise);
  for (int k = 50; k < 10000; k += 100) counts(k, 0) += k % 200 == 50 ? 124.0 : -124.0;
  const NoiseEstimate estimate =
      EstimateNoise(Of(counts), static_cast<int>(counts.cols()), {{0, 5000}, {5000, 10000}});
  EXPECT_EQ(estimate.spikes[0], 100);
  EXPECT_NEAR(estimate.variance[0], 9.0, 0.5);
  EXPECT_LE(estimate.variance_low[0], 9.0);
  EXPECT_GE(estimate.variance_high[0], 9.0);
}

/// Of 100 repeats, in how many the interval holds the truth.
int Held(double deviation, double correlation, int stretch_count) {
  TestNoise noise(12);
  int held = 0;
  for (int repeat = 0; repeat < 100; ++repeat) {
    constexpr int kSamples = 1000;
    Eigen::MatrixXd counts(kSamples * stretch_count, 1);
    std::vector<StillStretch> stretches;
    for (int i = 0; i < stretch_count; ++i) {
      counts.middleRows(i * kSamples, kSamples) =
          StillChannel(kSamples, 300.0 + 7.0 * i + noise.Uniform(), deviation, correlation, noise);
      stretches.push_back({i * kSamples, (i + 1) * kSamples});
    }
    const NoiseEstimate estimate =
        EstimateNoise(Of(counts), static_cast<int>(counts.cols()), stretches);
    const double truth = deviation * deviation;
    held += estimate.variance_low[0] <= truth && truth <= estimate.variance_high[0];
  }
  return held;
}

// 95 expected, standard deviation 2.2.
TEST(EstimateNoise, IsUnsureEnoughOfNoiseThatRoundingHides) {
  for (const double deviation : {0.1, 0.2, 0.3, 0.4, 0.5}) {
    EXPECT_GE(Held(deviation, 0.0, 5), 88) << deviation;
  }
  EXPECT_LE(Held(0.5, 0.0, 5), 99) << "where rounding hides little, the interval is not too wide";
}

TEST(EstimateNoise, IsUnsureEnoughOfSlowNoise) {
  for (const double correlation : {-0.5, 0.5, 0.8, 0.9, 0.95}) {
    EXPECT_GE(Held(4.0, correlation, 5), 88) << correlation;
  }
}

TEST(EstimateRoundedNoise, HasTheWidthOfChiSquaredWhereRoundingHidesLittle) {
  TestNoise noise(20);
  constexpr int kSamples = 4000;
  const std::vector<Eigen::VectorXd> stretches = {StillChannel(kSamples, 400.3, 1.5, 0.0, noise)};
  const auto width = [&](double weight, double confidence) {
    const RoundedNoise estimate = EstimateRoundedNoise(stretches, 1.0, weight, confidence);
    return (estimate.variance_high - estimate.variance_low) / estimate.variance;
  };
  // Of the variance, relative, if all that rounding adds were known: 1/12 to 1.5^2.
  const double deviation = std::sqrt(2.0 / kSamples) * (1.0 + 1.0 / (12.0 * 1.5 * 1.5));
  EXPECT_NEAR(width(1.0, 0.95), 2.0 * NormalQuantile(0.975) * deviation, 0.1 * deviation);
  EXPECT_NEAR(width(1.0, 0.5), 2.0 * NormalQuantile(0.75) * deviation, 0.1 * deviation);
  EXPECT_NEAR(width(0.25, 0.95), 4.0 * NormalQuantile(0.975) * deviation, 0.3 * deviation);
}

TEST(EstimateNoise, SaysWhatRoundingHides) {
  TestNoise noise(13);
  Eigen::MatrixXd counts(4000, 3);
  counts.col(0) = StillChannel(4000, 400.5, 0.3, 0.0, noise);
  counts.col(1) = StillChannel(4000, 400.5, 2.0, 0.0, noise);
  counts.col(2).setConstant(400.0);
  const NoiseEstimate estimate =
      EstimateNoise(Of(counts), static_cast<int>(counts.cols()), {{0, 4000}});
  EXPECT_EQ(estimate.rounded, (std::vector<bool>{true, false, true}));
  EXPECT_EQ(estimate.variance_low[2], 0.0);
  EXPECT_GT(estimate.variance_high[2], 0.01) << "0.1 counts in the middle of a step cannot be seen";
  EXPECT_LT(estimate.variance_high[2], 0.25);
}

class StillHandWith : public testing::TestWithParam<double> {};

TEST_P(StillHandWith, CorrelatedNoiseHoldsStill) {
  TestNoise noise(14);
  Eigen::MatrixXd counts(9000, 3);
  for (int i = 0; i < 3; ++i) {
    counts.col(i).head(4000) = StillChannel(4000, 300.0, 4.0, GetParam(), noise);
    counts.col(i).tail(5000) = StillChannel(5000, 450.0, 4.0, GetParam(), noise);
  }
  const auto stretches = FindStillStretches(Of(counts), static_cast<int>(counts.cols()), 1000.0);
  double samples = 0.0;
  for (const StillStretch& stretch : stretches) {
    samples += static_cast<double>(stretch.end - stretch.begin);
    EXPECT_TRUE(stretch.end <= 4000 || stretch.begin >= 4000) << "both levels in one";
  }
  EXPECT_GT(samples, 0.8 * 9000);
}

INSTANTIATE_TEST_SUITE_P(Correlations, StillHandWith, testing::Values(0.0, 0.5, 0.8, 0.9, 0.95));

/// Still samples of which a share of the variance is white, on top of slow noise.
Eigen::VectorXd SlowUnderWhite(int samples, double white_share, TestNoise& noise) {
  constexpr double kCorrelation = 0.98;
  Eigen::VectorXd counts(samples);
  double slow = noise.Normal();
  for (int k = 0; k < samples; ++k) {
    slow = kCorrelation * slow + std::sqrt(1.0 - kCorrelation * kCorrelation) * noise.Normal();
    const double sum =
        std::sqrt(1.0 - white_share) * slow + std::sqrt(white_share) * noise.Normal();
    counts[k] = std::round(400.0 + 3.0 * sum);
  }
  return counts;
}

TEST(FindStillStretches, AreNotEndedBySlowNoiseUnderWhiteNoise) {
  for (const double white_share : {0.2, 0.5, 0.8}) {
    TestNoise noise(17);
    constexpr int kRepeats = 20;
    constexpr int kSamples = 9000;
    double samples = 0.0;
    for (int repeat = 0; repeat < kRepeats; ++repeat) {
      Eigen::MatrixXd counts(kSamples, 3);
      for (int i = 0; i < 3; ++i) counts.col(i) = SlowUnderWhite(kSamples, white_share, noise);
      for (const StillStretch& stretch :
           FindStillStretches(Of(counts), static_cast<int>(counts.cols()), 1000.0)) {
        samples += static_cast<double>(stretch.end - stretch.begin);
      }
    }
    EXPECT_GT(samples, 0.8 * kRepeats * kSamples) << white_share;
  }
}

// Its small correlation falls slowly: cut off too early, 90 % of the means would be within 1.96
// standard deviations of theirs.
TEST(DescribeNoise, KnowsHowFarMeansAreOffUnderSlowNoise) {
  constexpr int kRepeats = 400;
  constexpr int kStretches = 6;
  constexpr int kSamples = 1500;
  TestNoise noise(18);
  int held = 0;
  for (int repeat = 0; repeat < kRepeats; ++repeat) {
    std::vector<Eigen::VectorXd> stretches;
    for (int i = 0; i < kStretches; ++i) stretches.push_back(SlowUnderWhite(kSamples, 0.8, noise));
    const ChannelNoise described = DescribeNoise(stretches, 1.0 / 12.0);
    const double deviation =
        std::sqrt(described.MeanFactor(kSamples) * described.variance / kSamples);
    for (const Eigen::VectorXd& stretch : stretches) {
      held += std::abs(stretch.mean() - 400.0) < 1.96 * deviation;
    }
  }
  EXPECT_GE(held, 0.93 * kRepeats * kStretches);
  EXPECT_LE(held, 0.97 * kRepeats * kStretches);
}

TEST(FindStillStretches, AreNotEndedBySpikes) {
  TestNoise noise(15);
  Eigen::MatrixXd counts = StillChannel(5000, 300.0, 3.0, 0.0, noise);
  for (int k = 0; k < 5000; k += 25) counts(k, 0) += 124.0;
  const auto stretches = FindStillStretches(Of(counts), static_cast<int>(counts.cols()), 1000.0);
  ASSERT_EQ(stretches.size(), 1u);
  EXPECT_EQ(stretches[0].end, 5000);
}

TEST(FindStillStretches, FindsNoneInASlowSwing) {
  TestNoise noise(16);
  for (const double period_s : {1.0, 2.0, 4.0}) {
    Eigen::MatrixXd counts = StillChannel(8000, 0.0, 3.0, 0.0, noise);
    for (int k = 0; k < 8000; ++k) {
      counts(k, 0) += std::round(500.0 + 200.0 * std::sin(6.283185307 * k / (1000.0 * period_s)));
    }
    EXPECT_TRUE(FindStillStretches(Of(counts), static_cast<int>(counts.cols()), 1000.0).empty())
        << period_s;
  }
}

TEST(FindStillStretches, FindsNoneInASlowDrift) {
  TestNoise noise(19);
  Eigen::MatrixXd counts = StillChannel(8000, 0.0, 3.0, 0.0, noise);
  // 1 count from one level to the next, which alone is within the noise.
  for (int k = 0; k < 8000; ++k) counts(k, 0) += std::round(300.0 + 0.02 * k);
  EXPECT_TRUE(FindStillStretches(Of(counts), static_cast<int>(counts.cols()), 1000.0).empty());
}

TEST(FindStillStretches, FindsTheRestsBetweenMotions) {
  Eigen::MatrixXd counts = StillHand(6000, 9);
  for (int k = 2000; k < 3500; ++k) counts(k, 4) += 150.0 * std::sin(0.004 * (k - 2000));
  for (int k = 3500; k < 6000; ++k) counts(k, 4) += 150.0 * std::sin(0.004 * 1500);
  const auto stretches = FindStillStretches(Of(counts), static_cast<int>(counts.cols()), 1000.0);
  ASSERT_EQ(stretches.size(), 2u);
  EXPECT_EQ(stretches[0].begin, 0);
  EXPECT_EQ(stretches[0].end, 1950) << "the 50 ms beside a motion are left out";
  EXPECT_EQ(stretches[1].begin, 3550);
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
  const CurveFit fit = FitTable(Of(counts), Of(angle_deg));
  ASSERT_EQ(fit.curve.counts.size(), 3u);
  for (int i = 0; i < 3; ++i) {
    EXPECT_NEAR(fit.curve.counts[i], corner_counts[2 - i], 1.0);
    EXPECT_EQ(fit.curve.angle_deg[i], 90.0 - 45.0 * i);
    // 4 counts / sqrt(300) times 1.97, at 45 / 260 deg per count or 45 / 320.
    EXPECT_NEAR(fit.half_width_95_deg[i], 0.455 * 45.0 / (i == 2 ? 320.0 : 260.0), 0.01);
  }
}

TEST(FitTable, IsUnsureEnoughOfNoiseThatIsNotWhite) {
  TestNoise noise(17);
  int held = 0;
  constexpr int kRepeats = 100;
  for (int repeat = 0; repeat < kRepeats; ++repeat) {
    Eigen::VectorXd counts(1200), angle_deg(1200);
    for (int pose = 0; pose < 2; ++pose) {
      counts.segment(600 * pose, 600) = StillChannel(600, 300.3 + 300.0 * pose, 4.0, 0.5, noise);
      angle_deg.segment(600 * pose, 600).setConstant(90.0 * pose);
    }
    const CurveFit fit = FitTable(Of(counts), Of(angle_deg));
    const double counts_per_deg = (fit.curve.counts[1] - fit.curve.counts[0]) / 90.0;
    for (int pose = 0; pose < 2; ++pose) {
      held += std::abs(fit.curve.counts[pose] - (300.3 + 300.0 * pose)) <=
              counts_per_deg * fit.half_width_95_deg[pose];
    }
  }
  // 190 of 200 expected, standard deviation 3.1; for white noise it would be 150.
  EXPECT_GE(held, 180);
  EXPECT_LE(held, 199);
}

TEST(FitTable, RefusesPosesThatAreNotInOrder) {
  Eigen::VectorXd counts(3), angle_deg(3);
  counts << 100, 300, 200;
  angle_deg << 0, 45, 90;
  EXPECT_THROW(FitTable(Of(counts), Of(angle_deg)), SettingError);
  angle_deg << 30, 30, 30;
  EXPECT_THROW(FitTable(Of(counts), Of(angle_deg)), SettingError);
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
    const CurveFit fit = FitPolynomial(Of(counts), Of(angle_deg), 2);
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
  EXPECT_THROW(FitPolynomial(Of(counts), Of(angle_deg), 2), SettingError);
  counts << 100, 200, 300, 400;
  angle_deg << 0, 50, 50, 0;  // a hill
  EXPECT_THROW(FitPolynomial(Of(counts), Of(angle_deg), 2), SettingError);
}

}  // namespace
}  // namespace gauntlet::controller
