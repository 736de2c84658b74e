#include "sim/glove/motions/recorded_motion.h"

#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <iterator>
#include <string>
#include <utility>
#include <vector>

#include "sim/base/channels.h"
#include "sim/base/error.h"
#include "sim/glove/motions/postures.h"
#include "sim/glove/motions/recording_mask.h"
#include "sim/glove/motions/settings_of_motions.h"
#include "sim/glove/sensor/bend_sensor.h"
#include "sim/recordings/recording.h"
#include "sim/recordings/table_source.h"

namespace gauntlet::sim {
namespace {

constexpr double kSearchRate_hz = 100.0;  // hands move below 10 Hz
constexpr double kLargestOffset_s = 10.0;
constexpr double kLongestCompared_s = 60.0;
constexpr double kLeastCorrelation = 0.5;

/// Common channels at the search's rate, from start_s on, a column each.
Eigen::MatrixXd Sampled(const Recording& recording, const std::vector<Eigen::Index>& channels,
                        double start_s, Eigen::Index samples) {
  Eigen::MatrixXd values(samples, std::ssize(channels));
  for (std::size_t i = 0; i < channels.size(); ++i) {
    const std::vector<double> column =
        Resample(recording, channels[i], start_s, kSearchRate_hz, samples, 1.0).value;
    values.col(static_cast<Eigen::Index>(i)) =
        Eigen::Map<const Eigen::VectorXd>(column.data(), samples);
  }
  return values;
}

/// By how much later the same moment is in `reference` than in `recording` [s]: the lag of the
/// largest correlation of all channels that both have, within 10 s to both sides, of the first
/// minute of the stretch.
///
///     argmax over d of  sum (x_c(t) - mean) (y_c(t + d) - mean) / sqrt(sum (..)^2 sum (..)^2)
///
/// at 100 Hz, refined by a parabola. Errors: UserError about `reference` where no correlation is
/// above 0.5, or the largest lies at the bound.
double FindReferenceOffset(const Recording& recording, const Recording& reference,
                           const PlayedStretch& stretch) {
  std::vector<Eigen::Index> common;
  for (std::size_t c = 0; c < recording.has_channel.size(); ++c) {
    if (recording.has_channel[c] && reference.has_channel[c]) {
      common.push_back(static_cast<Eigen::Index>(c));
    }
  }
  if (common.empty()) {
    throw UserError({.place = reference.name,
                     .problem = "has no channel of the recording: no offset can be found"});
  }
  const double length_s = static_cast<double>(stretch.ticks) / stretch.rate_hz;
  const auto compared =
      static_cast<Eigen::Index>(std::min(length_s, kLongestCompared_s) * kSearchRate_hz);
  const auto bound = static_cast<Eigen::Index>(kLargestOffset_s * kSearchRate_hz);
  const Eigen::MatrixXd x = Sampled(recording, common, stretch.start_s, compared);
  const Eigen::MatrixXd y =
      Sampled(reference, common, stretch.start_s - kLargestOffset_s, compared + 2 * bound);
  const Eigen::MatrixXd centred = x.rowwise() - x.colwise().mean();
  std::vector<double> correlations;
  for (Eigen::Index lag = 0; lag <= 2 * bound; ++lag) {
    const auto part = y.middleRows(lag, compared);
    const Eigen::MatrixXd other = part.rowwise() - part.colwise().mean();
    const double size = std::sqrt(centred.squaredNorm() * other.squaredNorm());
    correlations.push_back(size > 0.0 ? centred.cwiseProduct(other).sum() / size : 0.0);
  }
  const auto peak = std::ranges::max_element(correlations);
  if (!(*peak > kLeastCorrelation) || peak == correlations.begin() ||
      peak + 1 == correlations.end()) {
    throw UserError({.place = reference.name,
                     .problem = fmt::format("no offset to the recording within {:g} s can be found "
                                            "(largest correlation {:.2f}); give reference_offset_s",
                                            kLargestOffset_s, *peak)});
  }
  const double curvature = peak[-1] - 2.0 * peak[0] + peak[1];
  const double beside = curvature < 0.0 ? 0.5 * (peak[-1] - peak[1]) / curvature : 0.0;
  const auto lag = static_cast<double>(peak - correlations.begin() - bound);
  return (lag + beside) / kSearchRate_hz;
}

/// Refuses a reference that does not cover the stretch, but for a gap at its ends that would be
/// filled anywhere else. `stretch` is in the reference's own time. Errors: UserError.
void CheckReferenceCovers(const Recording& reference, const PlayedStretch& stretch, double gap_s) {
  const double end_s = stretch.start_s + static_cast<double>(stretch.ticks - 1) / stretch.rate_hz;
  if (reference.time_s.front() <= stretch.start_s + gap_s &&
      reference.time_s.back() >= end_s - gap_s) {
    return;
  }
  throw UserError(
      {.place = reference.name,
       .problem = fmt::format(
           "the reference has {:.3f} to {:.3f} s, the recording's stretch needs {:.3f} to {:.3f} s "
           "of it: give start_s and duration_s, or reference_offset_s",
           reference.time_s.front(), reference.time_s.back(), stretch.start_s, end_s)});
}

constexpr std::array<std::string_view, 2> kUseNames = {"truth", "measured"};
constexpr std::array<std::string_view, 2> kOffsetNames = {"given", "auto"};

RecordingFormat FormatOf(const RecordedMotionConfig& config, const MotionContext& context) {
  RecordingFormat format;
  format.map = config.map;
  format.array = config.array;
  format.rate_hz = config.file_rate_hz;
  format.skipped_lines = config.skip_lines;
  format.handling = config.problems;
  format.longest_gap_ms = config.longest_gap_ms;
  format.repair_budget_percent = config.repair_budget_percent;
  format.nominal = NominalCountsOf(context.converter);
  return format;
}

Recording Load(const RecordedMotionConfig& config, const RecordingFormat& format,
               const std::string& file, double start_s) {
  // Reading ends where no motion goes, so that memory does not grow with the file.
  const double duration_s = config.duration_s > 0.0 ? config.duration_s : kLongestMotionS + 1.0;
  return LoadRecording(file, format, start_s, duration_s);
}

/// The stretch at the sampling rate; channels that the recording lacks hold the posture `rest`.
/// Samples in long gaps of the recording are made like all others, and `masked`.
Signal AtSamplingRate(const RecordedMotionConfig& config, const Recording& recording,
                      const PlayedStretch& stretch, Resampling how,
                      std::vector<MaskedStretch>& masked) {
  const std::vector<double> rest = PostureAngles(0);
  Signal angle_rad(static_cast<Eigen::Index>(stretch.ticks), std::ssize(rest));
  for (int channel = 0; channel < std::ssize(rest); ++channel) {
    auto column = angle_rad.col(channel);
    if (!recording.has_channel[channel]) {
      column.setConstant(rest[channel]);
      continue;
    }
    const Resampled resampled = Resample(recording, channel, stretch.start_s, stretch.rate_hz,
                                         stretch.ticks, 1e-3 * config.longest_gap_ms, how);
    std::ranges::copy(resampled.value, column.begin());
    AddGapsAndRestarts(recording, channel, stretch, resampled.mask, masked);
    TrimSignals();
  }
  return angle_rad;
}

/// Puts glitches into the recording, or takes them out again.
void SwapGlitches(Recording& recording) {
  for (WildValue& wild : recording.wild) {
    std::swap(wild.angle_rad, recording.angle_rad(wild.row, wild.channel));
  }
}

/// In a gap the glove says nothing.
void LeaveOutGaps(const std::vector<MaskedStretch>& masked, Signal& angle_rad) {
  for (const MaskedStretch& stretch : masked) {
    if (stretch.reason != MaskReason::kGap) continue;
    angle_rad.col(stretch.channel)
        .segment(stretch.begin, stretch.end - stretch.begin)
        .setConstant(kNaN);
    TrimSignals();
  }
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

/// Use of the recording, and the settings that depend on it.
void VisitUse(controller::SettingsVisitor& visitor, RecordedMotionConfig& config) {
  controller::VisitEnum(visitor, {"use", "the wearer's true motion, or what a real glove measured"},
                        kUseNames, config.use);
  Resampling how = config.resampling();
  controller::VisitEnum(visitor,
                        {"resample",
                         "between two rows of the file: hold, the newest row, as a fast loop reads "
                         "a slow glove; cubic, shape-preserving interpolation. Default: hold for "
                         "use: measured, cubic for truth; a reference is always cubic"},
                        kResamplingNames, how);
  if (how != config.resampling()) config.resample = how;
  if (config.use == RecordingUse::kTruth) return;
  visitor.Path({"reference", "recording of the reference at the same times, if any"},
               config.reference);
  visitor.Path({"reference_map", "column map of the reference; by default as map"},
               config.reference_map);
  visitor.Text({"reference_array",
                "array of the reference, if it is a file with arrays; by default as array"},
               config.reference_array);
  visitor.Number(
      {"reference_rate_hz",
       "rows per second of a reference without a time column; 0: as file_rate_hz", 0, 100000},
      config.reference_rate_hz);
  controller::VisitEnum(visitor,
                        {"reference_offset",
                         "how the times of both files fit: given, by reference_offset_s; auto, "
                         "found by correlation within 10 s"},
                        kOffsetNames, config.reference_offset);
  visitor.Number({"reference_offset_s",
                  "by how much later the same moment is in the reference than in the recording, "
                  "each counted from its first row",
                  -1e6, 1e6},
                 config.reference_offset_s);
  visitor.Number({"smoothing_hz",
                  "without one the reference is the recording, smoothed at this cut-off", 0.1, 20},
                 config.smoothing_hz);
}

}  // namespace

void RecordedMotionConfig::Visit(controller::SettingsVisitor& visitor) {
  visitor.Path(
      {.key = "file",
       .help = "a table of any format: time and channels by name; in its place files, a list or a "
               "folder, whose recordings are the replicates of a comparison",
       .required = true},
      file);
  visitor.Path({"map", "column map for a file with other names or units, or a preset"}, map);
  visitor.Text({"array",
                "of a file with arrays: the name of the one to take, or of a group of them; by "
                "default those of the number of rows that holds the most values, those of an "
                "inertial sensor last; of MCAP or a ROS "
                "2 bag: the topic"},
               array);
  visitor.Number({"file_rate_hz", "rows per second of a file without a time column", 0, 100000},
                 file_rate_hz);
  visitor.Integer(
      {"skip_lines", "lines before the table, as a sensor's software writes them", 0, 1000},
      skip_lines);
  controller::VisitEnum(visitor,
                        {"problems",
                         "strict stops at the first bad value; repair reports all and leaves "
                         "glitches out of the reference alone; remove leaves them out of the "
                         "glove's signal, too, with knowledge of later values"},
                        kProblemHandlingNames, problems);
  visitor.Number({"longest_gap_ms", "a shorter gap is filled; a longer one is a problem", 0, 1e7},
                 longest_gap_ms);
  visitor.Number(
      {"repair_budget_percent",
       "rows that may need a repair; with more the file is refused, with the likeliest cause", 0,
       100},
      repair_budget_percent);
  visitor.Number({"start_s", "where in the recording to start", 0, 1e9}, start_s);
  visitor.Number({"duration_s", "how long; 0 plays it to its end", 0, kLongestMotionS}, duration_s);
  VisitUse(visitor, *this);
}

namespace {

/// The wearer's true angles from a recording of their own, at the moments of the stretch.
void LoadReference(const RecordedMotionConfig& config, const RecordingFormat& recording_format,
                   const Recording& recording, const PlayedStretch& stretch, Motion& motion) {
  constexpr double kSearched_s = 10.0;
  RecordingFormat format = recording_format;
  if (!config.reference_map.empty()) format.map = config.reference_map;
  if (!config.reference_array.empty()) format.array = config.reference_array;
  if (config.reference_rate_hz > 0.0) format.rate_hz = config.reference_rate_hz;
  const bool is_given = config.reference_offset == ReferenceOffset::kGiven;
  RecordedMotionConfig wider = config;
  if (!is_given && config.duration_s > 0.0) wider.duration_s += 2.0 * kSearched_s;
  const double first_s = stretch.start_s + (is_given ? config.reference_offset_s : -kSearched_s);
  const Recording truth = Load(wider, format, config.reference, std::max(0.0, first_s));
  PlayedStretch shifted = stretch;
  if (is_given) {
    shifted.start_s += config.reference_offset_s;
  } else {
    const double offset_s = FindReferenceOffset(recording, truth, stretch);
    shifted.start_s += offset_s;
    motion.remarks.push_back(
        fmt::format("{}: found {:.3f} s later than in the recording", truth.name, offset_s));
  }
  CheckReferenceCovers(truth, shifted, 1e-3 * config.longest_gap_ms);
  motion.angle_rad = AtSamplingRate(config, truth, shifted, Resampling::kCubic, motion.masked);
  for (int channel = 0; channel < std::ssize(truth.has_channel); ++channel) {
    if (!recording.has_channel[channel] || truth.has_channel[channel]) continue;
    motion.masked.push_back({MaskReason::kGap, channel, 0, static_cast<int>(stretch.ticks)});
    motion.remarks.push_back(fmt::format("{}: has no {}, whose following is not known", truth.name,
                                         KnownChannels()[channel].name));
  }
  motion.reference_name = "recorded reference";
  motion.remarks.insert(motion.remarks.end(), truth.remarks.begin(), truth.remarks.end());
}

/// Refuses rows that are not those of the recording that is played. Errors: UserError.
void CheckHasRowsOf(const Recording& played, const Recording& recording) {
  constexpr double kShareOfRow = 0.25;
  const double row_s = (played.time_s.back() - played.time_s.front()) /
                       static_cast<double>(played.time_s.size() - 1);
  for (const double time_s : played.time_s) {
    const auto next = std::ranges::lower_bound(recording.time_s, time_s - kShareOfRow * row_s);
    if (next != recording.time_s.end() && *next <= time_s + kShareOfRow * row_s) continue;
    throw UserError(
        {.place = recording.name,
         .problem = fmt::format("has no row at {:.3f} s, where {} has one: must have the same rows "
                                "[{:.3f} to {:.3f} s from the first]",
                                time_s, played.name, played.time_s.front(), played.time_s.back())});
  }
}

/// The angles that the glove said in the stretch: glitches as they came, nothing in gaps.
Signal MeasuredAngles(const RecordedMotionConfig& config, const PlayedStretch& stretch,
                      Recording& recording, std::vector<MaskedStretch>& masked) {
  const bool has_glitches = config.problems == ProblemHandling::kRepair && !recording.wild.empty();
  if (has_glitches) SwapGlitches(recording);
  Signal measured_rad = AtSamplingRate(config, recording, stretch, config.resampling(), masked);
  if (has_glitches) SwapGlitches(recording);
  LeaveOutGaps(masked, measured_rad);
  return measured_rad;
}

}  // namespace

Motion MeasuredAgain(const RecordedMotionConfig& config, const std::string& file,
                     const std::string& map, const Recording& played,
                     const MotionContext& context) {
  RecordingFormat format = FormatOf(config, context);
  if (!map.empty()) format.map = map;
  const auto loaded = std::make_shared<Recording>(Load(config, format, file, config.start_s));
  CheckHasRowsOf(played, *loaded);
  const PlayedStretch stretch{.start_s = config.start_s,
                              .rate_hz = context.rate_hz,
                              .ticks = SampleCount(config, played, context)};
  Motion motion;
  motion.recording = loaded;
  motion.measured_rad = MeasuredAngles(config, stretch, *loaded, motion.masked);
  return motion;
}

ColumnMap ReadMapOf(const RecordedMotionConfig& config) {
  std::error_code none;
  if (!std::filesystem::is_regular_file(config.file, none)) {  // a pipe can be read once
    throw UserError({.place = config.file, .problem = "no such file"});
  }
  const CsvReader recording(config.file, TableSource(config.file, config.array), config.problems,
                            {}, config.skip_lines);
  if (!config.map.empty()) return ReadColumnMap(config.map, recording);
  std::vector<std::string> left_out;
  return MapByHeader(recording, config.problems, left_out);
}

Motion MakeMotion(const RecordedMotionConfig& config, const MotionContext& context) {
  const RecordingFormat format = FormatOf(config, context);
  const auto loaded =
      std::make_shared<Recording>(Load(config, format, config.file, config.start_s));
  const Recording& recording = *loaded;
  const PlayedStretch stretch{.start_s = config.start_s,
                              .rate_hz = context.rate_hz,
                              .ticks = SampleCount(config, recording, context)};
  Motion motion;
  motion.recording = loaded;
  motion.recording_start_s = config.start_s;
  motion.remarks = recording.remarks;
  if (config.use == RecordingUse::kTruth) {
    motion.angle_rad =
        AtSamplingRate(config, recording, stretch, config.resampling(), motion.masked);
    KeepInRange(motion.angle_rad);
    return motion;
  }
  const bool glove_has_glitches =
      config.problems == ProblemHandling::kRepair && !recording.wild.empty();
  motion.measured_rad = MeasuredAngles(config, stretch, *loaded, motion.masked);
  if (!config.reference.empty()) {
    LoadReference(config, format, recording, stretch, motion);
  } else {
    std::vector<MaskedStretch> unknown;
    motion.angle_rad = AtSamplingRate(config, recording, stretch, Resampling::kCubic, unknown);
    // Other gaps are those of the glove itself, which are masked already.
    if (glove_has_glitches) std::ranges::copy(unknown, std::back_inserter(motion.masked));
    for (int channel = 0; channel < motion.angle_rad.cols(); ++channel) {
      SmoothBetween(motion.masked, channel, config.smoothing_hz, context.rate_hz,
                    {motion.angle_rad.col(channel).data(), stretch.ticks});
      TrimSignals();
    }
    motion.reference_name =
        fmt::format("recording smoothed at {:g} Hz, zero phase", config.smoothing_hz);
  }
  for (int channel = 0; channel < std::ssize(recording.has_channel); ++channel) {
    if (recording.has_channel[channel]) AddClipped(recording, channel, stretch, motion.masked);
    TrimSignals();
  }
  KeepInRange(motion.angle_rad);
  return motion;
}

}  // namespace gauntlet::sim
