#pragma once

#include <memory>
#include <vector>

#include "controller/linearisation/linearisation.h"

namespace gauntlet::controller {

/// Polynomials, one per channel; the inverse by a fixed number of halvings, exact to rounding.
/// Errors: no coefficients, or a polynomial that turns back within its range.
std::unique_ptr<Linearisation> MakePolynomialLinearisation(const std::vector<ChannelCurve>& curves);

}  // namespace gauntlet::controller
