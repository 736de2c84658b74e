#include "controller/linearisation/two_point_linearisation.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "controller/assert.h"
#include "controller/filters/vectorise.h"

namespace gauntlet::controller {
namespace {

/// to = target_origin + (from - source_origin) slope, per channel.
struct Lines {
  const double *source_origin, *slope, *target_origin;
};

GAUNTLET_VECTORISED void MapLines(const Lines& lines, const double* from, double* to,
                                  int channel_count, int samples) {
  const auto [source_origin, slope, target_origin] = lines;
  for (; samples > 0; --samples, from += channel_count, to += channel_count) {
    GAUNTLET_CHANNEL_LOOP
    for (int i = 0; i < channel_count; ++i) {
      to[i] = target_origin[i] + (from[i] - source_origin[i]) * slope[i];
    }
  }
}

/// Why the two poses of a channel make no line; empty if they do.
std::string ProblemOfPoses(const GloveCalibration& glove, const ConverterRange& range,
                           std::size_t channel) {
  const double low = glove.low_counts[channel];
  const double high = glove.high_counts[channel];
  const double turn_rad = glove.high_angle_rad[channel] - glove.low_angle_rad[channel];
  if (!std::isfinite(turn_rad) || turn_rad == 0.0 || !std::isfinite(1.0 / turn_rad)) {
    return "the two poses must differ in angle, and be finite";
  }
  for (const double counts : {low, high}) {
    if (range.Contains(counts)) continue;
    return "a pose is at " + NumberText(counts) +
           " counts, must be within the converter's range, " + NumberText(range.min_counts) +
           " to " + NumberText(range.full_scale_counts);
  }
  // Each pose is known to half a count: that is an error of a tenth in all angles.
  const double least = std::min(10.0, 0.01 * range.span_counts());
  if (std::abs(high - low) >= least) return "";
  return "the two poses are " + NumberText(std::abs(high - low)) +
         " counts apart, must be at least " + NumberText(least) +
         ", or rounding to whole counts decides the angles";
}

class TwoPointLinearisation final : public Linearisation {
 public:
  explicit TwoPointLinearisation(const GloveCalibration& calibration)
      : low_counts_(ToArray(calibration.low_counts)),
        low_angle_rad_(ToArray(calibration.low_angle_rad)) {
    const Eigen::ArrayXd span_counts = ToArray(calibration.high_counts) - low_counts_;
    const Eigen::ArrayXd span_rad = ToArray(calibration.high_angle_rad) - low_angle_rad_;
    rad_per_count_ = span_rad / span_counts;
    counts_per_rad_ = span_counts / span_rad;
    const std::vector<ConverterRange> converters = ConvertersOf(calibration);
    for (Eigen::Index i = 0; i < low_counts_.size(); ++i) {
      const auto channel = static_cast<std::size_t>(i);
      const std::string problem = ProblemOfPoses(calibration, converters[channel], channel);
      if (problem.empty()) continue;
      const auto& names = calibration.channel_names;
      const bool named = channel < names.size();
      throw SettingError("calibration", "channel " + (named ? names[channel] : std::to_string(i)) +
                                            ": " + problem);
    }
  }

  int channel_count() const noexcept override { return low_counts_.size(); }
  void ToAngles(std::span<const double> counts,
                std::span<double> angle_rad) const noexcept override {
    GAUNTLET_ASSERT(angle_rad.size() == counts.size() && std::ssize(counts) % channel_count() == 0);
    MapLines({.source_origin = low_counts_.data(),
              .slope = rad_per_count_.data(),
              .target_origin = low_angle_rad_.data()},
             counts.data(), angle_rad.data(), channel_count(), SamplesIn(counts));
  }
  void ToCounts(std::span<const double> angle_rad,
                std::span<double> counts) const noexcept override {
    GAUNTLET_ASSERT(counts.size() == angle_rad.size() && std::ssize(counts) % channel_count() == 0);
    MapLines({.source_origin = low_angle_rad_.data(),
              .slope = counts_per_rad_.data(),
              .target_origin = low_counts_.data()},
             angle_rad.data(), counts.data(), channel_count(), SamplesIn(angle_rad));
  }

 private:
  int SamplesIn(std::span<const double> values) const {
    return static_cast<int>(std::ssize(values) / channel_count());
  }
  static Eigen::ArrayXd ToArray(const std::vector<double>& values) {
    return Eigen::Map<const Eigen::ArrayXd>(values.data(), values.size());
  }

  Eigen::ArrayXd low_counts_;
  Eigen::ArrayXd low_angle_rad_;
  Eigen::ArrayXd rad_per_count_;
  Eigen::ArrayXd counts_per_rad_;
};

}  // namespace

std::unique_ptr<Linearisation> MakeTwoPointLinearisation(const GloveCalibration& calibration) {
  return std::make_unique<TwoPointLinearisation>(calibration);
}

}  // namespace gauntlet::controller
