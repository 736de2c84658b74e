#include "sim/comparison/prediction_ceiling.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <optional>
#include <span>
#include <variant>

#include "controller/calibration/predictor_fit.h"
#include "controller/prediction/horizon.h"
#include "sim/comparison/summary.h"
#include "sim/score/tracking.h"
#include "sim/study/counted_parts.h"
#include "sim/trial/filter_trial.h"
#include "sim/trial/joint_angles.h"

namespace gauntlet::sim {
namespace {

using Eigen::Index;

constexpr std::size_t kMostMeasured = 8;
constexpr double kMostFitted_s = 60.0;
constexpr double kTap_ms = 5.0;  // of the fitted weights; a sample if that is longer
constexpr int kFolds = 2;

/// The same glove for a controller that neither filters nor predicts, nor plans commands.
controller::ControllerConfig Plain(controller::ControllerConfig config) {
  config.filters.clear();
  config.filter_on = controller::FilterOn::kCounts;
  config.filter_at = controller::FilterAt::kSample;
  config.model_predictive = {};
  config.prediction.settings = controller::NoPredictionConfig{};
  return config;
}

/// Each channel as it will be after its horizon; rows that have no such future are left out.
Signal Ahead(const Signal& channels, std::span<const Index> horizon_ticks) {
  const Index longest = std::ranges::max(horizon_ticks);
  Signal ahead(std::max<Index>(channels.rows() - longest, 0), channels.cols());
  for (Index c = 0; c < channels.cols(); ++c) {
    ahead.col(c) =
        channels.col(c).segment(horizon_ticks[static_cast<std::size_t>(c)], ahead.rows());
  }
  return ahead;
}

/// Adds the stretches in which no sample is missing, and gives how many samples they have.
Index AddWhole(const Signal& counts, std::vector<Eigen::MatrixXd>& stretches) {
  Index added = 0;
  Index begin = 0;
  for (Index n = 0; n <= counts.rows(); ++n) {
    if (n < counts.rows() && counts.row(n).allFinite()) continue;
    if (n > begin) stretches.emplace_back(counts.middleRows(begin, n - begin));
    added += n - begin;
    begin = n + 1;
  }
  return added;
}

/// The errors of one repetition, mean over joints of the RMS [deg].
struct Errors {
  double now = 0.0;
  double ours = 0.0;
  double fitted = 0.0;
  double known = 0.0;
};

/// NaN where weights foresee next to nothing of the motion: of that there is no share.
double UsedShare(const Errors& errors) {
  constexpr double kLeastForeseen = 0.05;  // of the error as it is
  const double foreseen = errors.now - errors.fitted;
  if (foreseen < kLeastForeseen * errors.now) return kNaN;
  return (errors.now - errors.ours) / foreseen;
}

/// All that concerns one controller.
class Ceiling {
 public:
  Ceiling(const Study& study, const NamedController& named, const std::vector<double>& horizon_ms)
      : study_(study), named_(named), horizon_ms_(horizon_ms) {
    const LoopTiming& timing = study.hand->timing();
    const auto channels = static_cast<int>(study.channel_names().size());
    const Eigen::ArrayXd ticks =
        controller::HorizonSteps(horizon_ms, channels, timing.tick_rate_hz());
    for (const double horizon : ticks) horizon_ticks_.push_back(std::lround(horizon));
  }

  /// Weights of order 40 for the horizon, from what the gloves of some seeds said.
  controller::ControllerConfig FittedTo(std::span<const int> seeds) const {
    const double rate_hz = study_.hand->timing().controller.sample_rate_hz();
    std::vector<Eigen::MatrixXd> recordings;
    double fitted_s = 0.0;
    for (const int seed : seeds) {
      if (!recordings.empty() && fitted_s >= kMostFitted_s) break;
      const std::shared_ptr<const GloveSignal> glove = GloveOfSeed(study_, seed);
      fitted_s += static_cast<double>(AddWhole(glove->counts, recordings)) / rate_hz;
    }
    const double tap_samples = std::max(1.0, std::round(kTap_ms * 1e-3 * rate_hz));
    controller::ControllerConfig config = Plain(named_.config);
    config.prediction.settings =
        controller::FitPredictor(recordings, rate_hz,
                                 {.horizon_ms = horizon_ms_, .tap_ms = 1e3 * tap_samples / rate_hz})
            .predictor;
    return config;
  }

  Errors Measure(int seed, const controller::ControllerConfig& fitted) const {
    const std::shared_ptr<const GloveSignal> glove = GloveOfSeed(study_, seed);
    const controller::JointMap joint_map = study_.joint_map();
    const Signal now = ReferenceAngles(joint_map, glove->true_angle_rad);
    const Signal future = ReferenceAngles(joint_map, Ahead(glove->true_angle_rad, horizon_ticks_));
    const Signal plain = AskedBy(Plain(named_.config), *glove);
    const std::vector<CountedTicks> counted = CountedWithFuture(*glove, future.rows());
    return {.now = MeanRms_deg(plain, future, counted),
            .ours = MeanRms_deg(AskedBy(named_.config, *glove), future, counted),
            .fitted = MeanRms_deg(AskedBy(fitted, *glove), future, counted),
            .known = MeanRms_deg(plain, now, counted)};
  }

