#include "controller/filters/kalman_filter.h"

#include <gtest/gtest.h>

#include <Eigen/LU>

#include "tests/controller/test_signal.h"

namespace gauntlet::controller {
namespace {

constexpr int kChannels = 18;
using Real = long double;

/// The paper's equations as matrices, for one channel, in long double: nothing is shared with the
/// filter but the algebra of section 2.3.2.
template <int kStates>
class TextbookKalman {
 public:
  using Matrix = Eigen::Matrix<Real, kStates, kStates>;
  using Vector = Eigen::Matrix<Real, kStates, 1>;

  TextbookKalman(Real r, const Matrix& q) : r_(r), q_(q) {
    for (int i = 0; i < kStates; ++i) {
      Real factor = 1;
      for (int j = i; j < kStates; ++j) {
        a_(i, j) = factor;
        factor /= static_cast<Real>(j - i + 1);
      }
    }
  }

  void StartAt(Real position) { x_ = Vector::Unit(0) * position; }
  Real Step(Real z, Real acceleration = 0) {
    Vector b = Vector::Zero();
    b[0] = Real(0.5);
    b[1] = 1;
    const Vector prior = a_ * x_ + b * acceleration;
    const Matrix p_prior = a_ * p_ * a_.transpose() + q_;
    const Vector h = Vector::Unit(0);
    const Vector gain = p_prior * h / ((h.transpose() * p_prior * h)(0) + r_);
    x_ = prior + gain * (z - h.dot(prior));
    p_ = (Matrix::Identity() - gain * h.transpose()) * p_prior;
    return x_[0];
  }

 private:
  Real r_;
  Matrix q_;
  Matrix a_ = Matrix::Zero();
  Vector x_ = Vector::Zero();
  Matrix p_ = Matrix::Identity();
};

/// Largest difference from the textbook relative to the signal, over all channels and samples.
template <int kStates>
double LargestRelativeError(const KalmanConfig& config,
                            const Eigen::Matrix<Real, kStates, kStates>& q, int samples) {
  const TestSignal input = GloveCounts(samples, kChannels);
  const auto filter = MakeFilter(config, kChannels, 1000.0);
  std::vector<TextbookKalman<kStates>> textbook;
  for (const double r : config.noise.r) textbook.emplace_back(Real(r), q);
  Eigen::RowVectorXd output(kChannels);
  double worst = 0.0;
  for (int k = 0; k < samples; ++k) {
    filter->Step(RowOf(input, k), {output.data(), kChannels});
    for (int i = 0; i < kChannels; ++i) {
      Real expected = input(k, i);
      if (config.start == Start::kFirst && k == 0) {
        textbook[i].StartAt(expected);
      } else {
        expected = textbook[i].Step(expected);
      }
      worst = std::max<double>(worst, std::abs((output[i] - expected) / expected));
    }
  }
  return worst;
}

constexpr int kSamplesOfThePaper = 94096;

TEST(KalmanFilter, FollowsThePapersEquationsOverThePapersExperiment) {
  const Eigen::Matrix<Real, 2, 2> q = Eigen::Matrix<Real, 2, 2>::Identity();
  EXPECT_LE(LargestRelativeError<2>({}, q, kSamplesOfThePaper), 1e-12);
  EXPECT_LE(LargestRelativeError<2>({.start = Start::kZero}, q, kSamplesOfThePaper), 1e-12);
}

TEST(KalmanFilter, StaysExactWithALowGain) {
  const Eigen::Matrix<Real, 2, 2> q = Real(1e-4) * Eigen::Matrix<Real, 2, 2>::Identity();
  EXPECT_LE(LargestRelativeError<2>({.noise = {.q = {1e-4}}}, q, kSamplesOfThePaper), 1e-12);
}

TEST(KalmanFilter, TakesWhiteAccelerationInPhysicalUnits) {
  const Real t = Real(1) / 1000;
  Eigen::Matrix<Real, 2, 2> q;  // states per step: velocity times t
  q << t * t * t / 3, t * t * t / 2, t * t * t / 2, t * t * t;
  const KalmanConfig config{.noise = {.q = {1e6}, .process_noise = ProcessNoise::kWhite}};
  EXPECT_LE(LargestRelativeError<2>(config, Real(1e6) * q, 20000), 1e-12);
}

TEST(KalmanFilter, EstimatesAccelerationAsThirdState) {
  const Eigen::Matrix<Real, 3, 3> q = Real(1e-6) * Eigen::Matrix<Real, 3, 3>::Identity();
  EXPECT_LE(LargestRelativeError<3>({.noise = {.q = {1e-6}}, .states = 3}, q, 20000), 1e-12);
}

TEST(KalmanFilter, UsesTheAccelerationInput) {
  const KalmanConfig config{.noise = {.r = {10.0}, .q = {1e-6}}};
  const auto filter = MakeKalmanFilter(config, 1, 1000.0);
  TextbookKalman<2> textbook(10.0, Real(1e-6) * Eigen::Matrix<Real, 2, 2>::Identity());
  textbook.StartAt(0);
  double output = 0.0;
  for (int k = 0; k < 500; ++k) {
    const double z = 0.01 * k * k;
    const double u = 0.02;  // the second difference of z
    filter->StepWithAcceleration({&z, 1}, {&u, 1}, {&output, 1});
    if (k == 0) continue;
    EXPECT_NEAR(output, textbook.Step(z, u), 1e-9 * (1.0 + z));
  }
  // A parabola with known acceleration is followed without lag once the velocity is found.
  EXPECT_NEAR(output, 0.01 * 499 * 499, 0.5);
}

TEST(KalmanFilter, StartsAtTheFirstSampleOrAtZero) {
  const double z = 400.0;
  double output = 0.0;
  MakeFilter(KalmanConfig{.noise = {.r = {10.0}}}, 1, 1000.0)->Step({&z, 1}, {&output, 1});
  EXPECT_EQ(output, 400.0);
  // From zero with P = I: P_11^- = 1 + 1 + q = 3, K_1 = 3 / 13.
  MakeFilter(KalmanConfig{.start = Start::kZero, .noise = {.r = {10.0}}}, 1, 1000.0)
      ->Step({&z, 1}, {&output, 1});
  EXPECT_NEAR(output, 400.0 * 3.0 / 13.0, 1e-12);
}

/// With Q = I and the paper's R the gain on position settles between 0.43 and 0.63: the honest
/// reading of the paper's filter.
TEST(KalmanFilter, HasTheGainThatThePapersNumbersGive) {
  const auto filter = MakeKalmanFilter({}, kChannels, 1000.0);
  std::vector<double> input(kChannels, 0.0);
  std::vector<double> output(kChannels);
  for (int k = 0; k < 200; ++k) filter->Step(input, output);
  std::fill(input.begin(), input.end(), 1.0);
  filter->Step(input, output);
  EXPECT_NEAR(*std::min_element(output.begin(), output.end()), 0.43, 0.005);
  EXPECT_NEAR(*std::max_element(output.begin(), output.end()), 0.63, 0.005);
}

}  // namespace
}  // namespace gauntlet::controller
