// Every kind of filter against its own definition in long double, over as many samples as the
// paper's experiment has: 1e-12 of the sample, at every sample.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <functional>
#include <numbers>
#include <vector>

#include "controller/filters/filter_registry.h"
#include "tests/controller/test_signal.h"
#include "tests/controller/textbook_kalman.h"
#include "tests/support/gram_schmidt.h"

namespace gauntlet::controller {
namespace {

constexpr double kRateHz = 1000.0;
constexpr int kSamplesOfThePaper = 94096;
constexpr Real kPi = std::numbers::pi_v<Real>;

/// What a filter of one channel ought to answer to the next sample.
using Reference = std::function<Real(double)>;

/// Largest difference from the reference, relative to the reference.
double WorstError(const FilterConfig& config, const Reference& reference) {
  const auto filter = MakeFilter(config, 1, kRateHz);
  const TestSignal input = GloveCounts(kSamplesOfThePaper, 1);
  double worst = 0.0;
  for (int k = 0; k < kSamplesOfThePaper; ++k) {
    double output = 0.0;
    filter->Step(RowOf(input, k), {&output, 1});
    const Real expected = reference(input(k, 0));
    worst = std::max(worst, static_cast<double>(std::abs((output - expected) / expected)));
  }
  return worst;
}

/// The last samples, the newest first.
class Window {
 public:
  explicit Window(std::size_t length) : length_(length) {}
  const std::deque<double>& Push(double sample) {
    samples_.push_front(sample);
    if (samples_.size() > length_) samples_.pop_back();
    return samples_;
  }
  bool full() const { return samples_.size() == length_; }

