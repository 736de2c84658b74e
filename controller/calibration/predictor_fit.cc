#include "controller/calibration/predictor_fit.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <optional>
#include <string>

#include "controller/angle.h"
#include "controller/number.h"
#include "controller/prediction/horizon.h"
#include "controller/prediction/predictor.h"

namespace gauntlet::controller {
namespace {

using Eigen::Index;

/// One of the numbers that a prediction is a weighted sum of: a sum of samples and means of one
/// channel, or 1.
struct Regressor {
  enum class Kind { kTap, kPosition, kSlope, kOffset };
  struct Term {
    int tap;  // 0: the newest sample; i: the mean m_i
    double factor;
  };
  Kind kind;
  Index channel;
  std::vector<Term> terms;  // none: 1
};

/// Places of the samples of one fit, and its regressors.
struct Geometry {
  Index channel;
  int order;
  Index tap;           // steps
  double horizon = 0;  // steps, not always whole
  std::vector<Regressor> regressors;

  Index first() const { return order * tap; }
  /// One sample in each tap: what lies between is in the means.
  Index CountOf(const Eigen::MatrixXd& recording) const {
    const Index samples = recording.rows() - first() - static_cast<Index>(std::ceil(horizon));
    return std::max<Index>((samples + tap - 1) / tap, 0);
  }
  Index weights() const { return std::ssize(regressors); }
};

/// Other channels are looked at where they move, those with noise.
std::vector<Regressor> RegressorsOf(const FittedToOthersPredictionConfig& wanted, Index channel,
                                    const Eigen::ArrayXd& noise_variance) {
  std::vector<Regressor> regressors;
  for (int i = 1; i <= wanted.order; ++i) {
    regressors.push_back({Regressor::Kind::kTap, channel, {{i, 1.0}, {0, -1.0}}});
  }
  if (!wanted.offset) return regressors;
  const int slope_tap = std::min(wanted.order, FittedPredictionConfig::kSlopeTaps);
  for (Index other = 0; other < noise_variance.size(); ++other) {
    const bool is_own = other == channel;
    if (!is_own && !(wanted.all_channels && noise_variance[other] > 0.0)) continue;
    regressors.push_back({Regressor::Kind::kPosition, other, {{1, 1.0}}});
    if (is_own || slope_tap == 1) continue;  // its own taps say how it moves
    regressors.push_back({Regressor::Kind::kSlope, other, {{1, 1.0}, {slope_tap, -1.0}}});
  }
  regressors.push_back({Regressor::Kind::kOffset, channel, {}});
  return regressors;
}

/// The mean of `tap` samples from each row on.
Eigen::MatrixXd MeansOf(const Eigen::MatrixXd& recording, Index tap) {
  Eigen::MatrixXd means =
      Eigen::MatrixXd::Zero(std::max<Index>(recording.rows() - tap + 1, 0), recording.cols());
  for (Index i = 0; i < tap && means.rows() > 0; ++i) {
    means += recording.middleRows(i, means.rows());
  }
  return means / static_cast<double>(tap);
}

/// Moments of one channel for least squares: sums over samples.
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

/// A recording, and the means of its taps.
struct Averaged {
  Averaged(const Eigen::MatrixXd& recording, Index tap)
      : samples(recording), means(MeansOf(recording, tap)) {}

