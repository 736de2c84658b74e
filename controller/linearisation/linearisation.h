#pragma once

#include <memory>
#include <span>

#include "controller/controller_config.h"

namespace gauntlet::controller {

/// Counts of the converter to bending angles, channel by channel, and back.
///
/// Shapes: one value per channel; input and output may be the same memory. Units: counts and rad.
/// Both directions neither throw nor allocate; finite in, finite out.
class Linearisation {
 public:
  virtual ~Linearisation() = default;

  virtual int channel_count() const noexcept = 0;
  virtual void ToAngles(std::span<const double> counts,
                        std::span<double> angle_rad) const noexcept = 0;
  virtual void ToCounts(std::span<const double> angle_rad,
                        std::span<double> counts) const noexcept = 0;
};

/// Errors: SettingError for data that do not fit together, or a curve that is not monotone.
std::unique_ptr<Linearisation> MakeLinearisation(const GloveCalibration& calibration);

}  // namespace gauntlet::controller
