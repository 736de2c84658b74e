#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "controller/controller_config.h"
#include "sim/base/signal.h"
#include "sim/glove/faults/faults.h"
#include "sim/glove/glove_config.h"
#include "sim/glove/motions/motion.h"

namespace gauntlet::sim {

/// Motion of the wearer and the glove's samples of it. All controllers of a trial get the same.
struct GloveSignal {
  std::vector<std::string> channel_names;
  double rate_hz = 1000.0;       // of samples
  double tick_rate_hz = 1000.0;  // of the true motion: see LoopTiming
  int ticks_per_sample = 1;
  Signal true_angle_rad;  // ticks x channels
  Signal counts;          // samples x channels, whole numbers; NaN where a sample is missing
  std::vector<Segment> segments;               // that a person labelled, in ticks
  std::vector<MaskedStretch> masked;           // of a recording: unknown motion, in ticks
  std::shared_ptr<const Recording> recording;  // see Motion
  double recording_start_s = 0.0;
  std::string reference_name;      // what the scores compare with, in words: "ground truth"
  bool is_recorded = false;        // counts are what a real glove said, its own noise included
  Signal tremor_rad;               // ticks x channels: part of the motion; no rows if there is none
  std::vector<FaultEvent> faults;  // the truth of each fault, in samples
  std::vector<std::string> remarks;  // what was repaired in a recording, one line each
};

/// Indices in KnownChannels() of the channels that the glove has, in that order.
/// Errors: SettingError of `channels` for an unknown name.
std::vector<int> ChannelsOf(const GloveConfig& config);

/// The whole signal of one seed: motion, sensor, noise, converter. Pure: same input, same bytes.
/// Errors: UserError for a recording that cannot be read, SettingError for settings that do not
/// fit.
GloveSignal SynthesiseGlove(const GloveConfig& config, std::uint64_t seed);

/// The answers of another program to the recording that `glove` plays, from a file of its rows:
/// samples x channels of the glove [counts, before the converter]; NaN in gaps. `map`: of that
/// file, empty: that of the recording. Errors: SettingError `answers` for a glove that plays no
/// recording as measured, or has noise or faults of its own, and for a file without one of its
/// channels; UserError for one that cannot be read or has other rows.
Signal AnswersInCounts(const GloveConfig& config, const GloveSignal& glove, const std::string& file,
                       const std::string& map);

/// Keeps the first ticks of a signal.
void CutGlove(Eigen::Index ticks, GloveSignal& glove);

/// Glove of the same wearer, motion, tremor, sensors and converter, without noise and faults. All
/// random streams are of their own: with the same seed nothing else changes.
GloveConfig WithoutNoise(GloveConfig config);
/// True if WithoutNoise() changes nothing of the signal.
bool IsWithoutNoise(const GloveConfig& config);

/// Variance of the noise that the settings draw, per channel of the glove; 0 where there is none.
/// A recording's noise is not counted.
std::vector<double> NoiseVarianceCounts2(const GloveConfig& config);
/// Variance of that noise behind the nominal linearisation [rad^2].
std::vector<double> NoiseVarianceRad2(const GloveConfig& config);

/// Takes the calibration, and the converter's bits, of a recording in counts (`use: measured`) from
/// its column map, unless the settings have a calibration. A file that cannot be read, or settings
/// that are wrong, change nothing: SynthesiseGlove() reports them. Errors: UserError if columns
/// without bits of their own would become counts of another converter.
void ApplyCalibrationOfMap(GloveConfig& config);

/// Calibration for the controllers. A channel of `config.calibration` has its two poses, every
/// other one those of the nominal sensor, without the deviations of the glove that a seed draws.
controller::GloveCalibration NominalCalibration(const GloveConfig& config);

}  // namespace gauntlet::sim
