#pragma once

#include "controller/settings.h"

namespace gauntlet::sim {

/// Bend sensors: how an angle becomes a voltage, here a share of the converter's full scale.
///
///     share = 0.5 (low + high) + gain (high - low) ((angle - min) / (max - min) - 0.5) + offset
///
/// `gain` is 1 and `offset` 0 in the nominal sensor; a seed draws one glove with normal deviations.
/// Source of the deviations: an assumption; a well calibrated CyberGlove has an RMS error below
/// 10 deg at most joints, and these defaults give about 3 to 6 deg.
struct SensorConfig {
  double low_percent = 10.0;
  double high_percent = 90.0;
  double gain_deviation_percent = 5.0;
  double offset_deviation_percent = 2.0;

  void Visit(controller::SettingsVisitor& visitor);
};

}  // namespace gauntlet::sim
