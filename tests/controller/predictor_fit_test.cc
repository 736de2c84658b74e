#include "controller/calibration/predictor_fit.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/LU>
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

/// What the predictor of two channels makes of white noise of deviation 1 on each, by what it
/// answers to an impulse on either.
double NoiseGain(const PredictorFit& fit, int channel) {
  double squares = 0.0;
  for (int hit = 0; hit < 2; ++hit) {
    const auto predictor = MakePredictor(fit.predictor, 2, kRateHz);
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
Eigen::MatrixXd Following(int samples, std::uint64_t seed) {
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
    angles(k, 0) = free[k + 80] + 0.05 * noise.Normal();
    angles(k, 1) = 0.5 * free[k] + 0.05 * noise.Normal();
  }
  return angles;
}

PredictorFitOptions WithComponents(int components, double caution = 3.0) {
  PredictorFitOptions options = kOptions;
  options.components = components;
  options.caution = caution;
  return options;
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
    const PredictorFit fit = FitPredictor(
        {&line, 1}, 50.0, {.horizon_ms = {horizon_ms}, .order = 2, .tap_ms = 20.0, .caution = 1.0});
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

TEST(PredictorFit, IsAsCautiousWithComponentsAsWithSoMuchNoise) {
  const PredictorFit cautious = Fit(Glove(40000, 3.0), WithComponents(1, 4.0));
  const PredictorFit noisy = Fit(Glove(40000, 6.0), WithComponents(1, 1.0));
  for (int c = 0; c < 2; ++c) {
    EXPECT_NEAR(NoiseGain(cautious, c), NoiseGain(noisy, c), 0.1 * NoiseGain(noisy, c));
  }
}

TEST(PredictorFit, LearnsByComponentsFromAChannelThatIsAhead) {
  const Eigen::MatrixXd recording = Following(30000, 1);
  const Eigen::MatrixXd other = Following(20000, 2);
  const PredictorFit alone = Fit(recording);
  const PredictorFit together = Fit(recording, WithComponents(1));
  EXPECT_LT(LeftOf(together, other)[1], 0.5 * LeftOf(alone, other)[1]);
  EXPECT_LT(together.held_out_rms[1], 0.5 * alone.held_out_rms[1]);
  for (const PredictorFit& fit : {alone, together}) {
    const Eigen::Array2d left = LeftOf(fit, other);
    for (int c = 0; c < 2; ++c) EXPECT_NEAR(left[c], fit.held_out_rms[c], 0.2 * left[c]) << c;
  }
}

/// Of two channels the larger axis of an ellipse: tan 2 a = 2 c12 / (c11 - c22).
TEST(PredictorFit, TakesThePrincipalComponentOfChanges) {
  const Eigen::MatrixXd recording = Following(5000, 3);
  const std::vector<double> loadings = Fit(recording, WithComponents(1)).predictor.loadings;
  const Eigen::Index span = 200;  // order taps
  const Eigen::MatrixXd change = recording.bottomRows(5000 - span) - recording.topRows(5000 - span);
  const Eigen::Matrix2d c = change.transpose() * change;
  const double angle = 0.5 * std::atan2(2.0 * c(0, 1), c(0, 0) - c(1, 1));
  ASSERT_EQ(loadings.size(), 2u);
  EXPECT_NEAR(loadings[1] / loadings[0], std::tan(angle), 1e-9);
  EXPECT_NEAR(std::hypot(loadings[0], loadings[1]), 1.0, 1e-12);
}

/// The equation of the header with every regressor written out, solved another way.
TEST(PredictorFit, SolvesTheEquationOfItsHeaderWithComponents) {
  constexpr int kOrder = 3, kTap = 15, kAhead = 40;
  const Eigen::MatrixXd z = Following(3000, 4);
  const PredictorFit fit = Fit(
      z,
      {.horizon_ms = {kAhead}, .order = kOrder, .tap_ms = kTap, .caution = 2.5, .components = 1});
  const Eigen::RowVector2d loading(fit.predictor.loadings[0], fit.predictor.loadings[1]);
  const Eigen::VectorXd s = z * loading.transpose();
  constexpr int kFirst = kOrder * kTap;
  const int count = 3000 - kFirst - kAhead;
  for (int c = 0; c < 2; ++c) {
    Eigen::MatrixXd p(count, 2 * kOrder);
    Eigen::VectorXd t(count);
    for (int k = 0; k < count; ++k) {
      const int now = kFirst + k;
      t[k] = z(now + kAhead, c) - z(now, c);
      for (int i = 0; i < kOrder; ++i) {
        p(k, i) = z(now - (i + 1) * kTap, c) - z(now, c);
        p(k, kOrder + i) = s[now - (i + 1) * kTap] - s[now];
      }
    }
    // White noise n of each channel adds n(then) - n(now) to its own differences, and as much times
    // the loadings to those of the component.
    Eigen::MatrixXd added = Eigen::MatrixXd::Zero(2 * kOrder, 2 * kOrder);
    Eigen::VectorXd added_end = Eigen::VectorXd::Zero(2 * kOrder);
    for (int channel = 0; channel < 2; ++channel) {
      const double variance = 1.5 * fit.noise_variance[channel];
      Eigen::VectorXd now = Eigen::VectorXd::Zero(2 * kOrder);
      for (int i = 0; i < kOrder; ++i) {
        Eigen::VectorXd then = Eigen::VectorXd::Zero(2 * kOrder);
        if (channel == c) now[i] = then[i] = 1.0;
        now[kOrder + i] = then[kOrder + i] = loading[channel];
        added += variance * then * then.transpose();
      }
      added += variance * now * now.transpose();
      if (channel == c) added_end += variance * now;
    }
    const Eigen::VectorXd expected = (p.transpose() * p / count + added)
                                         .fullPivLu()
                                         .solve(p.transpose() * t / count + added_end);
    for (int i = 0; i < kOrder; ++i) {
      EXPECT_NEAR(fit.predictor.weights[kOrder * c + i], expected[i], 1e-7);
      EXPECT_NEAR(fit.predictor.component_weights[kOrder * c + i], expected[kOrder + i], 1e-7);
    }
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
  EXPECT_EQ(complaint(Glove(4000, 1.0), WithComponents(2)),
            "components: is 2, must be below the number of channels, 2");
  EXPECT_THAT(complaint(Glove(4000, 1.0), WithComponents(-1)), testing::HasSubstr("components"));
  EXPECT_EQ(complaint(Glove(600, 1.0), WithComponents(1)),
            "recording: has 300 samples with so much past and future around them, must have at "
            "least 400");
  const std::vector<Eigen::MatrixXd> different = {Glove(4000, 1.0), Eigen::MatrixXd::Zero(10, 3)};
  EXPECT_THROW(FitPredictor(different, kRateHz, kOptions), SettingError);
}

}  // namespace
}  // namespace gauntlet::controller
