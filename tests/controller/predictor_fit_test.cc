#include "controller/calibration/predictor_fit.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "controller/prediction/predictor.h"
#include "tests/controller/test_signal.h"

namespace gauntlet::controller {
namespace {

constexpr double kRateHz = 1000.0;
const PredictorFitOptions kOptions = {.horizon_ms = {100.0}, .order = 20, .tap_ms = 10.0};

/// Two channels that swing at two frequencies each, with white noise [counts].
Eigen::MatrixXd Glove(int samples, double noise_counts, std::uint64_t seed = 1) {
  Eigen::MatrixXd counts(samples, 2);
  TestNoise noise(seed);
  for (int k = 0; k < samples; ++k) {
    const double t = 2.0 * std::numbers::pi * k / kRateHz;
    counts(k, 0) = 500.0 + 120.0 * std::sin(0.7 * t) + 40.0 * std::sin(2.1 * t + 1.0);
    counts(k, 1) = 300.0 + 200.0 * std::sin(0.3 * t) + 20.0 * std::sin(3.0 * t + 2.0);
    for (int c = 0; c < 2; ++c) counts(k, c) += noise_counts * noise.Normal();
  }
  return counts;
}

PredictorFit Fit(const Eigen::MatrixXd& recording, const PredictorFitOptions& options = kOptions) {
  return FitPredictor({&recording, 1}, kRateHz, options);
}

/// What the weights of a channel make of white noise of deviation 1.
double NoiseGain(const PredictorFit& fit, int channel) {
  const std::size_t order = fit.predictor.order;
  double newest = 1.0;
  double squares = 0.0;
  for (std::size_t i = 0; i < order; ++i) {
    const double weight = fit.predictor.weights[order * static_cast<std::size_t>(channel) + i];
    newest -= weight;
    squares += weight * weight;
  }
  return std::sqrt(newest * newest + squares);
}

/// RMS of z(k + h) - y(k) for a recording that the fit has not seen, per channel.
Eigen::Array2d LeftOf(const PredictorFit& fit, const Eigen::MatrixXd& recording) {
  const auto predictor = MakePredictor(fit.predictor, 2, kRateHz);
  Eigen::Array2d squares = Eigen::Array2d::Zero();
  int count = 0;
  for (int k = 0; k + 100 < recording.rows(); ++k) {
    Eigen::Vector2d value = recording.row(k);
    predictor->Step({value.data(), 2}, {value.data(), 2});
    if (k < 1000) continue;
    squares += (value.transpose() - recording.row(k + 100)).transpose().array().square();
    ++count;
  }
  return (squares / count).sqrt();
}

TEST(PredictorFit, PredictsMotionsLikeThoseItWasFittedTo) {
  const PredictorFit fit = Fit(Glove(20000, 1.0));
  const Eigen::Array2d left = LeftOf(fit, Glove(21000, 1.0, 2));
  for (int c = 0; c < 2; ++c) EXPECT_LT(left[c], 0.3 * fit.hold_rms[c]) << c;
}

TEST(PredictorFit, FindsTheNoiseOfWhiteNoise) {
  const PredictorFit fit = Fit(Glove(20000, 3.0));
  for (int c = 0; c < 2; ++c) EXPECT_NEAR(fit.noise_variance[c], 9.0, 0.3);
}

TEST(PredictorFit, SaysWhatItLeavesOfAnotherRecording) {
  const PredictorFit fit = Fit(Glove(20000, 3.0));
  const Eigen::Array2d left = LeftOf(fit, Glove(21000, 3.0, 2));
  for (int c = 0; c < 2; ++c) EXPECT_NEAR(left[c], fit.fit_rms[c], 0.05 * fit.fit_rms[c]);
}

/// Caution is noise that is not there: the same weights, but for chance, as of a recording that
/// has it.
TEST(PredictorFit, IsAsCautiousAsWithSoMuchNoise) {
  PredictorFitOptions plain = kOptions;
  plain.caution = 1.0;
  PredictorFitOptions four = kOptions;
  four.caution = 4.0;
  const PredictorFit cautious = Fit(Glove(40000, 3.0), four);
  const PredictorFit noisy = Fit(Glove(40000, 6.0), plain);
  const PredictorFit bold = Fit(Glove(40000, 3.0), plain);
  for (int c = 0; c < 2; ++c) {
    EXPECT_NEAR(NoiseGain(cautious, c), NoiseGain(noisy, c), 0.1 * NoiseGain(noisy, c));
    EXPECT_LT(NoiseGain(cautious, c), 0.95 * NoiseGain(bold, c));
  }
}

TEST(PredictorFit, GivesTheSameWeightsInOtherUnits) {
  const Eigen::MatrixXd counts = Glove(8000, 2.0);
  const Eigen::MatrixXd angles = (0.005 * counts.array() - 1.3).matrix();
  const std::vector<double> in_counts = Fit(counts).predictor.weights;
  const std::vector<double> in_angles = Fit(angles).predictor.weights;
  for (std::size_t i = 0; i < in_counts.size(); ++i) {
    EXPECT_NEAR(in_angles[i], in_counts[i], 1e-7);
  }
}

TEST(PredictorFit, TakesSeveralRecordings) {
  const Eigen::MatrixXd whole = Glove(16000, 2.0);
  const std::vector<Eigen::MatrixXd> parts = {whole.topRows(8000), whole.bottomRows(8000)};
  const std::vector<double> together = FitPredictor(parts, kRateHz, kOptions).predictor.weights;
  const std::vector<double> at_once = Fit(whole).predictor.weights;
  for (std::size_t i = 0; i < at_once.size(); ++i) EXPECT_NEAR(together[i], at_once[i], 0.05);
}

TEST(PredictorFit, RefusesWhatDeterminesNoWeights) {
  const auto complaint = [](const Eigen::MatrixXd& recording,
                            const PredictorFitOptions& options = kOptions) -> std::string {
    try {
      Fit(recording, options);
      return "";
    } catch (const SettingError& error) {
      return error.what();
    }
  };
  EXPECT_EQ(complaint(Glove(400, 1.0)),
            "recording: has 100 samples with so much past and future around them, must have at "
            "least 200");
  EXPECT_EQ(complaint(Eigen::MatrixXd::Constant(4000, 2, 512.0)),
            "recording: channel 1 moves too little, or has no noise: its weights are not "
            "determined");
  Eigen::MatrixXd broken = Glove(4000, 1.0);
  broken(17, 1) = std::nan("");
  EXPECT_EQ(complaint(broken), "recording: has values that are not finite");
  EXPECT_EQ(complaint(Eigen::MatrixXd(0, 0)), "recording: has no channels");
  PredictorFitOptions far = kOptions;
  far.horizon_ms = {-1.0};
  EXPECT_EQ(complaint(Glove(4000, 1.0), far), "horizon_ms: is -1, must be from 0 to 1000");
  far.horizon_ms = {1001.0};
  EXPECT_EQ(complaint(Glove(4000, 1.0), far), "horizon_ms: is 1001, must be from 0 to 1000");
  PredictorFitOptions bold = kOptions;
  bold.caution = 0.5;
  EXPECT_EQ(complaint(Glove(4000, 1.0), bold), "caution: is 0.5, must be at least 1");
  PredictorFitOptions odd = kOptions;
  odd.tap_ms = 2.5;
  EXPECT_THAT(complaint(Glove(4000, 1.0), odd), testing::HasSubstr("tap_ms: is 2.5"));
  const std::vector<Eigen::MatrixXd> different = {Glove(4000, 1.0), Eigen::MatrixXd::Zero(10, 3)};
  EXPECT_THROW(FitPredictor(different, kRateHz, kOptions), SettingError);
}

}  // namespace
}  // namespace gauntlet::controller
