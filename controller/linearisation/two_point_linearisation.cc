#include "controller/linearisation/two_point_linearisation.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <string>

#include "controller/filters/vectorise.h"

namespace gauntlet::controller {
namespace {

/// to = target_origin + (from - source_origin) slope, of all samples.
GAUNTLET_VECTORISED void MapLine(const double* from, const double* source_origin,
                                 const double* slope, const double* target_origin, double* to,
                                 std::size_t values, std::size_t channels) {
  for (std::size_t at = 0; at < values; at += channels) {
    GAUNTLET_CHANNEL_LOOP
    for (std::size_t i = 0; i < channels; ++i) {
      to[at + i] = target_origin[i] + (from[at + i] - source_origin[i]) * slope[i];
    }
  }
}

/// Why the two poses of a channel make no line; empty if they do.
std::string ProblemOfPoses(const GloveCalibration& glove, std::size_t channel) {
  const double low = glove.low_counts[channel];
  const double high = glove.high_counts[channel];
  const double turn_rad = glove.high_angle_rad[channel] - glove.low_angle_rad[channel];
  if (!std::isfinite(turn_rad) || turn_rad == 0.0 || !std::isfinite(1.0 / turn_rad)) {
    return "the two poses must differ in angle, and be finite";
  }
  for (const double counts : {low, high}) {
    if (counts >= 0.0 && counts <= glove.full_scale_counts) continue;
    return "a pose is at " + NumberText(counts) +
           " counts, must be within the converter's range, " + "0 to " +
           NumberText(glove.full_scale_counts);
  }
  // Each pose is known to half a count: that is an error of a tenth in all angles.
  const double least = std::min(10.0, 0.01 * glove.full_scale_counts);
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
    for (Eigen::Index i = 0; i < low_counts_.size(); ++i) {
      const auto channel = static_cast<std::size_t>(i);
      const std::string problem = ProblemOfPoses(calibration, channel);
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
    MapLine(counts.data(), low_counts_.data(), rad_per_count_.data(), low_angle_rad_.data(),
            angle_rad.data(), counts.size(), channels());
  }
  void ToCounts(std::span<const double> angle_rad,
                std::span<double> counts) const noexcept override {
    MapLine(angle_rad.data(), low_angle_rad_.data(), counts_per_rad_.data(), low_counts_.data(),
            counts.data(), angle_rad.size(), channels());
  }

 private:
  std::size_t channels() const { return static_cast<std::size_t>(low_counts_.size()); }
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
