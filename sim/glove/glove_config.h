#pragma once

#include <string>
#include <vector>

#include "controller/settings.h"
#include "sim/glove/faults/fault_config.h"
#include "sim/glove/motions/motion_config.h"
#include "sim/glove/motions/tremor.h"
#include "sim/glove/noise/noise_config.h"
#include "sim/glove/sensor/converter.h"
#include "sim/glove/sensor/sensor_config.h"

namespace gauntlet::sim {

/// Two known poses of one channel of a real glove, whose recording is in its own counts.
struct OwnCalibration {
  std::string channel;
  double low_counts = 0.0;
  double high_counts = 0.0;
  double low_deg = 0.0;
  double high_deg = 0.0;
  std::string assumed;  // what of it is a guess, as in a column map

  void Visit(controller::SettingsVisitor& visitor);
};

/// Everything that the glove does. Lists of one number per channel are in the order of
/// KnownChannels(), also if the glove has only some of them; see PlaceInList().
struct GloveConfig {
  double rate_hz = 1000.0;            // Source: Bai, Jiang, Yokoi, section 4
  std::vector<std::string> channels;  // that the glove has; empty: GloveChannels()
  MotionConfig motion;
  TremorConfig tremor;
  SensorConfig sensor;
  NoiseConfig noise;
  ConverterConfig converter;
  std::vector<OwnCalibration> calibration;  // see ApplyCalibrationOfMap()
  std::vector<FaultConfig> faults;

  void Visit(controller::SettingsVisitor& visitor);
};

}  // namespace gauntlet::sim
