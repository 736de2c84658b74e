#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "controller/controller_config.h"
#include "controller/export.h"

namespace gauntlet::controller {

/// One member of embedded::Settings, or of its member `group`: a value, a list, or a matrix in
/// row-major order.
struct GAUNTLET_API EmbeddedValue {
  enum Type { kFloat, kInteger, kFlag };
  std::string_view group = {};
  std::string_view name;
  Type type = kFloat;
  std::vector<double> values;
  std::size_t columns = 0;  // of a matrix
  bool is_list = false;
};

/// The settings of embedded::Controller, in the order of embedded::Settings.
struct GAUNTLET_API EmbeddedSettings {
  std::size_t corner_count = 0;  // of the linearisation
  std::size_t step_count = 0;    // that the prediction keeps; 0 without
  std::vector<EmbeddedValue> values;
};

/// Its controller with filters that embedded::Controller runs: each one with gains that change is
/// replaced by what it settles to (kalman and kalman_adaptive by kalman_steady, one_euro by the
/// exponential filter that it is at rest). `replaced` gets a phrase for each. What has no such form
/// stays, and EmbeddedSettingsOf() refuses it.
GAUNTLET_API ControllerConfig Settled(const RobotConfig& robot, std::vector<std::string>& replaced);

/// The robot as embedded::Controller runs it.
///
/// Errors: SettingError for what a Controller cannot be made of, and for what the embedded form
/// does not hold, with what does: several filters or one without constant gains, a start from zero,
/// a polynomial, a prediction but `adaptive`, noise shaping, an event period that is no whole
/// number of ticks.
GAUNTLET_API EmbeddedSettings EmbeddedSettingsOf(const RobotConfig& robot);

}  // namespace gauntlet::controller
