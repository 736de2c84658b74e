#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "controller/controller_config.h"
#include "controller/export.h"

namespace gauntlet::controller {

/// Counts of the converter to bending angles, channel by channel, and back.
///
/// Shapes: samples x channels, one sample after the other, mostly one; input and output may be the
/// same memory. Units: counts and rad.
/// Both directions neither throw nor allocate; finite in, finite out; each is the other's inverse.
class GAUNTLET_API Linearisation {
 public:
  virtual ~Linearisation() = default;

  virtual int channel_count() const noexcept = 0;
  virtual void ToAngles(std::span<const double> counts,
                        std::span<double> angle_rad) const noexcept = 0;
  virtual void ToCounts(std::span<const double> angle_rad,
                        std::span<double> counts) const noexcept = 0;
};

/// `channel_names` give the order of the channels; curves with a name go to their channel.
/// Errors: SettingError for data that do not fit together, or a curve that is not monotone.
GAUNTLET_API std::unique_ptr<Linearisation> MakeLinearisation(
    const LinearisationConfig& config, const GloveCalibration& glove,
    const std::vector<std::string>& channel_names);

}  // namespace gauntlet::controller
