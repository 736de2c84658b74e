#pragma once

#include "controller/settings.h"
#include "sim/glove/motions/motion_config.h"
#include "sim/glove/noise/noise_config.h"
#include "sim/glove/sensor/converter.h"
#include "sim/glove/sensor/sensor_config.h"

namespace gauntlet::sim {

/// Everything that the glove does. Lists of one number per channel are in the order of
/// GloveChannels().
struct GloveConfig {
  double rate_hz = 1000.0;  // Source: Bai, Jiang, Yokoi, section 4
  MotionConfig motion;
  SensorConfig sensor;
  NoiseConfig noise;
  ConverterConfig converter;

  void Visit(controller::SettingsVisitor& visitor);
};

}  // namespace gauntlet::sim
