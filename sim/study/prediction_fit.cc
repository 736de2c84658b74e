#include "sim/study/prediction_fit.h"

#include <Eigen/Core>
#include <algorithm>
#include <iterator>
#include <set>
#include <string_view>

#include "controller/angle_estimator.h"
#include "controller/assert.h"
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

/// The first seed of each repetition, and the number of its motion.
struct Repetitions {
  std::vector<int> seeds;
  std::vector<int> motions;
};

Repetitions RepetitionsOf(const Study& study) {
  Repetitions repetitions;
  std::map<std::string, int> known;
  for (std::size_t i = 0; i < study.repetitions.size(); ++i) {
    const auto number = static_cast<int>(known.size());
    repetitions.seeds.push_back(study.scenario.seed + static_cast<int>(i));
    repetitions.motions.push_back(
        known.emplace(study.repetitions[i].motion_hash, number).first->second);
  }
  if (MotionCount(study) < 2) {
    throw controller::SettingError("kind",
                                   "is fitted_to_others, which needs replicates with other "
                                   "motions; this scenario has one motion, or draws them");
  }
  return repetitions;
}

double SampleRate_hz(const Study& study) {
  return study.hand->timing().controller.sample_rate_hz();
}

}  // namespace

int MotionCount(const Study& study) {
  std::set<std::string_view> motions;
  for (const GloveFacts& glove : study.repetitions) motions.insert(glove.motion_hash);
  return motions.size();
}

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

std::vector<FittedPredictionConfig> FitToOthers(const Study& study,
                                                const ControllerConfig& controller,
                                                std::span<const int> seeds,
                                                std::span<const int> groups,
                                                const FittedToOthersPredictionConfig& wanted) {
  GAUNTLET_ASSERT(!groups.empty() && seeds.size() == groups.size());
  std::vector<RecordedMotion> seen(static_cast<std::size_t>(std::ranges::max(groups)) + 1);
  for (std::size_t i = 0; i < seeds.size(); ++i) {
    std::ranges::move(SeenByPredictor(study, controller, *GloveOfSeed(study, seeds[i])),
                      std::back_inserter(seen[static_cast<std::size_t>(groups[i])]));
  }
  const std::vector<FittedPredictionConfig> of_groups =
      controller::FitPredictorsToOthers(seen, SampleRate_hz(study), wanted);
  std::vector<FittedPredictionConfig> fitted;
  for (const int group : groups) fitted.push_back(of_groups[static_cast<std::size_t>(group)]);
  return fitted;
}

ControllerConfig ControllerOfSeed(const Study& study, const ControllerConfig& controller,
                                  int seed) {
  const auto* wanted = std::get_if<FittedToOthersPredictionConfig>(&controller.prediction.settings);
  if (wanted == nullptr) return controller;
  return controller::WithinSetting("prediction", [&] {
    const std::lock_guard lock(study.fits->mutex);
    auto& fits = study.fits->of_settings[HashOfSettings({.name = {}, .config = controller})];
    if (fits.empty()) {
      const auto [seeds, motions] = RepetitionsOf(study);
      fits = FitToOthers(study, controller, seeds, motions, *wanted);
    }
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
    for (const int seed : RepetitionsOf(study).seeds) {
      std::ranges::move(SeenByPredictor(study, controller, *GloveOfSeed(study, seed)),
                        std::back_inserter(all));
    }
    controller.prediction.settings =
        controller::FitPredictor(all, SampleRate_hz(study), *wanted).predictor;
    return controller;
  });
}

}  // namespace gauntlet::sim
