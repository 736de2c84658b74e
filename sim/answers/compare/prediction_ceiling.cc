#include "sim/answers/compare/prediction_ceiling.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <numeric>
#include <span>
#include <variant>

#include "controller/calibration/predictor_fit.h"
#include "controller/prediction/horizon.h"
#include "sim/answers/compare/summary.h"
#include "sim/score/tracking.h"
#include "sim/study/counted_parts.h"
#include "sim/study/prediction_fit.h"
#include "sim/trial/filter_trial.h"
#include "sim/trial/joint_angles.h"

namespace gauntlet::sim {
namespace {

using Eigen::Index;

constexpr double kMost_s = 200.0;
constexpr double kTap_ms = 5.0;  // of the fitted weights; a sample if that is longer

/// Controller of the same glove that neither filters nor predicts, nor plans commands.
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

/// The errors of one repetition, mean over joints of the RMS [deg].
struct Errors {
  double now = 0.0;
  double ours = 0.0;
  double fitted = 0.0;
  double fitted_to_all = kNaN;
  double known = 0.0;
};

/// NaN where weights foresee next to nothing of the motion: of that there is no share.
double UsedShare(const Errors& errors, double fitted) {
  constexpr double kLeastForeseen = 0.05;  // of the error as it is
  const double foreseen = errors.now - fitted;
  if (!(foreseen >= kLeastForeseen * errors.now)) return kNaN;
  return (errors.now - errors.ours) / foreseen;
}

/// The repetitions that are measured.
struct Measured {
  std::vector<int> seeds;
  std::vector<int> motions;  // their numbers
  std::vector<int> groups;   // those of one group are not fitted to each other
  bool is_same_motion = false;
};

/// As many of the first as have kMost_s of motion in all, two at least.
Measured ChooseMeasured(const Study& study, const StudyResult& result) {
  Measured measured;
  double all_s = 0.0;
  for (const SeedOutcome& outcome : result.seeds) {
    if (measured.seeds.size() >= 2 && all_s >= kMost_s) break;
    const auto repetition =
        static_cast<std::size_t>(outcome.seed - study.scenario.seed) % study.repetitions.size();
    all_s += static_cast<double>(study.repetitions[repetition].ticks) /
             study.hand->timing().tick_rate_hz();
    measured.seeds.push_back(outcome.seed);
  }
  measured.motions = MotionsOf(result);
  measured.motions.resize(measured.seeds.size());
  measured.is_same_motion =
      std::ranges::adjacent_find(measured.motions, std::not_equal_to{}) == measured.motions.end();
  measured.groups = measured.motions;
  if (measured.is_same_motion) std::iota(measured.groups.begin(), measured.groups.end(), 0);
  return measured;
}

/// All that concerns one controller.
class Ceiling {
 public:
  Ceiling(const Study& study, const NamedController& named, const std::vector<double>& horizon_ms,
          const Measured& measured)
      : study_(study), named_(named) {
    const LoopTiming& timing = study.hand->timing();
    const auto channels = static_cast<int>(study.channel_names().size());
    const Eigen::ArrayXd ticks =
        controller::HorizonSteps(horizon_ms, channels, timing.tick_rate_hz());
    for (const double horizon : ticks) horizon_ticks_.push_back(std::lround(horizon));
    const double rate_hz = timing.controller.sample_rate_hz();
    const double tap_samples = std::max(1.0, std::round(kTap_ms * 1e-3 * rate_hz));
    controller::FittedToOthersPredictionConfig wanted = {
        .horizon_ms = horizon_ms, .tap_ms = 1e3 * tap_samples / rate_hz, .offset = true};
    fitted_ = FitToOthers(study, Plain(named.config), measured.seeds, measured.groups, wanted);
    if (channels == 1) return;
    wanted.all_channels = true;
    try {
      fitted_to_all_ =
          FitToOthers(study, Plain(named.config), measured.seeds, measured.groups, wanted);
    } catch (const controller::SettingError&) {  // too short for so many weights
    }
  }

