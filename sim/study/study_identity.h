#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "sim/study/study.h"

namespace gauntlet::sim {

// A trial is determined by its study, the settings of its controller and its seed. Two trials that
// agree in all three give the same bytes.

struct TrialKey {
  std::string study;  // HashOfStudy(), for a sweep with the scores that it keeps
  std::string controller;
  std::string settings;  // HashOfSettings()
  std::int64_t seed = 0;
};

/// The settings that all trials of a study share, as YAML of a scenario. Paths are reduced to their
/// last name, so that a study that was moved is the same.
std::string SharedSettings(const Study& study);

/// Hash of glove, hand, event, model, the glove signals of the first seed of every repetition, and
/// the program itself: another build may compute other bytes.
std::string HashOfStudy(const Study& study);

/// Hash of all settings of a controller, of its name, and of what its programs are (see
/// HashOfPrograms()).
std::string HashOfSettings(const NamedController& controller);

/// All of these of a study. Costs milliseconds: once per study, not per file that is opened.
struct StudyIdentity {
  std::string hash;                              // HashOfStudy()
  std::string shared_settings;                   // SharedSettings()
  std::vector<std::string> controller_settings;  // HashOfSettings() of each controller
};
StudyIdentity IdentityOf(const Study& study);

}  // namespace gauntlet::sim
