#include "sim/study/prediction_fit.h"

#include <Eigen/Core>
#include <algorithm>
#include <set>
#include <utility>

#include "controller/angle_estimator.h"
#include "controller/prediction/fitted_to_others_prediction.h"
#include "sim/study/study_identity.h"

namespace gauntlet::sim {
namespace {

using controller::ControllerConfig;
using controller::FittedPredictionConfig;
using controller::FittedToOthersPredictionConfig;
using controller::RecordedMotion;

/// The stretch [begin, end) of samples, none of which is missing.
Eigen::MatrixXd Seen(const controller::RobotConfig& robot, const Signal& counts, Eigen::Index begin,
                     Eigen::Index end) {
  controller::AngleEstimator estimator(robot, robot.controller, 0);
  Eigen::MatrixXd seen_deg(end - begin, counts.cols());
  Eigen::VectorXd sample(counts.cols());
  Eigen::VectorXd angle_rad(counts.cols());
  const auto size = static_cast<std::size_t>(counts.cols());
  for (Eigen::Index k = begin; k < end; ++k) {
    sample = counts.row(k).transpose();
    estimator.Step({sample.data(), size}, {angle_rad.data(), size});
    seen_deg.row(k - begin) = kDegPerRad * angle_rad.transpose();
  }
  return seen_deg;
}

/// The motions of a study, each with all repetitions that have it.
struct Motions {
  std::vector<RecordedMotion> seen;
  std::vector<std::size_t> of_repetition;
};

Motions MotionsOf(const Study& study, const ControllerConfig& controller) {
  Motions motions;
  std::map<std::string, std::size_t> known;
  for (std::size_t i = 0; i < study.repetitions.size(); ++i) {
    const auto [at, is_new] = known.emplace(study.repetitions[i].motion_hash, motions.seen.size());
    if (is_new) motions.seen.emplace_back();
    motions.of_repetition.push_back(at->second);
    const auto glove = GloveOfSeed(study, study.scenario.seed + static_cast<int>(i));
    RecordedMotion seen = SeenByPredictor(study, controller, *glove);
    std::ranges::move(seen, std::back_inserter(motions.seen[at->second]));
  }
  if (motions.seen.size() < 2) {
    throw controller::SettingError("kind",
                                   "is fitted_to_others, which needs repetitions with other "
                                   "motions; this scenario has one motion, or draws them");
  }
  return motions;
}

double SampleRate_hz(const Study& study) {
  return study.hand->timing().controller.sample_rate_hz();
}

/// Of each repetition.
std::vector<FittedPredictionConfig> FitToOthers(const Study& study,
                                                const ControllerConfig& controller,
                                                const FittedToOthersPredictionConfig& wanted) {
  const Motions motions = MotionsOf(study, controller);
  const std::vector<FittedPredictionConfig> of_motions =
      controller::FitPredictorsToOthers(motions.seen, SampleRate_hz(study), wanted);
  std::vector<FittedPredictionConfig> of_repetitions;
  for (const std::size_t motion : motions.of_repetition) {
    of_repetitions.push_back(of_motions[motion]);
  }
  return of_repetitions;
}

}  // namespace

RecordedMotion SeenByPredictor(const Study& study, ControllerConfig controller,
                               const GloveSignal& glove) {
  if (controller.filter_at != controller::FilterAt::kSample) {
    throw controller::SettingError("kind", "is fitted_to_others, which needs filter_at: sample");
  }
  controller.prediction.settings = controller::NoPredictionConfig{};
  const controller::RobotConfig robot = RobotOf(study.scenario, *study.hand, controller);
  RecordedMotion seen;
  Eigen::Index begin = 0;
  for (Eigen::Index n = 0; n <= glove.counts.rows(); ++n) {
    if (n < glove.counts.rows() && glove.counts.row(n).allFinite()) continue;
    if (n > begin) seen.push_back(Seen(robot, glove.counts, begin, n));
    begin = n + 1;
  }
  return seen;
}

ControllerConfig ControllerOfSeed(const Study& study, const ControllerConfig& controller,
                                  int seed) {
  const auto* wanted = std::get_if<FittedToOthersPredictionConfig>(&controller.prediction.settings);
  if (wanted == nullptr) return controller;
  return controller::WithinSetting("prediction", [&] {
    const std::lock_guard lock(study.fits->mutex);
    auto& fits = study.fits->of_settings[HashOfSettings({.name = {}, .config = controller})];
    if (fits.empty()) fits = FitToOthers(study, controller, *wanted);
    ControllerConfig fitted = controller;
    fitted.prediction.settings =
        fits[static_cast<std::size_t>(seed - study.scenario.seed) % fits.size()];
    return fitted;
  });
}

ControllerConfig ControllerForRobot(const Study& study, ControllerConfig controller) {
  const auto* wanted = std::get_if<FittedToOthersPredictionConfig>(&controller.prediction.settings);
  if (wanted == nullptr) return controller;
  return controller::WithinSetting("prediction", [&] {
    std::vector<Eigen::MatrixXd> all;
    for (RecordedMotion& motion : MotionsOf(study, controller).seen) {
      std::ranges::move(motion, std::back_inserter(all));
    }
    controller.prediction.settings =
        controller::FitPredictor(all, SampleRate_hz(study), *wanted).predictor;
    return controller;
  });
}

}  // namespace gauntlet::sim