 private:
  std::size_t length_;
  std::deque<double> samples_;
};

Real MedianOf(std::vector<Real> values) {
  std::sort(values.begin(), values.end());
  const std::size_t n = values.size();
  return (values[(n - 1) / 2] + values[n / 2]) / 2;
}

TEST(Exactness, None) {
  EXPECT_EQ(WorstError({NoFilterConfig{}}, [](double z) { return z; }), 0.0);
}

TEST(Exactness, MovingAverage) {
  Window window(20);
  EXPECT_LE(WorstError({MovingAverageConfig{.window = 20}},
                       [&](double z) {
                         Real sum = 0;
                         const auto& samples = window.Push(z);
                         for (const double sample : samples) sum += sample;
                         return sum / static_cast<Real>(samples.size());
                       }),
            1e-12);
}

TEST(Exactness, Median) {
  Window window(21);
  EXPECT_EQ(WorstError({MedianConfig{.window = 21}},
                       [&](double z) {
                         const auto& samples = window.Push(z);
                         return MedianOf({samples.begin(), samples.end()});
                       }),
            0.0);
}

TEST(Exactness, Hampel) {
  Window window(11);
  const HampelConfig config{.window = 11, .threshold_sigma = 1.5};
  EXPECT_EQ(WorstError({config},
                       [&](double z) -> Real {
                         const auto& samples = window.Push(z);
                         const Real median = MedianOf({samples.begin(), samples.end()});
                         std::vector<Real> distances;
                         for (const double s : samples) distances.push_back(std::abs(s - median));
                         const Real deviation = MedianOf(distances);
                         const Real limit = deviation > 0 ? Real(1.5) * Real(1.4826) * deviation
                                                          : Real(1);  // counts are whole
                         return std::abs(z - median) > limit ? median : z;
                       }),
            0.0);
}

TEST(Exactness, Exponential) {
  bool started = false;
  Real y = 0;
  EXPECT_LE(WorstError({ExponentialConfig{.alpha = 0.01}},
                       [&](double z) {
                         y = started ? y + Real(0.01) * (z - y) : z;
                         started = true;
                         return y;
                       }),
            1e-12);
}

/// A second-order section (or one of first order, with b2 = a2 = 0) in direct form.
struct Section {
  Real b0, b1, b2, a1, a2;
  Real s1 = 0, s2 = 0;
  Real operator()(Real x) {
    const Real y = b0 * x + s1;
    s1 = b1 * x - a1 * y + s2;
    s2 = b2 * x - a2 * y;
    return y;
  }
};

/// 1 / (s^2 + 2 cos(angle) s + 1) per pair of poles, 1 / (s + 1) for the real one, by the bilinear
/// transform s = (1 - 1/z) / (1 + 1/z) / tan(pi f / rate).
std::vector<Section> ButterworthSections(int order, Real cutoff_hz) {
  const Real k = std::tan(kPi * cutoff_hz / static_cast<Real>(kRateHz));
  std::vector<Section> sections;
  for (int pair = 0; pair < order / 2; ++pair) {
    const Real angle = kPi * (order % 2 == 0 ? 2 * pair + 1 : 2 * pair + 2) / (2 * order);
    const Real damping = 2 * std::cos(angle) * k;
    const Real norm = 1 + damping + k * k;
    sections.push_back({.b0 = k * k / norm,
                        .b1 = 2 * k * k / norm,
                        .b2 = k * k / norm,
                        .a1 = 2 * (k * k - 1) / norm,
                        .a2 = (1 - damping + k * k) / norm});
  }
  if (order % 2 == 1) {
    sections.push_back(
        {.b0 = k / (1 + k), .b1 = k / (1 + k), .b2 = 0, .a1 = (k - 1) / (1 + k), .a2 = 0});
  }
  return sections;
}

TEST(Exactness, ButterworthOfEveryOrderAndStart) {
  for (int order = 1; order <= 8; ++order) {
    for (const Start start : {Start::kFirst, Start::kZero}) {
      std::vector<Section> sections = ButterworthSections(order, 5);
      bool started = false;
      Real first = 0;  // at rest there, since the gain at rest is 1
      const ButterworthConfig config{.order = order, .cutoff_hz = 5.0, .start = start};
      EXPECT_LE(WorstError({config},
                           [&](double z) {
                             if (!started && start == Start::kFirst) first = z;
                             started = true;
                             Real value = z - first;
                             for (Section& section : sections) value = section(value);
                             return first + value;
                           }),
                1e-12)
          << "order " << order << (start == Start::kZero ? " from zero" : "");
    }
  }
}

/// Weights, the newest first, with which the polynomial through `window` samples has this
/// derivative at the newest.
std::vector<Real> FitWeights(int window, int order, int derivative) {
  using Matrix = Eigen::Matrix<Real, Eigen::Dynamic, Eigen::Dynamic>;
  Matrix powers(window, order + 1);
  for (int age = 0; age < window; ++age) {
    for (int i = 0; i <= order; ++i) powers(age, i) = std::pow(Real(-age), Real(i));
  }
  const Matrix inverse =
      test::SolveByGramSchmidt<Matrix>(powers, Matrix::Identity(window, window)).value();
  std::vector<Real> weights;
  for (int age = 0; age < window; ++age) {
    weights.push_back(std::tgamma(Real(derivative + 1)) * inverse(derivative, age));
  }
  return weights;
}

Real WeightedSumOf(const std::deque<double>& samples, const std::vector<Real>& weights) {
  Real sum = 0;
  for (std::size_t i = 0; i < weights.size(); ++i) sum += weights[i] * samples[i];
  return sum;
}

TEST(Exactness, SavitzkyGolay) {
  for (const auto& [length, order] : {std::pair{41, 1}, std::pair{40, 3}}) {
    Window window(static_cast<std::size_t>(length));
    const std::vector<Real> weights = FitWeights(length, order, 0);
    EXPECT_LE(WorstError({SavitzkyGolayConfig{.window = length, .order = order}},
                         [&](double z) -> Real {
                           const auto& samples = window.Push(z);
                           return window.full() ? WeightedSumOf(samples, weights) : z;
                         }),
              1e-12)
        << order;
  }
}

TEST(Exactness, AlphaBetaAndAlphaBetaGamma) {
  for (const bool with_acceleration : {false, true}) {
    const AlphaBetaConfig two;
    const AlphaBetaGammaConfig three;
    const Real alpha = with_acceleration ? three.alpha : two.alpha;
    const Real beta = with_acceleration ? three.beta : two.beta;
    const Real gamma = with_acceleration ? three.gamma : 0;
    bool started = false;
    Real x = 0, v = 0, a = 0;
    const FilterConfig config = with_acceleration ? FilterConfig{three} : FilterConfig{two};
    EXPECT_LE(WorstError(config,
                         [&](double z) {
                           if (!started) {
                             started = true;
                             return x = z;
                           }
                           const Real prior = x + v + a / 2;
                           const Real e = z - prior;
                           x = prior + alpha * e;
                           v = v + a + beta * e;
                           a = a + 2 * gamma * e;
                           return x;
                         }),
              1e-12);
  }
}

/// A textbook filter of one channel that starts at the first sample.
Reference StartingAtTheFirst(TextbookKalman textbook) {
  return [textbook, started = false](double z) mutable -> Real {
    if (started) return textbook.Step(Real(z));
    started = true;
    return textbook.x[0] = z;
  };
}

RealMatrix One(Real value) { return RealMatrix::Constant(1, 1, value); }
RealMatrix IdentityTimes(double factor, int size) {
  return Real(factor) * RealMatrix::Identity(size, size);
}

TEST(Exactness, KalmanInEveryForm) {
  const auto error = [](const KalmanConfig& config, const RealMatrix& q) {
    return WorstError({config}, StartingAtTheFirst(MakeTextbookKalman(1, config.states, q,
                                                                      One(config.noise.r[0]))));
  };
  EXPECT_LE(error({.noise = {.r = {9.86}}}, IdentityTimes(1, 2)), 1e-12);
  EXPECT_LE(error({.noise = {.r = {9.86}, .q = {1e-8}}}, IdentityTimes(1e-8, 2)), 1e-12);
  EXPECT_LE(error({.noise = {.r = {9.86}, .q = {1e-6}}, .states = 3}, IdentityTimes(1e-6, 3)),
            1e-12);

  const Real t = Real(1) / 1000;  // velocity is per step, so times t
  RealMatrix white(2, 2);
  white << t * t * t / 3, t * t * t / 2, t * t * t / 2, t * t * t;
  EXPECT_LE(error({.noise = {.r = {9.86}, .q = {1e6}, .process_noise = ProcessNoise::kWhite}},
                  Real(1e6) * white),
            1e-12);
  RealMatrix jerk(3, 3);
  jerk << Real(1) / 20, Real(1) / 8, Real(1) / 6, Real(1) / 8, Real(1) / 3, Real(1) / 2,
      Real(1) / 6, Real(1) / 2, 1;
  EXPECT_LE(error({.noise = {.r = {9.86}, .q = {1e9}, .process_noise = ProcessNoise::kWhite},
                   .states = 3},
                  Real(1e9) * t * t * t * t * t * jerk),
            1e-12);
}

TEST(Exactness, KalmanWithItsAccelerationInput) {
  constexpr int kWindow = 41;
  const KalmanConfig config{.noise = {.r = {9.86}, .q = {1e-4}}, .acceleration_window = kWindow};
  TextbookKalman textbook = MakeTextbookKalman(1, 2, IdentityTimes(1e-4, 2), One(9.86));
  const std::vector<Real> weights = FitWeights(kWindow, 2, 2);
  Window window(kWindow);
  RealVector b(2);
  b << Real(0.5), 1;
  bool started = false;
  EXPECT_LE(WorstError({config},
                       [&](double z) -> Real {
                         const auto& samples = window.Push(z);
                         if (!started) {
                           started = true;
                           return textbook.x[0] = z;
                         }
                         const Real u = window.full() ? WeightedSumOf(samples, weights) : Real(0);
                         return textbook.Step(RealVector::Constant(1, z), b * u)[0];
                       }),
            1e-12);
}

TEST(Exactness, KalmanSteady) {
  TextbookKalman textbook = MakeTextbookKalman(1, 2, IdentityTimes(1e-4, 2), One(9.86));
  for (int k = 0; k < 20000; ++k) textbook.Step(Real(0));
  const RealMatrix gain = textbook.gain;
  RealVector x = RealVector::Zero(2);
  bool started = false;
  EXPECT_LE(WorstError({KalmanSteadyConfig{.noise = {.r = {9.86}, .q = {1e-4}}}},
                       [&](double z) {
                         if (!started) {
                           started = true;
                           return x[0] = z;
                         }
                         const RealVector prior = textbook.a * x;
                         x = prior + gain * (z - prior[0]);
                         return x[0];
                       }),
            1e-12);
}

TEST(Exactness, KalmanAdaptive) {
  const Real memory = 1000;
  const Real r_start = 9.86;
  const Real q_start = 0.01;
  const Real range = 1e6;
  TextbookKalman textbook =
      MakeTextbookKalman(1, 2, q_start * RealMatrix::Identity(2, 2), One(r_start));
  Real c0 = r_start, c1 = 0, before = 0, r = r_start, q = q_start;
  bool started = false;
  const auto learn = [&](Real innovation, Real s) {
    const Real ratio = 25 * s / (innovation * innovation);  // beyond 5 sigma an outlier
    const Real e = std::min<Real>(ratio, 1) * innovation;
    c0 = std::max(c0 + (e * e - c0) / memory, r_start / range);
    c1 += (e * before - c1) / memory;
    before = e;
    const Real size = 1 + (std::min<Real>(c0 / s, 2) - 1) / memory;
    r = std::clamp(r * size, r_start / range, r_start * range);
    q = std::clamp(q * size * (1 + 4 * c1 / c0 / memory), q_start / range, q_start * range);
    textbook.r = One(r);
    textbook.q = q * RealMatrix::Identity(2, 2);
  };
  EXPECT_LE(WorstError({KalmanAdaptiveConfig{.noise = {.r = {9.86}, .q = {0.01}}}},
                       [&](double z) -> Real {
                         if (!started) {
                           started = true;
                           return textbook.x[0] = z;
                         }
                         const Real output = textbook.Step(Real(z));
                         learn(z - textbook.x_prior[0], textbook.p_prior(0, 0) + r);
                         return output;
                       }),
            1e-12);
  EXPECT_GT(std::abs(std::log(q / q_start)), 0.1);  // it has learned
}

TEST(Exactness, KalmanDenseWithCoupledNoise) {
  const std::vector<double> r = {9.0, 4.0, 4.0, 16.0};
  RealMatrix r_matrix(2, 2);
  r_matrix << 9, 4, 4, 16;
  TextbookKalman textbook = MakeTextbookKalman(2, 2, IdentityTimes(1e-4, 4), r_matrix);
  const KalmanDenseConfig config{.start = Start::kZero, .r = r, .q = {1e-4}};
  const auto filter = MakeFilter(config, 2, kRateHz);
  const TestSignal input = GloveCounts(kSamplesOfThePaper, 2);
  std::vector<double> output(2);
  double worst = 0.0;
  for (int k = 0; k < kSamplesOfThePaper; ++k) {
    filter->Step(RowOf(input, k), output);
    const RealVector expected = textbook.Step(input.row(k).transpose().cast<Real>());
    for (int i = 0; i < 2; ++i) {
      worst =
          std::max(worst, static_cast<double>(std::abs((output[i] - expected[i]) / expected[i])));
    }
  }
  EXPECT_LE(worst, 1e-12);
}

/// Rauch-Tung-Striebel: filters up to now, then goes back `lag` samples.
TEST(Exactness, FixedLag) {
  constexpr std::size_t kLag = 6;
  TextbookKalman textbook = MakeTextbookKalman(1, 2, IdentityTimes(1e-4, 2), One(9.86));
  std::deque<TextbookKalman> passed;
  const FixedLagConfig config{
      .start = Start::kZero, .noise = {.r = {9.86}, .q = {1e-4}}, .lag = kLag};
  EXPECT_LE(WorstError({config},
                       [&](double z) -> Real {
                         textbook.Step(Real(z));
                         passed.push_back(textbook);
                         if (passed.size() > kLag + 1) passed.pop_front();
                         RealVector smoothed = passed.back().x;
                         for (std::size_t i = passed.size() - 1; i-- > 0;) {
                           smoothed = passed[i].Smoothed(passed[i + 1], smoothed);
                         }
                         return smoothed[0];
                       }),
            1e-12);
}

}  // namespace
}  // namespace gauntlet::controller
