#include "controller/calibration/predictor_fit.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <optional>
#include <string>

#include "controller/assert.h"
#include "controller/number.h"
#include "controller/prediction/horizon.h"

namespace gauntlet::controller {
namespace {

using Eigen::Index;

/// Where the samples of one fit lie.
struct Geometry {
  int order;
  Index tap;           // steps
  double horizon = 0;  // steps, not always whole

  Index first() const { return order * tap; }
  Index CountOf(const Eigen::MatrixXd& recording) const {
    return std::max<Index>(recording.rows() - first() - static_cast<Index>(std::ceil(horizon)), 0);
  }
  /// Of some rows from `begin` on what will be there after the horizon, linear between samples.
  Eigen::VectorXd Ahead(const Eigen::Ref<const Eigen::VectorXd>& signal, Index begin,
                        Index rows) const {
    GAUNTLET_ASSERT(0 <= begin &&
                    begin + static_cast<Index>(std::ceil(horizon)) + rows <= signal.size());
    const auto below = static_cast<Index>(std::floor(horizon));
    const auto above = static_cast<Index>(std::ceil(horizon));
    const double share = horizon - static_cast<double>(below);
    return (1.0 - share) * signal.segment(begin + below, rows) +
           share * signal.segment(begin + above, rows);
  }
};

/// What least squares need of one channel: sums over samples.
struct Moments {
  explicit Moments(Index weights)
      : of_past(Eigen::MatrixXd::Zero(weights, weights)),
        with_end(Eigen::VectorXd::Zero(weights)) {}

  Moments& operator+=(const Moments& other) {
    of_past += other.of_past;
    with_end += other.with_end;
    of_end += other.of_end;
    samples += other.samples;
    return *this;
  }
  /// Sum of the squares of t - w p.
  double Left(const Eigen::VectorXd& weights) const {
    const double left = of_end - 2.0 * weights.dot(with_end) +
                        weights.dot(of_past.selfadjointView<Eigen::Lower>() * weights);
    return std::max(left, 0.0);
  }

