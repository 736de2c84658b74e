#include "controller/calibration/predictor_fit.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "controller/prediction/predictor.h"
#include "tests/controller/test_signal.h"
#include "tests/support/gram_schmidt.h"

namespace gauntlet::controller {
namespace {

constexpr double kRateHz = 1000.0;
const FittedToOthersPredictionConfig kOptions = {
    .horizon_ms = {100.0}, .order = 20, .tap_ms = 10.0, .fallback = false};

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

PredictorFit Fit(const Eigen::MatrixXd& recording,
                 const FittedToOthersPredictionConfig& options = kOptions) {
  return FitPredictor({&recording, 1}, kRateHz, options);
}

/// What the predictor of two channels makes of white noise of deviation 1 on each, by what it
/// answers to an impulse on either.
double NoiseGain(const PredictorFit& fit, int channel) {
  FittedPredictionConfig config = fit.predictor;
  config.offset_deg.clear();
  double squares = 0.0;
  for (int hit = 0; hit < 2; ++hit) {
    const auto predictor = MakePredictor(config, 2, kRateHz);
    std::vector<double> value(2);
    predictor->Step(value, value);
    for (int k = 0; k <= fit.predictor.order * 10; ++k) {
      value.assign(2, 0.0);
      if (k == 0) value[static_cast<std::size_t>(hit)] = 1.0;
      predictor->Step(value, value);
      squares +=
          value[static_cast<std::size_t>(channel)] * value[static_cast<std::size_t>(channel)];
    }
  }
  return std::sqrt(squares);
}

/// Two channels, the second of which does what the first did 80 ms before, and a little of its own.
Eigen::MatrixXd Following(int samples, std::uint64_t seed, double noise_deg = 0.05) {
  Eigen::MatrixXd angles(samples, 2);
  TestNoise noise(seed);
  const Eigen::ArrayXd free = [&] {
    Eigen::ArrayXd smooth(samples + 80);
    double speed = 0.0, angle = 0.0;
    for (double& value : smooth) {  // a swing of about 1 Hz that noise drives
      speed += 0.02 * noise.Normal() - 4e-5 * angle - 3e-3 * speed;
      angle += speed;
      value = angle;
    }
    return smooth;
  }();
  for (int k = 0; k < samples; ++k) {
    angles(k, 0) = free[k + 80] + noise_deg * noise.Normal();
    angles(k, 1) = 0.5 * free[k] + noise_deg * noise.Normal();
  }
  return angles;
}

FittedToOthersPredictionConfig WithOffset(bool all_channels, double caution = 1.0) {
  FittedToOthersPredictionConfig options = kOptions;
  options.offset = true;
  options.all_channels = all_channels;
  options.caution = caution;
  return options;
}

/// RMS of z(k + h) - y(k) for a recording that the fit has not seen, per channel.
Eigen::ArrayXd LeftOf(const PredictorFit& fit, const Eigen::MatrixXd& recording) {
  return JudgePredictor(fit.predictor, {&recording, 1}, kRateHz).left_rms;
}

TEST(PredictorFit, PredictsMotionsLikeThoseItWasFittedTo) {
  const PredictorFit fit = Fit(Glove(20000, 1.0));
  const Eigen::ArrayXd left = LeftOf(fit, Glove(21000, 1.0, 2));
  for (int c = 0; c < 2; ++c) EXPECT_LT(left[c], 0.3 * fit.hold_rms[c]) << c;
}

// At 50 Hz, 30 ms are a sample and a half: of a straight line the weights then foresee just that.
TEST(PredictorFit, LooksAheadByPartsOfASample) {
  Eigen::MatrixXd line(2000, 1);
  TestNoise noise(5);
  double value = 0.0;
  double slope = 0.01;
  for (Eigen::Index k = 0; k < line.rows(); ++k) {
    if (k % 100 == 0) slope = 0.02 * noise.Uniform() - 0.01;
    line(k, 0) = value += slope;
  }
  const auto foreseen = [&line](double horizon_ms) {
    const PredictorFit fit =
        FitPredictor({&line, 1}, 50.0,
                     {.horizon_ms = {horizon_ms}, .order = 2, .tap_ms = 20.0, .fallback = false});
    const auto predictor = MakePredictor(fit.predictor, 1, 50.0);
    std::vector<double> angle(1);
    for (int k = 0; k < 50; ++k) {
      angle[0] = k;
      predictor->Step(angle, angle);
    }
    return angle[0] - 49.0;
  };
  const double whole = foreseen(20.0);
  EXPECT_NEAR(foreseen(30.0), 1.5 * whole, 0.05 * whole);
  EXPECT_NEAR(foreseen(8.0), 0.4 * whole, 0.05 * whole);
  EXPECT_DOUBLE_EQ(foreseen(20.001), whole);  // as a rounded number of ms
}

TEST(PredictorFit, FindsTheNoiseOfWhiteNoise) {
  const PredictorFit fit = Fit(Glove(20000, 3.0));
  for (int c = 0; c < 2; ++c) EXPECT_NEAR(fit.noise_variance[c], 9.0, 0.3);
}

TEST(PredictorFit, SaysWhatItLeavesOfAnotherRecording) {
  const PredictorFit fit = Fit(Glove(20000, 3.0));
  const Eigen::ArrayXd left = LeftOf(fit, Glove(21000, 3.0, 2));
  for (int c = 0; c < 2; ++c) EXPECT_NEAR(left[c], fit.fit_rms[c], 0.05 * fit.fit_rms[c]);
}

/// Caution is noise that is not there: the same weights, but for chance, as of a recording that
/// has it.
TEST(PredictorFit, IsAsCautiousAsWithSoMuchNoise) {
  FittedToOthersPredictionConfig plain = kOptions;
  plain.caution = 1.0;
  FittedToOthersPredictionConfig four = kOptions;
  four.caution = 4.0;
  const PredictorFit cautious = Fit(Glove(40000, 3.0), four);
  const PredictorFit noisy = Fit(Glove(40000, 6.0), plain);
  const PredictorFit bold = Fit(Glove(40000, 3.0), plain);
  for (int c = 0; c < 2; ++c) {
    EXPECT_NEAR(NoiseGain(cautious, c), NoiseGain(noisy, c), 0.1 * NoiseGain(noisy, c));
    EXPECT_LT(NoiseGain(cautious, c), 0.95 * NoiseGain(bold, c));
  }
}

TEST(PredictorFit, IsAsCautiousWithAllChannelsAsWithSoMuchNoise) {
  const PredictorFit cautious = Fit(Following(200000, 1), WithOffset(true, 4.0));
  const PredictorFit noisy = Fit(Following(200000, 1, 0.1), WithOffset(true));
  for (int c = 0; c < 2; ++c) {
    EXPECT_NEAR(NoiseGain(cautious, c), NoiseGain(noisy, c), 0.1 * NoiseGain(noisy, c));
  }
}

TEST(PredictorFit, LearnsFromAChannelThatIsAhead) {
  const Eigen::MatrixXd recording = Following(30000, 1);
  const Eigen::MatrixXd other = Following(20000, 2);
  const PredictorFit alone = Fit(recording, WithOffset(false));
  const PredictorFit together = Fit(recording, WithOffset(true));
  EXPECT_LT(LeftOf(together, other)[1], 0.6 * LeftOf(alone, other)[1]);
  EXPECT_LT(together.held_out_rms[1], 0.6 * alone.held_out_rms[1]);
  for (const PredictorFit& fit : {alone, together}) {
    const Eigen::ArrayXd left = LeftOf(fit, other);
    for (int c = 0; c < 2; ++c) EXPECT_NEAR(left[c], fit.held_out_rms[c], 0.2 * left[c]) << c;
  }
}

/// A motion about a middle: where a channel is says where it goes.
TEST(PredictorFit, DrawsToTheMiddleWithAnOffset) {
  const Eigen::MatrixXd recording = Following(30000, 1).array() + 25.0;
  const PredictorFit fit = Fit(recording, WithOffset(false));
  const Eigen::MatrixXd other = Following(20000, 2).array() + 25.0;
  EXPECT_LT(LeftOf(fit, other)[1], 0.98 * LeftOf(Fit(recording), other)[1]);
  for (int c = 0; c < 2; ++c) {
    const double pull = fit.predictor.position_weights[static_cast<std::size_t>(c)];
    EXPECT_LT(pull, 0.0);
    EXPECT_NEAR(fit.predictor.offset_deg[static_cast<std::size_t>(c)] / -pull,
                recording.col(c).mean(), 2.0);
  }
}

/// A channel of which nothing is known says nothing to the others.
TEST(PredictorFit, LeavesOutADeadChannelOfTheOthers) {
  Eigen::MatrixXd recording = Following(20000, 1);
  Eigen::MatrixXd with_dead(recording.rows(), 3);
  with_dead << recording, Eigen::VectorXd::Constant(recording.rows(), 7.0);
  const auto complaint = [&] {
    try {
      Fit(with_dead, WithOffset(true));
    } catch (const SettingError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  // Its own weights are not determined; those of the others are.
  EXPECT_THAT(complaint(), testing::StartsWith("recording: channel 3 moves too little"));
}

/// The equation of the header with every regressor written out, solved another way.
TEST(PredictorFit, SolvesTheEquationOfItsHeader) {
  constexpr int kOrder = 7, kTap = 15, kAhead = 40, kRows = 4000;
  const Eigen::MatrixXd z = Following(kRows, 4);
  const PredictorFit fit = Fit(z, {.horizon_ms = {kAhead},
                                   .order = kOrder,
                                   .tap_ms = kTap,
                                   .caution = 2.5,
                                   .offset = true,
                                   .all_channels = true});
  const auto mean = [&](int now, int c, int tap) {
    return z.col(c).segment(now - tap * kTap, kTap).mean();
  };
  constexpr int kWeights = kOrder + 4;  // positions of both, the slope of the other, 1
  for (int c = 0; c < 2; ++c) {
    const int other = 1 - c;
    // How each regressor and the end take the white noise of: z(now), m_1 .. m_order of both.
    Eigen::MatrixXd of_noise = Eigen::MatrixXd::Zero(kWeights, 2 * (kOrder + 1));
    const auto place = [](int channel, int tap) { return channel * (kOrder + 1) + tap; };
    for (int i = 1; i <= kOrder; ++i) {
      of_noise(i - 1, place(c, i)) = 1.0;
      of_noise(i - 1, place(c, 0)) = -1.0;
    }
    of_noise(kOrder, place(c, 1)) = 1.0;
    of_noise(kOrder + 1, place(other, 1)) = 1.0;
    of_noise(kOrder + 2, place(other, 1)) = 1.0;
    of_noise(kOrder + 2, place(other, 6)) = -1.0;
    Eigen::VectorXd end_of_noise = Eigen::VectorXd::Zero(2 * (kOrder + 1));
    end_of_noise[place(c, 0)] = -1.0;
    Eigen::VectorXd variance(2 * (kOrder + 1));
    for (int channel = 0; channel < 2; ++channel) {
      for (int tap = 0; tap <= kOrder; ++tap) {
        variance[place(channel, tap)] = 1.5 * fit.noise_variance[channel] / (tap == 0 ? 1 : kTap);
      }
    }
    Eigen::MatrixXd matrix = (of_noise * variance.asDiagonal()).lazyProduct(of_noise.transpose());
    Eigen::VectorXd right = of_noise * variance.asDiagonal() * end_of_noise;
    int count = 0;
    for (int now = kOrder * kTap; now + kAhead < kRows; now += kTap) ++count;
    for (int now = kOrder * kTap; now + kAhead < kRows; now += kTap) {
      Eigen::VectorXd p(kWeights);
      for (int i = 1; i <= kOrder; ++i) p[i - 1] = mean(now, c, i) - z(now, c);
      p.tail(4) << mean(now, c, 1), mean(now, other, 1), mean(now, other, 1) - mean(now, other, 6),
          1.0;
      matrix += p * p.transpose() / count;
      right += p * (z(now + kAhead, c) - z(now, c)) / count;
    }
    const Eigen::VectorXd expected =
        test::SolveByGramSchmidt<Eigen::MatrixXd>(matrix, right).value();
    const FittedPredictionConfig& found = fit.predictor;
    for (int i = 0; i < kOrder; ++i) EXPECT_NEAR(found.weights[kOrder * c + i], expected[i], 1e-7);
    EXPECT_NEAR(found.position_weights[2 * c + c], expected[kOrder], 1e-7);
    EXPECT_NEAR(found.position_weights[2 * c + other], expected[kOrder + 1], 1e-7);
    EXPECT_NEAR(found.slope_weights[2 * c + other], expected[kOrder + 2], 1e-7);
    EXPECT_NEAR(found.offset_deg[c], expected[kOrder + 3], 1e-6);
    EXPECT_EQ(found.slope_weights[2 * c + c], 0.0);
  }
}

/// Each motion by weights that never saw it, as if it had been left out by hand.
TEST(PredictorFit, FitsEachMotionToAllOthers) {
  const std::vector<RecordedMotion> motions = {
      {Following(5000, 1)}, {Following(4000, 2), Following(3000, 3)}, {Following(6000, 4)}};
  const FittedToOthersPredictionConfig wanted = WithOffset(true);
  const auto fitted = FitPredictorsToOthers(motions, kRateHz, wanted);
  ASSERT_EQ(fitted.size(), 3u);
  for (std::size_t i = 0; i < 3; ++i) {
    RecordedMotion others;
    for (std::size_t j = 0; j < 3; ++j) {
      if (j != i) others.insert(others.end(), motions[j].begin(), motions[j].end());
    }
    const FittedPredictionConfig expected = FitPredictor(others, kRateHz, wanted).predictor;
    for (std::size_t w = 0; w < expected.weights.size(); ++w) {
      EXPECT_NEAR(fitted[i].weights[w], expected.weights[w], 1e-6);
    }
    EXPECT_NEAR(fitted[i].offset_deg[1], expected.offset_deg[1], 1e-7);
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
                            const FittedToOthersPredictionConfig& options =
                                kOptions) -> std::string {
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
  FittedToOthersPredictionConfig far = kOptions;
  far.horizon_ms = {-1.0};
  EXPECT_EQ(complaint(Glove(4000, 1.0), far), "horizon_ms: is -1, must be from 0 to 1000");
  far.horizon_ms = {1001.0};
  EXPECT_EQ(complaint(Glove(4000, 1.0), far), "horizon_ms: is 1001, must be from 0 to 1000");
  FittedToOthersPredictionConfig bold = kOptions;
  bold.caution = 0.5;
  EXPECT_EQ(complaint(Glove(4000, 1.0), bold), "caution: is 0.5, must be at least 1");
  FittedToOthersPredictionConfig odd = kOptions;
  odd.tap_ms = 2.5;
  EXPECT_THAT(complaint(Glove(4000, 1.0), odd), testing::HasSubstr("tap_ms: is 2.5"));
  FittedToOthersPredictionConfig no_offset = WithOffset(true);
  no_offset.offset = false;
  EXPECT_EQ(complaint(Glove(4000, 1.0), no_offset),
            "all_channels: is true, which needs offset: true");
  EXPECT_EQ(complaint(Glove(400, 1.0), WithOffset(true)),
            "recording: has 100 samples with so much past and future around them, must have at "
            "least 240");
  const std::vector<Eigen::MatrixXd> different = {Glove(4000, 1.0), Eigen::MatrixXd::Zero(10, 3)};
  EXPECT_THROW(FitPredictor(different, kRateHz, kOptions), SettingError);
}

}  // namespace
}  // namespace gauntlet::controller
