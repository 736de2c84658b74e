#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "controller/controller_config.h"
#include "sim/base/signal.h"
#include "sim/glove/faults/faults.h"
#include "sim/glove/glove_config.h"
#include "sim/glove/motions/motion.h"

namespace gauntlet::sim {

/// What the wearer did and what the glove said of it. All controllers of a trial get the same.
struct GloveSignal {
  std::vector<std::string> channel_names;
  double rate_hz = 1000.0;
  Signal true_angle_rad;  // samples x channels
  Signal counts;          // samples x channels, whole numbers; NaN where a sample is missing
  std::vector<Segment> segments;  // that a person labelled
  std::string reference_name;     // what the scores compare with, in words: "ground truth"
  Signal tremor_rad;  // samples x channels: part of the motion; no rows if there is none
  std::vector<FaultEvent> faults;    // the truth of each fault
  std::vector<std::string> remarks;  // what was repaired in a recording, one line each
};

/// The whole signal of one seed: motion, sensor, noise, converter. Pure: same input, same bytes.
/// Errors: UserError for a recording that cannot be read, SettingError for settings that do not
/// fit.
GloveSignal SynthesiseGlove(const GloveConfig& config, std::uint64_t seed);

/// What a careful person knows of the glove after calibrating it: the nominal sensor, without the
/// deviations of the one glove that a seed draws.
controller::GloveCalibration NominalCalibration(const GloveConfig& config);

}  // namespace gauntlet::sim
