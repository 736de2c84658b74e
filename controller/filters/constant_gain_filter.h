#pragma once

#include <Eigen/Core>
#include <memory>

#include "controller/filters/filter.h"
#include "controller/filters/start.h"

namespace gauntlet::controller {

/// Position, velocity and perhaps acceleration per channel, corrected by constant gains: the
/// filter that alpha_beta, alpha_beta_gamma and kalman_steady are.
///
///     x^- = A x,  e = z - H x^-,  x = x^- + K e      in steps of one sample
///
/// Shapes: `gains` is channels x 2 (position, velocity) or channels x 3 (acceleration, too).
std::unique_ptr<Filter> MakeConstantGainFilter(const Eigen::ArrayXXd& gains, Start start);

}  // namespace gauntlet::controller
