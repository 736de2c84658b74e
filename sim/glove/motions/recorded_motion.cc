#include "sim/glove/motions/recorded_motion.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>

#include "sim/base/channels.h"
#include "sim/base/error.h"
#include "sim/glove/motions/postures.h"
#include "sim/glove/motions/settings_of_motions.h"
#include "sim/recordings/recording.h"
#include "sim/recordings/zero_phase.h"

namespace gauntlet::sim {
namespace {

constexpr std::array<std::string_view, 2> kUseNames = {"truth", "measured"};

RecordingFormat FormatOf(const RecordedMotionConfig& config, const MotionContext& context) {
  RecordingFormat format;
  format.map = config.map;
  format.rate_hz = config.file_rate_hz;
  format.skipped_lines = config.skip_lines;
  format.handling = config.problems;
  format.longest_gap_ms = config.longest_gap_ms;
  format.low_counts = context.sensor.low_counts(context.converter.full_scale_counts());
  format.high_counts = context.sensor.high_counts(context.converter.full_scale_counts());
  return format;
}

Recording Load(const RecordedMotionConfig& config, const RecordingFormat& format,
               const std::string& file) {
  // Reading ends where no motion goes, so that memory does not grow with the file.
  const double duration_s = config.duration_s > 0.0 ? config.duration_s : kLongestMotionS + 1.0;
  return LoadRecording(file, format, config.start_s, duration_s);
}

/// The stretch at the sampling rate; channels that the recording lacks hold the posture `rest`.
/// Where `masked`, a sample in a long gap is NaN; else it is made like all others.
Signal AtSamplingRate(const RecordedMotionConfig& config, const Recording& recording,
                      std::size_t samples, double rate_hz, Resampling how, bool masked = false) {
  const std::vector<double> rest = PostureAngles(0);
  Signal angle_rad(static_cast<Eigen::Index>(samples), static_cast<Eigen::Index>(rest.size()));
  for (std::size_t channel = 0; channel < rest.size(); ++channel) {
    auto column = angle_rad.col(static_cast<Eigen::Index>(channel));
    if (!recording.has_channel[channel]) {
      column.setConstant(rest[channel]);
      continue;
    }
    const Resampled resampled =
        Resample(recording, static_cast<Eigen::Index>(channel), config.start_s, rate_hz, samples,
                 1e-3 * config.longest_gap_ms, how);
    for (std::size_t i = 0; i < samples; ++i) {
      column[static_cast<Eigen::Index>(i)] = masked && resampled.mask[i]
                                                 ? std::numeric_limits<double>::quiet_NaN()
                                                 : resampled.value[i];
    }
    TrimSignals();
  }
  return angle_rad;
}

/// No joint leaves its range, whatever a file says.
void KeepInRange(Signal& angle_rad) {
  for (std::size_t channel = 0; channel < KnownChannels().size(); ++channel) {
    const Channel& joint = KnownChannels()[channel];
    auto column = angle_rad.col(static_cast<Eigen::Index>(channel));
    column = column.cwiseMax(joint.min_deg * kRadPerDeg).cwiseMin(joint.max_deg * kRadPerDeg);
    TrimSignals();
  }
}

std::size_t SampleCount(const RecordedMotionConfig& config, const Recording& recording,
                        const MotionContext& context) {
  const double available_s = recording.time_s.back() - config.start_s;
  if (config.duration_s > available_s + 0.5 / context.rate_hz) {
    throw UserError(
        {.place = recording.name,
         .problem = fmt::format("start_s {} and duration_s {} go beyond its end at {:.3f} s",
                                config.start_s, config.duration_s, recording.time_s.back())});
  }
  const double duration_s = config.duration_s > 0.0 ? config.duration_s : available_s;
  if (duration_s > kLongestMotionS) {
    throw UserError(
        {.place = recording.name,
         .problem = fmt::format("is longer than {} s, duration_s must be given (at most {} s)",
                                kLongestMotionS, kLongestMotionS)});
  }
  if (config.duration_s > 0.0) {
    return static_cast<std::size_t>(context.SampleCount(config.duration_s));
  }
  return static_cast<std::size_t>(std::floor(available_s * context.rate_hz + 1e-6)) + 1;
}

/// What the recording stands for, and the settings that depend on it.
void VisitUse(controller::SettingsVisitor& visitor, RecordedMotionConfig& config) {
  controller::VisitEnum(
      visitor, {.key = "use", .help = "the wearer's true motion, or what a real glove measured"},
      kUseNames, config.use);
  Resampling how = config.resampling();
  controller::VisitEnum(
      visitor,
      {.key = "resample",
       .help = "between two rows of the file: hold, the newest row, as a fast loop reads a slow "
               "glove; cubic, shape-preserving interpolation. Default: hold for use: measured, "
               "cubic for truth; a reference is always cubic"},
      kResamplingNames, how);
  if (how != config.resampling()) config.resample = how;
  if (config.use == RecordingUse::kTruth) return;
  visitor.Path({.key = "reference", .help = "recording of the truth at the same times, if any"},
               config.reference);
  visitor.Number({.key = "smoothing_hz",
                  .help = "without one the reference is the recording, smoothed at this cut-off",
                  .min = 0.1,
                  .max = 20},
                 config.smoothing_hz);
}

}  // namespace

void RecordedMotionConfig::Visit(controller::SettingsVisitor& visitor) {
  visitor.Path(
      {.key = "file", .help = "a table of any format: time and channels by name", .required = true},
      file);
  visitor.Path(
      {.key = "map", .help = "column map for a file with other names or units, or a preset"}, map);
  visitor.Number({.key = "file_rate_hz",
                  .help = "rows per second of a file without a time column",
                  .min = 0,
                  .max = 100000},
                 file_rate_hz);
  visitor.Integer({.key = "skip_lines",
                   .help = "lines before the table, as a sensor's software writes them",
                   .min = 0,
                   .max = 1000},
                  skip_lines);
  controller::VisitEnum(
      visitor, {.key = "problems", .help = "stop at the first bad value, or repair and report"},
      kProblemHandlingNames, problems);
  visitor.Number({.key = "longest_gap_ms",
                  .help = "a shorter gap is filled; a longer one is a problem",
                  .min = 0,
                  .max = 1e7},
                 longest_gap_ms);
  visitor.Number(
      {.key = "start_s", .help = "where in the recording to start", .min = 0, .max = 1e9}, start_s);
  visitor.Number({.key = "duration_s",
                  .help = "how long; 0 plays it to its end",
                  .min = 0,
                  .max = kLongestMotionS},
                 duration_s);
  VisitUse(visitor, *this);
}

Motion MakeMotion(const RecordedMotionConfig& config, const MotionContext& context) {
  const RecordingFormat format = FormatOf(config, context);
  const Recording recording = Load(config, format, config.file);
  const std::size_t samples = SampleCount(config, recording, context);
  Motion motion;
  motion.remarks = recording.remarks;
  const bool is_truth = config.use == RecordingUse::kTruth;
  motion.angle_rad = AtSamplingRate(config, recording, samples, context.rate_hz,
                                    is_truth ? config.resampling() : Resampling::kCubic);
  if (!is_truth) {
    motion.measured_rad =
        AtSamplingRate(config, recording, samples, context.rate_hz, config.resampling(), true);
    if (!config.reference.empty()) {
      const Recording truth = Load(config, format, config.reference);
      motion.angle_rad =
          AtSamplingRate(config, truth, samples, context.rate_hz, Resampling::kCubic);
      motion.reference_name = "recorded reference";
      motion.remarks.insert(motion.remarks.end(), truth.remarks.begin(), truth.remarks.end());
    } else {
      for (Eigen::Index c = 0; c < motion.angle_rad.cols(); ++c) {
        SmoothZeroPhase(config.smoothing_hz, context.rate_hz,
                        {motion.angle_rad.col(c).data(), samples});
        TrimSignals();
      }
      motion.reference_name =
          fmt::format("recording smoothed at {:g} Hz, zero phase", config.smoothing_hz);
    }
  }
  KeepInRange(motion.angle_rad);
  return motion;
}

}  // namespace gauntlet::sim