  const Eigen::MatrixXd& samples;
  Eigen::MatrixXd means;
};

/// Moments of `count` samples of a recording, from number `begin` on.
Moments MomentsOf(const Averaged& recording, const Geometry& g, Index begin, Index count) {
  constexpr Index kBlock = 1024;  // rows, so that an hour's recording needs no gigabytes
  const auto rows_at = [&](const auto& column, Index first, Index rows) {
    return column(Eigen::seqN(first, rows, g.tap));
  };
  Moments moments(g.weights());
  const auto z = recording.samples.col(g.channel);
  const auto below = static_cast<Index>(std::floor(g.horizon));
  const auto above = static_cast<Index>(std::ceil(g.horizon));
  const double share = g.horizon - static_cast<double>(below);
  for (Index done = 0; done < count; done += kBlock) {
    const Index rows = std::min(kBlock, count - done);
    const Index first = g.first() + (begin + done) * g.tap;
    Eigen::MatrixXd past(rows, g.weights());
    for (Index i = 0; i < g.weights(); ++i) {
      const Regressor& regressor = g.regressors[static_cast<std::size_t>(i)];
      past.col(i).setConstant(regressor.terms.empty() ? 1.0 : 0.0);
      for (const auto& [tap, factor] : regressor.terms) {
        const auto& of = tap == 0 ? recording.samples : recording.means;
        past.col(i) += factor * rows_at(of.col(regressor.channel), first - tap * g.tap, rows);
      }
    }
    const Eigen::VectorXd end = (1.0 - share) * rows_at(z, first + below, rows) +
                                share * rows_at(z, first + above, rows) - rows_at(z, first, rows);
    moments.of_past.selfadjointView<Eigen::Lower>().rankUpdate(past.transpose());
    moments.with_end += past.transpose() * end;
    moments.of_end += end.squaredNorm();
    moments.samples += static_cast<double>(rows);
  }
  return moments;
}

constexpr int kFolds = 5;

/// Moments of each fifth of the samples.
std::vector<Moments> MomentsOfFifths(std::span<const Averaged> recordings, const Geometry& g) {
  std::vector<Moments> folds(kFolds, Moments(g.weights()));
  Index all = 0;
  for (const Averaged& recording : recordings) all += g.CountOf(recording.samples);
  Index done = 0;
  for (const Averaged& recording : recordings) {
    const Index count = g.CountOf(recording.samples);
    for (Index begin = 0; begin < count;) {
      const Index fold = done * kFolds / std::max<Index>(all, 1);
      const Index fold_end = ((fold + 1) * all + kFolds - 1) / kFolds;
      const Index rows = std::min(count - begin, fold_end - done);
      folds[static_cast<std::size_t>(fold)] += MomentsOf(recording, g, begin, rows);
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

/// Effect of white noise on the means of p p' and p t, as if there were `caution` times as much.
struct AddedNoise {
  AddedNoise(const Geometry& g, const Eigen::ArrayXd& variance, double caution)
      : of_past(Eigen::MatrixXd::Zero(g.weights(), g.weights())),
        with_end(Eigen::VectorXd::Zero(g.weights())) {
    const auto add = [&](const Regressor& a, const Regressor& b) {
      double sum = 0.0;
      for (const auto& x : a.terms) {
        for (const auto& y : b.terms) {
          if (a.channel != b.channel || x.tap != y.tap) continue;
          const double averaged = x.tap == 0 ? 1.0 : static_cast<double>(g.tap);
          sum += (caution - 1.0) * variance[a.channel] * x.factor * y.factor / averaged;
        }
      }
      return sum;
    };
    const Regressor end = {Regressor::Kind::kTap, g.channel, {{0, -1.0}}};
    for (Index i = 0; i < g.weights(); ++i) {
      const Regressor& regressor = g.regressors[static_cast<std::size_t>(i)];
      for (Index j = 0; j <= i; ++j) {
        of_past(i, j) = add(regressor, g.regressors[static_cast<std::size_t>(j)]);
      }
      with_end[i] = add(regressor, end);
    }
  }

  Eigen::MatrixXd of_past;  // its lower half
  Eigen::VectorXd with_end;
};

/// None where they are not determined.
std::optional<Eigen::VectorXd> WeightsOf(const Moments& moments, const AddedNoise& noise) {
  Eigen::MatrixXd matrix = moments.of_past / moments.samples + noise.of_past;
  const Eigen::VectorXd right = moments.with_end / moments.samples + noise.with_end;
  const Eigen::VectorXd scale = matrix.diagonal().cwiseSqrt().cwiseInverse();
  if (!scale.allFinite()) return {};
  matrix = scale.asDiagonal() * matrix * scale.asDiagonal();
  const Eigen::LLT<Eigen::MatrixXd> decomposition(matrix);
  if (decomposition.info() != Eigen::Success || !(decomposition.rcond() > 1e-13)) return {};
  return scale.cwiseProduct(decomposition.solve(scale.cwiseProduct(right)));
}

/// Sum of the squares that each fold leaves, predicted by the others.
double HeldOut(std::span<const Moments> folds, const AddedNoise& noise) {
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
void CheckWanted(const FittedToOthersPredictionConfig& wanted, Index channels, double rate_hz) {
  if (!(wanted.caution >= 1.0) || !std::isfinite(wanted.caution)) {
    throw SettingError("caution", "is " + NumberText(wanted.caution) + ", must be at least 1");
  }
  if (wanted.all_channels && !wanted.offset) {
    throw SettingError("all_channels", "is true, which needs offset: true");
  }
  const FittedPredictionConfig empty = {
      .horizon_ms = wanted.horizon_ms,
      .order = wanted.order,
      .tap_ms = wanted.tap_ms,
      .weights = std::vector<double>(static_cast<std::size_t>(std::max(wanted.order, 0)))};
  MakePredictor(empty, static_cast<int>(channels), rate_hz);
}

/// A horizon in ms has a rounding error.
double WholeIfNearly(double steps) {
  constexpr double kTolerance = 1e-3;
  return std::abs(steps - std::round(steps)) < kTolerance ? std::round(steps) : steps;
}

/// Linear between samples.
double At(const Eigen::Ref<const Eigen::VectorXd>& signal, double sample) {
  const auto below = static_cast<Index>(std::floor(sample));
  const double share = sample - static_cast<double>(below);
  return share == 0.0 ? signal[below] : (1.0 - share) * signal[below] + share * signal[below + 1];
}

/// `fitted`: one in each tap.
void CheckSamples(double fitted, const Geometry& geometry) {
  constexpr Index kLeastPerWeight = 10;
  const Index samples = static_cast<Index>(fitted) * geometry.tap;
  if (samples >= kLeastPerWeight * geometry.weights()) return;
  throw SettingError("recording",
                     "has " + std::to_string(samples) +
                         " samples with so much past and future around them, must have at least " +
                         std::to_string(kLeastPerWeight * geometry.weights()));
}

/// Fits of all recordings, channel by channel.
class Fits {
 public:
  Fits(std::span<const Eigen::MatrixXd> recordings, double rate_hz,
       const FittedToOthersPredictionConfig& wanted)
      : wanted_(wanted) {
    CheckRecordings(recordings);
    const Index channels = recordings.front().cols();
    CheckWanted(wanted, channels, rate_hz);
    tap_ = std::lround(wanted.tap_ms * 1e-3 * rate_hz);
    horizon_steps_ = HorizonSteps(wanted.horizon_ms, static_cast<int>(channels), rate_hz);
    for (const double steps : horizon_steps_) {
      if (steps >= 0.0 && steps <= rate_hz) continue;
      throw SettingError("horizon_ms",
                         "is " + NumberText(steps * 1e3 / rate_hz) + ", must be from 0 to 1000");
    }
    noise_variance_ = NoiseOf(recordings);
    for (const Eigen::MatrixXd& recording : recordings) recordings_.emplace_back(recording, tap_);
  }

  Index channels() const { return noise_variance_.size(); }
  const Eigen::ArrayXd& noise_variance() const { return noise_variance_; }
  std::span<const Averaged> recordings() const { return recordings_; }

  Geometry Of(Index channel) const {
    return {.channel = channel,
            .order = wanted_.order,
            .tap = tap_,
            .horizon = WholeIfNearly(horizon_steps_[channel]),
            .regressors = RegressorsOf(wanted_, channel, noise_variance_)};
  }
  FittedPredictionConfig Empty() const {
    const auto channels = static_cast<std::size_t>(this->channels());
    FittedPredictionConfig config = {
        .horizon_ms = wanted_.horizon_ms,
        .order = wanted_.order,
        .tap_ms = wanted_.tap_ms,
        .tap_means = true,
        .weights = std::vector<double>(channels * static_cast<std::size_t>(wanted_.order)),
        .fallback = wanted_.fallback,
        .r_deg2 = wanted_.r_deg2};
    if (wanted_.offset) {
      config.position_weights.resize(wanted_.all_channels ? channels * channels : channels);
      config.offset_deg.resize(channels);
    }
    if (wanted_.all_channels) config.slope_weights.resize(channels * channels);
    return config;
  }
  /// Errors: SettingError if there are too few samples, or they determine no weights.
  Eigen::VectorXd Weights(const Moments& moments, const Geometry& geometry) const {
    CheckSamples(moments.samples, geometry);
    if (const auto weights = WeightsOf(moments, NoiseIn(geometry))) return *weights;
    throw SettingError("recording", "channel " + std::to_string(geometry.channel + 1) +
                                        " moves too little, or has no noise: its weights are not "
                                        "determined");
  }
  AddedNoise NoiseIn(const Geometry& geometry) const {
    return {geometry, noise_variance_, wanted_.caution};
  }
  void Put(const Eigen::VectorXd& weights, const Geometry& geometry,
           FittedPredictionConfig& config) const {
    for (Index i = 0; i < geometry.weights(); ++i) {
      PlaceOf(geometry.regressors[static_cast<std::size_t>(i)], geometry.channel, config) =
          weights[i];
    }
  }

 private:
  double& PlaceOf(const Regressor& regressor, Index channel, FittedPredictionConfig& config) const {
    const auto at = [](std::vector<double>& values, Index i) -> double& {
      return values[static_cast<std::size_t>(i)];
    };
    const Index of_all = channel * channels() + regressor.channel;
    switch (regressor.kind) {
      case Regressor::Kind::kTap:
        return at(config.weights, channel * wanted_.order + regressor.terms.front().tap - 1);
      case Regressor::Kind::kPosition:
        return at(config.position_weights, wanted_.all_channels ? of_all : channel);
      case Regressor::Kind::kSlope:
        return at(config.slope_weights, of_all);
      case Regressor::Kind::kOffset:
        break;
    }
    return at(config.offset_deg, channel);
  }

  const FittedToOthersPredictionConfig& wanted_;
  Index tap_ = 1;
  Eigen::ArrayXd horizon_steps_;
  Eigen::ArrayXd noise_variance_;
  std::vector<Averaged> recordings_;
};

}  // namespace

PredictorFit FitPredictor(std::span<const Eigen::MatrixXd> recordings, double rate_hz,
                          const FittedToOthersPredictionConfig& wanted) {
  const Fits fits(recordings, rate_hz, wanted);
  PredictorFit fit{.predictor = fits.Empty(),
                   .noise_variance = fits.noise_variance(),
                   .hold_rms = Eigen::ArrayXd(fits.channels()),
                   .fit_rms = Eigen::ArrayXd(fits.channels()),
                   .held_out_rms = Eigen::ArrayXd(fits.channels())};
  for (Index channel = 0; channel < fits.channels(); ++channel) {
    const Geometry geometry = fits.Of(channel);
    const std::vector<Moments> folds = MomentsOfFifths(fits.recordings(), geometry);
    Moments all(geometry.weights());
    for (const Moments& fold : folds) all += fold;
    const Eigen::VectorXd weights = fits.Weights(all, geometry);
    fits.Put(weights, geometry, fit.predictor);
    fit.hold_rms[channel] = std::sqrt(all.of_end / all.samples);
    fit.fit_rms[channel] = std::sqrt(all.Left(weights) / all.samples);
    fit.held_out_rms[channel] = std::sqrt(HeldOut(folds, fits.NoiseIn(geometry)) / all.samples);
  }
  return fit;
}

PredictionErrors JudgePredictor(const FittedPredictionConfig& predictor,
                                std::span<const Eigen::MatrixXd> recordings, double rate_hz) {
  CheckRecordings(recordings);
  const Index channels = recordings.front().cols();
  FittedPredictionConfig weights = predictor;
  weights.fallback = false;  // whose r is in deg^2, whatever the unit of the recordings
  const auto filter = MakePredictor(weights, static_cast<int>(channels), rate_hz);
  const Eigen::ArrayXd horizon =
      HorizonSteps(predictor.horizon_ms, static_cast<int>(channels), rate_hz);
  const Index first = predictor.order * std::lround(predictor.tap_ms * 1e-3 * rate_hz);
  PredictionErrors errors = {Eigen::ArrayXd::Zero(channels), Eigen::ArrayXd::Zero(channels)};
  double count = 0.0;
  std::vector<double> value(static_cast<std::size_t>(channels));
  for (const Eigen::MatrixXd& z : recordings) {
    filter->Reset();
    const Index end = z.rows() - static_cast<Index>(std::ceil(horizon.maxCoeff()));
    for (Index k = 0; k < end; ++k) {
      // An offset is for radians; without one the unit does not matter.
      for (Index c = 0; c < channels; ++c) value[c] = kRadPerDeg * z(k, c);
      filter->Step(value, value);
      if (k < first) continue;
      ++count;
      for (Index c = 0; c < channels; ++c) {
        const double then = At(z.col(c), static_cast<double>(k) + WholeIfNearly(horizon[c]));
        errors.hold_rms[c] += std::pow(then - z(k, c), 2);
        errors.left_rms[c] += std::pow(then - kDegPerRad * value[c], 2);
      }
    }
  }
  if (count == 0.0) throw SettingError("recording", "is shorter than what the weights look at");
  for (Eigen::ArrayXd* squares : {&errors.hold_rms, &errors.left_rms}) {
    *squares = (*squares / count).sqrt();
  }
  return errors;
}

std::vector<FittedPredictionConfig> FitPredictorsToOthers(
    std::span<const RecordedMotion> motions, double rate_hz,
    const FittedToOthersPredictionConfig& wanted) {
  std::vector<Eigen::MatrixXd> recordings;
  for (const RecordedMotion& motion : motions) {
    recordings.insert(recordings.end(), motion.begin(), motion.end());
  }
  const Fits fits(recordings, rate_hz, wanted);
  std::vector<FittedPredictionConfig> fitted(motions.size(), fits.Empty());
  for (Index channel = 0; channel < fits.channels(); ++channel) {
    const Geometry geometry = fits.Of(channel);
    std::vector<Moments> of_motions;
    auto next = fits.recordings().begin();
    for (const RecordedMotion& motion : motions) {
      Moments& moments = of_motions.emplace_back(geometry.weights());
      for (std::size_t i = 0; i < motion.size(); ++i, ++next) {
        moments += MomentsOf(*next, geometry, 0, geometry.CountOf(next->samples));
      }
    }
    for (std::size_t i = 0; i < motions.size(); ++i) {
      Moments others(geometry.weights());
      for (std::size_t j = 0; j < motions.size(); ++j) {
        if (j != i) others += of_motions[j];
      }
      fits.Put(fits.Weights(others, geometry), geometry, fitted[i]);
    }
  }
  return fitted;
}

}  // namespace gauntlet::controller
