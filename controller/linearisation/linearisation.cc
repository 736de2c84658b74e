#include "controller/linearisation/linearisation.h"

#include <string>

#include "controller/linearisation/two_point_linearisation.h"

namespace gauntlet::controller {

std::unique_ptr<Linearisation> MakeLinearisation(const GloveCalibration& calibration) {
  const std::size_t channels = calibration.low_counts.size();
  if (channels == 0 || calibration.high_counts.size() != channels ||
      calibration.low_angle_rad.size() != channels ||
      calibration.high_angle_rad.size() != channels) {
    throw SettingError("calibration", "must have two poses for each of at least one channel, has " +
                                          std::to_string(calibration.low_counts.size()) + ", " +
                                          std::to_string(calibration.high_counts.size()) + ", " +
                                          std::to_string(calibration.low_angle_rad.size()) + ", " +
                                          std::to_string(calibration.high_angle_rad.size()) +
                                          " values");
  }
  return MakeTwoPointLinearisation(calibration);
}

}  // namespace gauntlet::controller
