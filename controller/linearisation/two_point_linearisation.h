#pragma once

#include <memory>

#include "controller/linearisation/linearisation.h"

namespace gauntlet::controller {

/// A straight line through two known poses: angle = low_angle + (counts - low_counts) slope.
/// Source: the equation of GloveCalibration. Errors: poses of equal angles, outside the
/// converter's range, or less than ten counts (and a hundredth of the range) apart.
std::unique_ptr<Linearisation> MakeTwoPointLinearisation(const GloveCalibration& calibration);

}  // namespace gauntlet::controller
