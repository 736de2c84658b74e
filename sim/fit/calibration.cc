#include "sim/fit/calibration.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <numeric>
#include <span>
#include <vector>

#include "controller/calibration/curve_fit.h"
#include "controller/calibration/noise_estimate.h"
#include "controller/calibration/robust_statistics.h"
#include "controller/number.h"
#include "sim/base/error.h"

namespace gauntlet::sim {
namespace {

using controller::CurveFit;
using controller::SettingError;
using Eigen::Index;
using Eigen::VectorXd;

/// True at an end of the converter's range, where the sensor is saturated.
bool IsClipped(const PoseRecording& recording, Index sample, Index channel) {
  return recording.converter(static_cast<std::size_t>(channel))
      .IsEnd(recording.counts(sample, channel));
}

/// Samples of one channel at one constant level.
struct LevelSamples {
  std::vector<Index> without_spikes;
  bool clipped = false;  // saturated, and not only by spikes
};

/// Splits off spikes and detects saturation. A spike is more than 5 standard deviations from the
/// median; the deviation is estimated from the median distance to the median. The level is
/// saturated if more than 1 % of the samples are at an end of the range.
LevelSamples SamplesOfLevel(const PoseRecording& recording, Index channel,
                            const std::vector<Index>& samples) {
  constexpr double kSigmas = 5.0;
  constexpr double kLeastDeviation = 0.5;  // counts
  constexpr double kMostAtAnEnd = 0.01;
  std::vector<double> values;
  for (const Index k : samples) values.push_back(recording.counts(k, channel));
  const double median = controller::MedianOf(values);
  for (double& value : values) value = std::abs(value - median);
  const double limit =
      kSigmas * std::max(controller::DeviationFromDistances(values), kLeastDeviation);
  LevelSamples level;
  Index at_an_end = 0;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (values[i] > limit) continue;
    level.without_spikes.push_back(samples[i]);
    at_an_end += IsClipped(recording, samples[i], channel);
  }
  level.clipped = static_cast<double>(at_an_end) > kMostAtAnEnd * std::ssize(samples);
  return level;
}

/// The settled samples of one channel without spikes, from poses that are not saturated.
struct Poses {
  VectorXd counts;
  VectorXd angle_deg;
  double resolution_counts = 0.0;
  std::size_t clipped = 0;  // number of saturated poses
};

Poses PosesOf(const PoseRecording& recording, Index channel) {
  std::map<double, std::vector<Index>> samples_of;  // by angle
  for (Index k = 0; k < recording.counts.rows(); ++k) {
    const double angle = recording.angle_deg(k, channel);
    if (std::isfinite(angle)) samples_of[angle].push_back(k);
  }
  Poses poses;
  poses.resolution_counts = recording.resolution_counts;
  std::vector<Index> settled;
  for (const auto& [angle, samples] : samples_of) {
    const LevelSamples level = SamplesOfLevel(recording, channel, samples);
    poses.clipped += level.clipped;
    if (level.clipped) continue;
    settled.insert(settled.end(), level.without_spikes.begin(), level.without_spikes.end());
  }
  std::ranges::sort(settled);
  poses.counts = recording.counts.col(channel)(settled);
  poses.angle_deg = recording.angle_deg.col(channel)(settled);
  return poses;
}

/// Mean counts of each pose, by its angle.
std::map<double, double> MeanCounts(const Poses& poses) {
  std::map<double, double> counts;
  std::map<double, int> samples;
  for (Index k = 0; k < poses.counts.size(); ++k) {
    counts[poses.angle_deg[k]] += poses.counts[k];
    ++samples[poses.angle_deg[k]];
  }
  for (auto& [angle, sum] : counts) sum /= samples[angle];
  return counts;
}

/// The reason why no curve can be fitted, in terms of the recording; empty if one can.
std::string ProblemOf(const PoseRecording& recording, std::size_t index, const Poses& poses,
                      CurveKind kind) {
  const std::string& channel = recording.channel_names[index];
  const controller::ConverterRange& range = recording.converter(index);
  const std::map<double, double> counts = MeanCounts(poses);
  if (counts.size() < 2) {
    const std::string clipped =
        poses.clipped == 0 ? ""
                           : fmt::format(" besides {} at {:g} or at full scale (--full-scale {:g})",
                                         poses.clipped, range.min_counts, range.full_scale_counts);
    return fmt::format(
        "has {} pose{}{}, must have at least 2; a pose is a known angle ({}_deg) that stays the "
        "same for more than {:g} ms (--settle-ms; 0 takes angles that never stand still)",
        counts.size(), counts.size() == 1 ? "" : "s", clipped, channel, recording.settle_ms);
  }
  if (kind != CurveKind::kTable) return "";
  const bool grows = counts.begin()->second < counts.rbegin()->second;
  for (auto pose = counts.begin(), next = std::next(pose); next != counts.end(); pose = next++) {
    if (grows ? pose->second < next->second : pose->second > next->second) continue;
    return fmt::format(
        "its counts do not follow its angle one way: {:.1f} counts at {:g} deg, {:.1f} at {:g} "
        "deg; "
        "check these poses, or use --linearisation two_point or polynomial",
        pose->second, pose->first, next->second, next->first);
  }
  return "";
}

/// The values of a matrix, column by column, where they are.
template <class Matrix>
std::span<const double> SpanOf(const Matrix& matrix) {
  return {matrix.data(), static_cast<std::size_t>(matrix.size())};
}

CurveFit FitCurve(const Poses& poses, CurveKind kind, int degree) {
  const std::span<const double> counts = SpanOf(poses.counts);
  const std::span<const double> angle_deg = SpanOf(poses.angle_deg);
  if (kind == CurveKind::kTable)
    return controller::FitTable(counts, angle_deg, poses.resolution_counts);
  if (kind == CurveKind::kTwoPoint)
    return controller::FitTwoPoint(counts, angle_deg, poses.resolution_counts);
  // With noise all counts differ, so the fit itself cannot detect that there are too few poses.
  const int angles = MeanCounts(poses).size();
  if (degree >= angles) {
    throw SettingError("degree", fmt::format("is {}, must be from 1 to {}, below its {} poses of "
                                             "known angle: lower it or record more poses",
                                             degree, angles - 1, angles));
  }
  return controller::FitPolynomial(counts, angle_deg, degree);
}

double RmsErrorOrNan(const Poses& poses, CurveKind kind, int degree) {
  try {
    return FitCurve(poses, kind, degree).rms_error_deg;
  } catch (const SettingError&) {
    return kNaN;
  }
}

std::vector<double> OnlyIfFinite(const std::vector<double>& values) {
  const bool finite = std::ranges::all_of(values, [](double v) { return std::isfinite(v); });
  return finite ? values : std::vector<double>();
}

void FitCurves(const PoseRecording& recording, const CalibrationOptions& options,
               Calibration& calibration, CurveErrors& errors) {
  if (recording.angle_deg.cols() == 0) return;
  calibration.linearisation.kind = options.curve == CurveKind::kPolynomial
                                       ? controller::LinearisationKind::kPolynomial
                                       : controller::LinearisationKind::kTable;
  for (std::size_t i = 0; i < recording.channel_names.size(); ++i) {
    const Poses poses = PosesOf(recording, i);
    const std::string& name = recording.channel_names[i];
    const std::string problem = ProblemOf(recording, i, poses, options.curve);
    if (!problem.empty())
      throw UserError({.place = recording.name, .key = name, .problem = problem});
    CurveFit fit;
    try {
      fit = FitCurve(poses, options.curve, options.degree);
    } catch (const SettingError& error) {
      const bool degree = error.key() == "degree";
      const bool bent = !degree && options.curve == CurveKind::kPolynomial;
      throw UserError({.place = recording.name,
                       .key = name,
                       .problem = fmt::format("{}{}{}", degree ? "--degree " : "", error.problem(),
                                              bent ? "; lower --degree" : "")});
    }
    fit.curve.channel = name;
    ChannelCalibration& channel = calibration.channels[i];
    channel.rms_error_deg = fit.rms_error_deg;
    channel.largest_error_deg = fit.largest_error_deg;
    channel.half_width_95_deg = OnlyIfFinite(fit.half_width_95_deg);
    calibration.linearisation.channels.push_back(std::move(fit.curve));
    const auto rms = [&](CurveKind kind) { return RmsErrorOrNan(poses, kind, options.degree); };
    errors.two_point_rms_deg.push_back(rms(CurveKind::kTwoPoint));
    errors.polynomial_rms_deg.push_back(rms(CurveKind::kPolynomial));
    errors.table_rms_deg.push_back(rms(CurveKind::kTable));
  }
}

/// Value rounded to six digits, more than the accuracy of an estimate.
double Short(double value) {
  return controller::ParseNumber(controller::NumberText(value)).value_or(value);
}

/// A row of a square matrix that is given row by row.
std::vector<double> RowOf(std::span<const double> matrix, std::size_t row, std::size_t size) {
  std::vector<double> values;
  for (const double value : matrix.subspan(row * size, size)) values.push_back(Short(value));
  return values;
}

/// Still stretches in which no channel is saturated. Saturation would cut off noise.
std::vector<controller::StillStretch> StretchesInRange(const PoseRecording& recording) {
  std::vector<controller::StillStretch> stretches = recording.still;
  if (stretches.empty()) {
    stretches = controller::FindStillStretches(
        SpanOf(recording.counts), static_cast<int>(recording.counts.cols()), recording.rate_hz);
  }
  if (stretches.empty()) {
    throw UserError({.place = recording.name,
                     .problem =
                         "the hand never holds still for half a second, R cannot be "
                         "estimated: record it at rest for a second or more, or say where it is "
                         "still (--still 2:5)"});
  }
  Index at_the_end = 0;  // a channel that is saturated in a stretch
  std::erase_if(stretches, [&](const controller::StillStretch& stretch) {
    std::vector<Index> samples(static_cast<std::size_t>(stretch.end - stretch.begin));
    std::iota(samples.begin(), samples.end(), stretch.begin);
    for (Index c = 0; c < recording.counts.cols(); ++c) {
      if (!SamplesOfLevel(recording, c, samples).clipped) continue;
      at_the_end = c;
      return true;
    }
    return false;
  });
  if (stretches.empty()) {
    throw UserError({.place = recording.name,
                     .key = recording.channel_names[at_the_end],
                     .problem = fmt::format(
                         "is at {:g} or at full scale whenever the hand holds still: R cannot be "
                         "estimated",
                         recording.converter(at_the_end).min_counts)});
  }
  return stretches;
}

void EstimateR(const PoseRecording& recording, Calibration& calibration) {
  const controller::NoiseEstimate noise =
      controller::EstimateNoise(SpanOf(recording.counts), static_cast<int>(recording.counts.cols()),
                                StretchesInRange(recording),
                                {.confidence = 0.01 * calibration.confidence_percent,
                                 .resolution_counts = calibration.resolution_counts});
  calibration.degrees_of_freedom = noise.degrees_of_freedom;
  for (std::size_t i = 0; i < calibration.channels.size(); ++i) {
    ChannelCalibration& channel = calibration.channels[i];
    channel.variance_counts2 = Short(noise.variance[i]);
    channel.variance_low_counts2 = Short(noise.variance_low[i]);
    channel.variance_high_counts2 = Short(noise.variance_high[i]);
    channel.hidden_by_rounding = noise.rounded[i];
    channel.spikes = static_cast<int>(noise.spikes[i]);
    channel.neighbour_correlation = Short(noise.correlation[i]);
    channel.covariance_counts2 = RowOf(noise.covariance, i, calibration.channels.size());
    channel.covariance_low_counts2 = RowOf(noise.covariance_low, i, calibration.channels.size());
    channel.covariance_high_counts2 = RowOf(noise.covariance_high, i, calibration.channels.size());
  }
}

}  // namespace

Calibration Calibrate(const PoseRecording& recording, const CalibrationOptions& options,
                      CurveErrors& errors) {
  Calibration calibration;
  calibration.recording = std::filesystem::path(recording.name).filename().string();
  calibration.samples = recording.counts.rows();
  calibration.rate_hz = recording.rate_hz;
  calibration.confidence_percent = options.confidence_percent;
  calibration.resolution_counts = recording.resolution_counts;
  calibration.channels.resize(recording.channel_names.size());
  for (std::size_t i = 0; i < calibration.channels.size(); ++i) {
    calibration.channels[i].channel = recording.channel_names[i];
  }
  FitCurves(recording, options, calibration, errors);
  EstimateR(recording, calibration);
  return calibration;
}

}  // namespace gauntlet::sim
