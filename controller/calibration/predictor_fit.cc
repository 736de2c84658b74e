#include "controller/calibration/predictor_fit.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <string>

#include "controller/prediction/horizon.h"

namespace gauntlet::controller {
namespace {

using Eigen::Index;

/// Where the samples of one fit lie.
struct Geometry {
  int order;
  Index tap;      // steps
  Index horizon;  // steps

  Index first() const { return order * tap; }
  Index CountOf(const Eigen::MatrixXd& recording) const {
    return std::max<Index>(recording.rows() - first() - horizon, 0);
  }
};

/// What least squares need of one channel, over all recordings.
struct Moments {
  Eigen::MatrixXd of_past;   // mean of p p'
  Eigen::VectorXd with_end;  // mean of p t
  double of_end = 0.0;       // mean of t^2
  double noise = 0.0;        // r
};

Moments MomentsOf(std::span<const Eigen::MatrixXd> recordings, Index channel, const Geometry& g) {
  Moments moments{Eigen::MatrixXd::Zero(g.order, g.order), Eigen::VectorXd::Zero(g.order)};
  double samples = 0.0;
  double differences = 0.0;
  for (const Eigen::MatrixXd& recording : recordings) {
    const auto z = recording.col(channel).array();
    const Index n = z.size();
    const Index count = g.CountOf(recording);
    if (n > 2) {
      moments.noise += (z.tail(n - 2) - 2.0 * z.segment(1, n - 2) + z.head(n - 2)).square().sum();
      differences += static_cast<double>(n - 2);
    }
    constexpr Index kBlock = 4096;  // rows, so that an hour's recording needs no gigabytes
    for (Index begin = 0; begin < count; begin += kBlock) {
      const Index rows = std::min(kBlock, count - begin);
      const Index first = g.first() + begin;
      const auto now = z.segment(first, rows);
      Eigen::MatrixXd past(rows, g.order);
      for (int i = 0; i < g.order; ++i) {
        past.col(i) = z.segment(first - (i + 1) * g.tap, rows) - now;
      }
      const Eigen::VectorXd end = z.segment(first + g.horizon, rows) - now;
      moments.of_past += past.transpose() * past;
      moments.with_end += past.transpose() * end;
      moments.of_end += end.squaredNorm();
    }
    samples += static_cast<double>(count);
  }
  moments.of_past /= samples;
  moments.with_end /= samples;
  moments.of_end /= samples;
  moments.noise /= 6.0 * differences;
  return moments;
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

}  // namespace

PredictorFit FitPredictor(std::span<const Eigen::MatrixXd> recordings, double rate_hz,
                          const PredictorFitOptions& options) {
  CheckRecordings(recordings);
  const Index channels = recordings.front().cols();
  if (!(options.caution >= 1.0) || !std::isfinite(options.caution)) {
    throw SettingError("caution", "is " + NumberText(options.caution) + ", must be at least 1");
  }
  PredictorFit fit{.predictor = {.order = options.order, .tap_ms = options.tap_ms, .weights = {}},
                   .noise_variance = Eigen::ArrayXd(channels),
                   .hold_rms = Eigen::ArrayXd(channels),
                   .fit_rms = Eigen::ArrayXd(channels)};
  FittedPredictionConfig empty = fit.predictor;  // refuses what no predictor could have
  empty.weights.assign(static_cast<std::size_t>(std::max(options.order, 0)), 0.0);
  MakePredictor(empty, static_cast<int>(channels), rate_hz);
  const Eigen::ArrayXd horizon_steps =
      HorizonSteps(options.horizon_ms, static_cast<int>(channels), rate_hz);
  for (Index channel = 0; channel < channels; ++channel) {
    const Geometry geometry = {.order = options.order,
                               .tap = std::lround(options.tap_ms * 1e-3 * rate_hz),
                               .horizon = std::lround(horizon_steps[channel])};
    if (!(horizon_steps[channel] >= 0.0 && horizon_steps[channel] <= rate_hz)) {
      throw SettingError("horizon_ms", "is " + NumberText(horizon_steps[channel] * 1e3 / rate_hz) +
                                           ", must be from 0 to 1000");
    }
    Index samples = 0;
    for (const Eigen::MatrixXd& recording : recordings) samples += geometry.CountOf(recording);
    constexpr Index kLeastPerWeight = 10;
    if (samples < kLeastPerWeight * options.order) {
      throw SettingError("recording",
                         "has " + std::to_string(samples) +
                             " samples with so much past and future around them, must have at "
                             "least " +
                             std::to_string(kLeastPerWeight * options.order));
    }
    const Moments moments = MomentsOf(recordings, channel, geometry);
    const double added = (options.caution - 1.0) * moments.noise;
    Eigen::MatrixXd matrix = moments.of_past;
    matrix.diagonal().array() += added;
    matrix.array() += added;
    const Eigen::LLT<Eigen::MatrixXd> decomposition(matrix);
    if (decomposition.info() != Eigen::Success || !(decomposition.rcond() > 1e-13)) {
      throw SettingError("recording", "channel " + std::to_string(channel + 1) +
                                          " moves too little, or has no noise: its weights are not "
                                          "determined");
    }
    const Eigen::VectorXd weights =
        decomposition.solve((moments.with_end.array() + added).matrix());
    const double left = moments.of_end - 2.0 * weights.dot(moments.with_end) +
                        weights.dot(moments.of_past * weights);
    fit.predictor.weights.insert(fit.predictor.weights.end(), weights.begin(), weights.end());
    fit.noise_variance[channel] = moments.noise;
    fit.hold_rms[channel] = std::sqrt(moments.of_end);
    fit.fit_rms[channel] = std::sqrt(std::max(left, 0.0));
  }
  return fit;
}

}  // namespace gauntlet::controller
