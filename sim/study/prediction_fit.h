#pragma once

#include <map>
#include <mutex>
#include <span>
#include <string>
#include <vector>

#include "controller/calibration/predictor_fit.h"
#include "sim/study/study.h"

namespace gauntlet::sim {

/// Signal of a glove as a controller's predictor would see it [deg]: a stretch between any two
/// missing samples. Errors: SettingError for filters that do not step at every sample.
controller::RecordedMotion SeenByPredictor(const Study& study,
                                           controller::ControllerConfig controller,
                                           const GloveSignal& glove);

/// For each of the seeds weights that were fitted to those of all other groups, which are numbered
/// from 0. Errors: SettingError if they determine none.
std::vector<controller::FittedPredictionConfig> FitToOthers(
    const Study& study, const controller::ControllerConfig& controller, std::span<const int> seeds,
    std::span<const int> groups, const controller::FittedToOthersPredictionConfig& wanted);

/// The controller as it runs with the glove of a seed. A prediction that is fitted to others gets
/// its weights, from the first seeds of all repetitions with another motion.
/// Errors: SettingError if there are none, or they determine no weights.
controller::ControllerConfig ControllerOfSeed(const Study& study,
                                              const controller::ControllerConfig& controller,
                                              int seed);

/// The controller as a robot takes it: the same weights, from all repetitions.
controller::ControllerConfig ControllerForRobot(const Study& study,
                                                controller::ControllerConfig controller);

/// Number of motions of the scenario: repetitions of one motion with other noise count once.
int MotionCount(const Study& study);

/// The weights that were fitted so far: for a controller's settings those of each repetition.
struct PredictionFits {
  std::mutex mutex;
  std::map<std::string, std::vector<controller::FittedPredictionConfig>> of_settings;
};

}  // namespace gauntlet::sim
