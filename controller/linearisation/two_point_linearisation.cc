#include "controller/linearisation/two_point_linearisation.h"

#include <Eigen/Core>
#include <cmath>
#include <string>

#include "controller/filters/vectorise.h"

namespace gauntlet::controller {
namespace {

/// to = target_origin + (from - source_origin) slope.
GAUNTLET_VECTORISED void MapLine(const double* from, const double* source_origin,
                                 const double* slope, const double* target_origin, double* to,
                                 long count) {
  GAUNTLET_CHANNEL_LOOP
  for (long i = 0; i < count; ++i) {
    to[i] = target_origin[i] + (from[i] - source_origin[i]) * slope[i];
  }
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
      if (std::isfinite(rad_per_count_[i]) && std::isfinite(counts_per_rad_[i])) continue;
      const auto channel = static_cast<std::size_t>(i);
      const auto& names = calibration.channel_names;
      throw SettingError("calibration",
                         "channel " +
                             (channel < names.size() ? names[channel] : std::to_string(i)) +
                             ": the two poses must differ in counts and in angle, and be finite");
    }
  }

  int channel_count() const noexcept override { return low_counts_.size(); }
  void ToAngles(std::span<const double> counts,
                std::span<double> angle_rad) const noexcept override {
    MapLine(counts.data(), low_counts_.data(), rad_per_count_.data(), low_angle_rad_.data(),
            angle_rad.data(), low_counts_.size());
  }
  void ToCounts(std::span<const double> angle_rad,
                std::span<double> counts) const noexcept override {
    MapLine(angle_rad.data(), low_angle_rad_.data(), counts_per_rad_.data(), low_counts_.data(),
            counts.data(), low_counts_.size());
  }

 private:
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
