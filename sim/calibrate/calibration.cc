#include "sim/calibrate/calibration.h"

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

/// Index of each named channel in the calibration.
std::vector<std::size_t> PlacesOf(const Calibration& calibration,
                                  const std::vector<std::string>& channel_names) {
  std::vector<std::size_t> places;
  for (const std::string& name : channel_names) {
    const auto found = std::ranges::find(calibration.channels, name, &ChannelCalibration::channel);
    if (found == calibration.channels.end()) {
      throw SettingError("calibration", "has nothing for channel " + name);
    }
    places.push_back(found - calibration.channels.begin());
  }
  return places;
}

/// R of the channels at `places`, row by row. Quantisation is noise too: it bounds the variances on
/// the diagonal from below.
std::vector<double> CovarianceOf(const Calibration& calibration,
                                 const std::vector<std::size_t>& places) {
  const double rounding = calibration.resolution_counts * calibration.resolution_counts / 12.0;
  std::vector<double> covariance;
  for (const std::size_t row : places) {
    const std::vector<double>& values = calibration.channels[row].covariance_counts2;
    if (values.size() != calibration.channels.size()) {
      throw SettingError("calibration",
                         fmt::format("channels[{}].covariance_counts2: has {} "
                                     "values, must have {}, one per channel",
                                     row, values.size(), calibration.channels.size()));
    }
    for (const std::size_t column : places) {
      covariance.push_back(row == column ? std::max(values[column], rounding) : values[column]);
    }
  }
  return covariance;
}

std::vector<double> DiagonalOf(const std::vector<double>& covariance, std::size_t size) {
  std::vector<double> diagonal;
  for (std::size_t i = 0; i < size; ++i) diagonal.push_back(covariance[i * size + i]);
  return diagonal;
}

controller::ChannelCurve CurveOf(const Calibration& calibration, const std::string& channel) {
  for (const controller::ChannelCurve& curve : calibration.linearisation.channels) {
    if (curve.channel == channel) return curve;
  }
  throw SettingError("calibration", "linearisation.channels has no curve for channel " + channel);
}

}  // namespace

void ChannelCalibration::Visit(controller::SettingsVisitor& visitor) {
  visitor.Text({.key = "channel", .help = "name of the channel", .required = true}, channel);
  visitor.Number({"rms_error_deg", "of the curve on the settled samples", 0}, rms_error_deg);
  visitor.Number({"largest_error_deg", "of the curve on a settled sample", 0}, largest_error_deg);
  visitor.Numbers(
      {"half_width_95_deg", "half of the 95 % interval of each angle or coefficient of the curve"},
      half_width_95_deg);
  visitor.Number({"variance_counts2", "R of the channel", 0}, variance_counts2);
  visitor.Number({"variance_low_counts2", "lower end of its confidence interval"},
                 variance_low_counts2);
  visitor.Number({"variance_high_counts2", "upper end of its confidence interval"},
                 variance_high_counts2);
  visitor.Flag(
      {"hidden_by_rounding", "noise below 0.7 counts: R is the most likely one, its interval wide"},
      hidden_by_rounding);
  visitor.Integer({"spikes", "samples left out of R", 0}, spikes);
  visitor.Number({"neighbour_correlation", "of samples that follow each other; 0 is white noise"},
                 neighbour_correlation);
  visitor.Numbers({.key = "covariance_counts2",
                   .help = "row of the full R: with every channel, in the order of this list",
                   .required = true},
                  covariance_counts2);
  visitor.Numbers({"covariance_low_counts2", "lower ends of the intervals"},
                  covariance_low_counts2);
  visitor.Numbers({"covariance_high_counts2", "upper ends of the intervals"},
                  covariance_high_counts2);
}

void Calibration::Visit(controller::SettingsVisitor& visitor) {
  visitor.Text({"recording", "what it was made from"}, recording);
  visitor.Integer({"samples", "of the recording", 0}, samples);
  visitor.Number({.key = "rate_hz", .help = "samples per second", .min = 0, .open_range = true},
                 rate_hz);
  visitor.Number({.key = "confidence_percent",
                  .help = "of the intervals of R",
                  .min = 0,
                  .max = 100,
                  .open_range = true},
                 confidence_percent);
  visitor.Number({"resolution_counts", "steps of the recorded values", 0}, resolution_counts);
  visitor.Number({"degrees_of_freedom", "still samples less still stretches, the weight of R", 0},
                 degrees_of_freedom);
  controller::VisitGroup(visitor, {"linearisation", "the curves; kind glove if it has none"},
                         linearisation);
  controller::VisitList(visitor, {"channels", "how good curves are; R"}, channels);
}

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

void UseCalibration(const Calibration& calibration, const std::vector<std::string>& channel_names,
                    bool take_linearisation, const std::vector<bool>& take_r,
                    controller::ControllerConfig& config) {
  const std::vector<std::size_t> places = PlacesOf(calibration, channel_names);
  if (take_linearisation &&
      calibration.linearisation.kind != controller::LinearisationKind::kGlove) {
    config.linearisation.kind = calibration.linearisation.kind;
    config.linearisation.channels.clear();
    for (const std::string& name : channel_names) {
      config.linearisation.channels.push_back(CurveOf(calibration, name));
    }
  }
  const std::vector<double> covariance = CovarianceOf(calibration, places);
  const auto set_r = [&](std::vector<double>& r, bool full) {
    if (config.filter_on == controller::FilterOn::kAngle) {
      throw SettingError("calibration",
                         "gives r in counts^2, but filter_on is angle: give the filter its own r, "
                         "in rad^2");
    }
    r = full ? covariance : DiagonalOf(covariance, channel_names.size());
  };
  for (std::size_t i = 0; i < config.filters.size(); ++i) {
    if (!take_r[i]) continue;
    std::visit(
        [&](auto& settings) {
          if constexpr (requires { settings.noise.r; }) set_r(settings.noise.r, false);
          if constexpr (requires { settings.r; }) set_r(settings.r, true);
        },
        config.filters[i].settings);
  }
}

}  // namespace gauntlet::sim