 private:
  Signal AskedBy(const controller::ControllerConfig& config, const GloveSignal& glove) const {
    return RunFilterTrial(SetupOf(study_, {.name = named_.name, .config = config}), glove)
        .hand_angle_rad;
  }
  /// The ticks of each measured joint that count, and with them what is ahead of them.
  std::vector<CountedTicks> CountedWithFuture(const GloveSignal& glove, Index ticks) const {
    const auto longest = static_cast<int>(std::ranges::max(horizon_ticks_));
    const auto all = static_cast<int>(ticks);
    const auto counted = CountedPartsOf(study_, glove.masked, all + longest);
    std::vector<CountedTicks> joints(study_.measured_joints.size(), CountedTicks{{0, all}});
    for (std::size_t i = 0; counted && i < joints.size(); ++i) {
      joints[i].clear();
      for (const TickRange& range : counted->joints[i]) {
        if (range.end - longest > range.begin) {
          joints[i].push_back({range.begin, range.end - longest});
        }
      }
    }
    return joints;
  }
  double MeanRms_deg(const Signal& asked_rad, const Signal& wanted_rad,
                     const std::vector<CountedTicks>& counted) const {
    double sum = 0.0;
    const Index rows = std::min(asked_rad.rows(), wanted_rad.rows());
    for (std::size_t i = 0; i < counted.size(); ++i) {
      const int joint = study_.measured_joints[i];
      const Eigen::VectorXd error =
          asked_rad.col(joint).head(rows) - wanted_rad.col(joint).head(rows);
      sum += RmsWithin({error.data(), static_cast<std::size_t>(rows)}, 0, counted[i]);
    }
    return kDegPerRad * sum / static_cast<double>(counted.size());
  }

  const Study& study_;
  const NamedController& named_;
  const std::vector<double>& horizon_ms_;
  std::vector<Index> horizon_ticks_;
};

PredictionCeiling Conclude(const NamedController& named, const std::vector<double>& horizon_ms,
                           const std::vector<Errors>& errors, std::span<const int> motions) {
  const auto mean_of = [&](auto value) {
    std::vector<double> values;
    for (const Errors& of_seed : errors) values.push_back(value(of_seed));
    return EstimateMean(values, motions).IntervalAt();
  };
  return {.controller = named.name,
          .shortest_horizon_ms = std::ranges::min(horizon_ms),
          .longest_horizon_ms = std::ranges::max(horizon_ms),
          .now = mean_of([](const Errors& e) { return e.now; }),
          .ours = mean_of([](const Errors& e) { return e.ours; }),
          .fitted = mean_of([](const Errors& e) { return e.fitted; }),
          .known = mean_of([](const Errors& e) { return e.known; }),
          .used = mean_of(UsedShare)};
}

}  // namespace

std::vector<PredictionCeiling> MeasurePredictionCeilings(
    const Study& study, const StudyResult& result,
    const std::function<void(const std::string&)>& remark) {
  std::vector<PredictionCeiling> ceilings;
  if (result.seeds_alike && study.repetitions.size() < kFolds) return ceilings;
  std::vector<int> seeds;
  for (const SeedOutcome& outcome : result.seeds) seeds.push_back(outcome.seed);
  seeds.resize(std::min(seeds.size(), kMostMeasured));
  if (seeds.size() < kFolds) return ceilings;
  std::vector<int> motions = MotionsOf(result);
  motions.resize(seeds.size());
  std::array<std::vector<int>, kFolds> folds;
  for (std::size_t i = 0; i < seeds.size(); ++i) folds[i % kFolds].push_back(seeds[i]);

  for (const NamedController& named : study.scenario.controllers) {
    const std::vector<double>* const horizon_ms =
        std::visit([](const auto& settings) { return controller::HorizonOf(settings); },
                   named.config.prediction.settings);
    if (horizon_ms == nullptr || std::ranges::max(*horizon_ms) == 0.0) continue;
    const Ceiling ceiling(study, named, *horizon_ms);
    try {
      const std::array<controller::ControllerConfig, kFolds> fitted = {ceiling.FittedTo(folds[1]),
                                                                       ceiling.FittedTo(folds[0])};
      std::vector<Errors> errors;
      for (std::size_t i = 0; i < seeds.size(); ++i) {
        errors.push_back(ceiling.Measure(seeds[i], fitted[i % kFolds]));
      }
      ceilings.push_back(Conclude(named, *horizon_ms, errors, motions));
    } catch (const controller::SettingError& error) {
      remark(fmt::format("{}: what is predictable is not known: {} {}", named.name, error.key(),
                         error.problem()));
    }
  }
  return ceilings;
}

}  // namespace gauntlet::sim
