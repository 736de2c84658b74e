#pragma once

#include <Eigen/Core>

#include "controller/settings.h"

namespace gauntlet::sim {

/// Choices of a scenario about its scores.
struct ScoreConfig {
  /// Lower edge of jitter: that of the high pass of jitter.h, which passes nothing
  /// below 0.8 and everything above 1.2 times this. Below 2 Hz all is human motion; above 100 Hz
  /// there is nothing to be seen any more, and ticks, of which there are 1000 in a second at least,
  /// would not hold it.
  double jitter_above_hz = 10.0;

  /// Before every trial the same one runs with a noise-free glove: noise adds the difference.
  bool noise_free_twin = true;

  /// After a gap or restart of a recording nothing counts for so long: filters and hand held on
  /// to what was before. It is the same for all controllers. 1 s is a hand's delay and way (0.5 s,
  /// as at rest) and four time constants of the slowest filter of field_presets.yaml (133 ms).
  double recovery_s = 1.0;

  void Visit(controller::SettingsVisitor& visitor);
  /// Errors: SettingError for an edge below the default that a trial is too short for. (One that is
  /// too short for the default has no jitter.)
  void Check(double rate_hz, Eigen::Index ticks) const;
};

}  // namespace gauntlet::sim