  /// Errors of repetition number `i`.
  Errors Measure(int seed, std::size_t i) const {
    const std::shared_ptr<const GloveSignal> glove = GloveOfSeed(study_, seed);
    const controller::JointMap joint_map = study_.joint_map();
    const Signal now = ReferenceAngles(joint_map, glove->true_angle_rad);
    const Signal future = ReferenceAngles(joint_map, Ahead(glove->true_angle_rad, horizon_ticks_));
    const controller::ControllerConfig plain = Plain(named_.config);
    const std::vector<CountedTicks> counted = CountedWithFuture(*glove, future.rows());
    const auto error_of = [&](const controller::ControllerConfig& config, const Signal& wanted) {
      return MeanRms_deg(AskedBy(config, *glove, seed), wanted, counted);
    };
    const auto with = [&](const controller::FittedPredictionConfig& predictor) {
      controller::ControllerConfig config = plain;
      config.prediction.settings = predictor;
      return config;
    };
    return {
        .now = error_of(plain, future),
        .ours = error_of(named_.config, future),
        .fitted = error_of(with(fitted_[i]), future),
        .fitted_to_all = fitted_to_all_.empty() ? kNaN : error_of(with(fitted_to_all_[i]), future),
        .known = error_of(plain, now)};
  }

 private:
  Signal AskedBy(const controller::ControllerConfig& config, const GloveSignal& glove,
                 int seed) const {
    Trace trace =
        RunFilterTrial(SetupOf(study_, {.name = named_.name, .config = config}, seed), glove);
    if (!trace.health.ok) throw RunError(trace.health.problem);
    return std::move(trace.hand_angle_rad);
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
  std::vector<Index> horizon_ticks_;
  std::vector<controller::FittedPredictionConfig> fitted_;  // of each repetition
  std::vector<controller::FittedPredictionConfig> fitted_to_all_;
};

PredictionCeiling Conclude(const NamedController& named, const std::vector<double>& horizon_ms,
                           const std::vector<Errors>& errors, const Measured& measured) {
  const auto mean_of = [&](auto value) {
    std::vector<double> values;
    for (const Errors& of_seed : errors) values.push_back(value(of_seed));
    return EstimateMean(values, measured.motions).IntervalAt();
  };
  return {.controller = named.name,
          .shortest_horizon_ms = std::ranges::min(horizon_ms),
          .longest_horizon_ms = std::ranges::max(horizon_ms),
          .is_same_motion = measured.is_same_motion,
          .now = mean_of([](const Errors& e) { return e.now; }),
          .ours = mean_of([](const Errors& e) { return e.ours; }),
          .fitted = mean_of([](const Errors& e) { return e.fitted; }),
          .fitted_to_all = mean_of([](const Errors& e) { return e.fitted_to_all; }),
          .known = mean_of([](const Errors& e) { return e.known; }),
          .used = mean_of([](const Errors& e) { return UsedShare(e, e.fitted); }),
          .used_of_all = mean_of([](const Errors& e) { return UsedShare(e, e.fitted_to_all); })};
}

}  // namespace

std::vector<PredictionCeiling> MeasurePredictionCeilings(
    const Study& study, const StudyResult& result,
    const std::function<void(const std::string&)>& remark) {
  std::vector<PredictionCeiling> ceilings;
  if (result.seeds_alike && study.repetitions.size() < 2) return ceilings;
  const Measured measured = ChooseMeasured(study, result);
  if (measured.seeds.size() < 2) return ceilings;
  for (const NamedController& named : study.scenario.controllers) {
    const std::vector<double>* const horizon_ms =
        std::visit([](const auto& settings) { return controller::HorizonOf(settings); },
                   named.config.prediction.settings);
    if (horizon_ms == nullptr || std::ranges::max(*horizon_ms) == 0.0) continue;
    try {
      const Ceiling ceiling(study, named, *horizon_ms, measured);
      std::vector<Errors> errors;
      for (std::size_t i = 0; i < measured.seeds.size(); ++i) {
        errors.push_back(ceiling.Measure(measured.seeds[i], i));
      }
      ceilings.push_back(Conclude(named, *horizon_ms, errors, measured));
    } catch (const controller::SettingError& error) {
      remark(fmt::format("{}: what is predictable is not known: {} {}", named.name, error.key(),
                         error.problem()));
    }
  }
  return ceilings;
}

}  // namespace gauntlet::sim