  Eigen::MatrixXd of_past;   // p p', its lower half
  Eigen::VectorXd with_end;  // p t
  double of_end = 0.0;       // t^2
  double samples = 0.0;
};

constexpr int kFolds = 5;

/// Of each fifth of the samples. `components`: samples x components, a matrix per recording.
std::vector<Moments> MomentsOf(std::span<const Eigen::MatrixXd> recordings,
                               std::span<const Eigen::MatrixXd> components, Index channel,
                               const Geometry& g) {
  GAUNTLET_ASSERT(components.size() == recordings.size());
  const Index signals = 1 + components.front().cols();
  std::vector<Moments> folds(kFolds, Moments(g.order * signals));
  Index all = 0;
  for (const Eigen::MatrixXd& recording : recordings) all += g.CountOf(recording);
  Index done = 0;
  for (std::size_t i = 0; i < recordings.size(); ++i) {
    const auto z = recordings[i].col(channel);
    const Index count = g.CountOf(recordings[i]);
    constexpr Index kBlock = 4096;  // rows, so that an hour's recording needs no gigabytes
    for (Index begin = 0; begin < count;) {
      const Index fold = done * kFolds / std::max<Index>(all, 1);
      const Index fold_end = ((fold + 1) * all + kFolds - 1) / kFolds;
      const Index rows = std::min({kBlock, count - begin, fold_end - done});
      const Index first = g.first() + begin;
      Eigen::MatrixXd past(rows, g.order * signals);
      for (Index signal = 0; signal < signals; ++signal) {
        const auto& of = signal == 0 ? recordings[i] : components[i];
        const auto s = of.col(signal == 0 ? channel : signal - 1);
        for (int tap = 0; tap < g.order; ++tap) {
          past.col(signal * g.order + tap) =
              s.segment(first - (tap + 1) * g.tap, rows) - s.segment(first, rows);
        }
      }
      const Eigen::VectorXd end = g.Ahead(z, first, rows) - z.segment(first, rows);
      Moments& moments = folds[static_cast<std::size_t>(fold)];
      moments.of_past.selfadjointView<Eigen::Lower>().rankUpdate(past.transpose());
      moments.with_end += past.transpose() * end;
      moments.of_end += end.squaredNorm();
      moments.samples += static_cast<double>(rows);
      begin += rows;
      done += rows;
    }
  }
  return folds;
}

/// A sixth of the mean square of the second differences, per channel.
Eigen::ArrayXd NoiseOf(std::span<const Eigen::MatrixXd> recordings) {
  Eigen::ArrayXd squares = Eigen::ArrayXd::Zero(recordings.front().cols());
  double differences = 0.0;
  for (const Eigen::MatrixXd& z : recordings) {
    const Index n = z.rows();
    if (n <= 2) continue;
    squares += (z.bottomRows(n - 2) - 2.0 * z.middleRows(1, n - 2) + z.topRows(n - 2))
                   .array()
                   .square()
                   .colwise()
                   .sum()
                   .transpose();
    differences += static_cast<double>(n - 2);
  }
  return squares / (6.0 * differences);
}

/// Components x channels.
Eigen::MatrixXd LoadingsOf(std::span<const Eigen::MatrixXd> recordings, int components,
                           Index span) {
  const Index channels = recordings.front().cols();
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(channels, channels);
  for (const Eigen::MatrixXd& z : recordings) {
    const Index count = std::max<Index>(z.rows() - span, 0);
    const Eigen::MatrixXd change = z.bottomRows(count) - z.topRows(count);
    covariance += change.transpose() * change;
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> principal(covariance);
  return principal.eigenvectors().rightCols(components).rowwise().reverse().transpose();
}

/// None where they are not determined. `noise`: covariance of the white noise that is to be added
/// to the signals that p is made of.
std::optional<Eigen::VectorXd> WeightsOf(const Moments& moments, const Eigen::MatrixXd& noise) {
  GAUNTLET_ASSERT(noise.rows() == noise.cols() && moments.with_end.size() % noise.rows() == 0);
  const Index signals = noise.rows();
  const Index order = moments.with_end.size() / signals;
  Eigen::MatrixXd matrix = moments.of_past / moments.samples;
  Eigen::VectorXd right = moments.with_end / moments.samples;
  for (Index i = 0; i < signals; ++i) {
    for (Index j = 0; j <= i; ++j) {
      auto block = matrix.block(i * order, j * order, order, order);
      block.diagonal().array() += noise(i, j);
      block.array() += noise(i, j);
    }
    right.segment(i * order, order).array() += noise(i, 0);
  }
  const Eigen::LLT<Eigen::MatrixXd> decomposition(matrix);
  if (decomposition.info() != Eigen::Success || !(decomposition.rcond() > 1e-13)) return {};
  return decomposition.solve(right);
}

/// Sum of the squares that each fold leaves, predicted by the others.
double HeldOut(std::span<const Moments> folds, const Eigen::MatrixXd& noise) {
  double left = 0.0;
  for (const Moments& fold : folds) {
    Moments others(fold.with_end.size());
    for (const Moments& other : folds) {
      if (&other != &fold) others += other;
    }
    const std::optional<Eigen::VectorXd> weights = WeightsOf(others, noise);
    left += weights ? fold.Left(*weights) : kNaN;
  }
  return left;
}

void CheckRecordings(std::span<const Eigen::MatrixXd> recordings) {
  if (recordings.empty() || recordings.front().cols() == 0) {
    throw SettingError("recording", "has no channels");
  }
  for (const Eigen::MatrixXd& recording : recordings) {
    if (recording.cols() != recordings.front().cols()) {
      throw SettingError("recording",
                         "has " + std::to_string(recording.cols()) + " channels, must have " +
                             std::to_string(recordings.front().cols()) + " as the first one");
    }
    if (!recording.allFinite()) throw SettingError("recording", "has values that are not finite");
  }
}

/// Refuses what no predictor could have.
void CheckOptions(const PredictorFitOptions& options, Index channels, double rate_hz) {
  if (!(options.caution >= 1.0) || !std::isfinite(options.caution)) {
    throw SettingError("caution", "is " + NumberText(options.caution) + ", must be at least 1");
  }
  const std::size_t order = std::max(options.order, 0);
  const std::size_t components = std::max(options.components, 0);
  const FittedPredictionConfig empty = {
      .order = options.order,
      .tap_ms = options.tap_ms,
      .weights = std::vector<double>(order),
      .components = options.components,
      .loadings = std::vector<double>(components * static_cast<std::size_t>(channels)),
      .component_weights = std::vector<double>(components * order)};
  MakePredictor(empty, static_cast<int>(channels), rate_hz);
  if (options.components >= channels) {
    throw SettingError("components", "is " + std::to_string(options.components) +
                                         ", must be below the number of channels, " +
                                         std::to_string(channels));
  }
}

/// A horizon that is said in ms is off by some digits.
double WholeIfNearly(double steps) {
  constexpr double kTolerance = 1e-3;
  return std::abs(steps - std::round(steps)) < kTolerance ? std::round(steps) : steps;
}

void CheckSamples(std::span<const Eigen::MatrixXd> recordings, const Geometry& geometry,
                  Index weights) {
  constexpr Index kLeastPerWeight = 10;
  Index samples = 0;
  for (const Eigen::MatrixXd& recording : recordings) samples += geometry.CountOf(recording);
  if (samples >= kLeastPerWeight * weights) return;
  throw SettingError("recording",
                     "has " + std::to_string(samples) +
                         " samples with so much past and future around them, must have at least " +
                         std::to_string(kLeastPerWeight * weights));
}

}  // namespace

PredictorFit FitPredictor(std::span<const Eigen::MatrixXd> recordings, double rate_hz,
                          const PredictorFitOptions& options) {
  CheckRecordings(recordings);
  const Index channels = recordings.front().cols();
  CheckOptions(options, channels, rate_hz);
  const Index tap = std::lround(options.tap_ms * 1e-3 * rate_hz);
  const Eigen::MatrixXd loadings = LoadingsOf(recordings, options.components, options.order * tap);
  std::vector<Eigen::MatrixXd> components;
  for (const Eigen::MatrixXd& z : recordings) components.push_back(z * loadings.transpose());
  PredictorFit fit{.predictor = {.order = options.order,
                                 .tap_ms = options.tap_ms,
                                 .weights = {},
                                 .components = options.components},
                   .noise_variance = NoiseOf(recordings),
                   .hold_rms = Eigen::ArrayXd(channels),
                   .fit_rms = Eigen::ArrayXd(channels),
                   .held_out_rms = Eigen::ArrayXd(channels)};
  for (const auto component : loadings.rowwise()) {
    fit.predictor.loadings.insert(fit.predictor.loadings.end(), component.begin(), component.end());
  }
  const Eigen::ArrayXd horizon_steps =
      HorizonSteps(options.horizon_ms, static_cast<int>(channels), rate_hz);
  for (Index channel = 0; channel < channels; ++channel) {
    const Geometry geometry = {
        .order = options.order, .tap = tap, .horizon = WholeIfNearly(horizon_steps[channel])};
    if (!(horizon_steps[channel] >= 0.0 && horizon_steps[channel] <= rate_hz)) {
      throw SettingError("horizon_ms", "is " + NumberText(horizon_steps[channel] * 1e3 / rate_hz) +
                                           ", must be from 0 to 1000");
    }
    const Index weight_count = options.order * (1 + loadings.rows());
    CheckSamples(recordings, geometry, weight_count);
    const std::vector<Moments> folds = MomentsOf(recordings, components, channel, geometry);
    Moments all(weight_count);
    for (const Moments& fold : folds) all += fold;
    // The noise that is added: of the channel and of the components, which it is a part of.
    Eigen::MatrixXd sums = Eigen::MatrixXd::Zero(1 + loadings.rows(), channels);
    sums(0, channel) = 1.0;
    sums.bottomRows(loadings.rows()) = loadings;
    const Eigen::MatrixXd noise = (options.caution - 1.0) * sums *
                                  fit.noise_variance.matrix().asDiagonal() * sums.transpose();
    const std::optional<Eigen::VectorXd> weights = WeightsOf(all, noise);
    if (!weights) {
      throw SettingError("recording", "channel " + std::to_string(channel + 1) +
                                          " moves too little, or has no noise: its weights are not "
                                          "determined");
    }
    auto& own = fit.predictor.weights;
    auto& shared = fit.predictor.component_weights;
    own.insert(own.end(), weights->begin(), weights->begin() + options.order);
    shared.insert(shared.end(), weights->begin() + options.order, weights->end());
    fit.hold_rms[channel] = std::sqrt(all.of_end / all.samples);
    fit.fit_rms[channel] = std::sqrt(all.Left(*weights) / all.samples);
    fit.held_out_rms[channel] = std::sqrt(HeldOut(folds, noise) / all.samples);
  }
  return fit;
}

}  // namespace gauntlet::controller
