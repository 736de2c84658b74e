#pragma once

#include <cstddef>
#include <string>

#include "sim/answers/robust/robust.h"
#include "sim/answers/sweep/response.h"

namespace gauntlet::sim {

/// A score, by its place in the response's metrics, over the one setting: a curve and the band of
/// its intervals for each controller.
std::string ResponseSvg(const Response& response, std::size_t metric, const std::string& setting);

/// Change by each parameter of the hand of the difference between the two best controllers; the
/// band is the smallest relevant difference around `nominal`, that of the nominal hand.
std::string TornadoSvg(const RobustPlan& plan, const RobustScore& score, double nominal);

}  // namespace gauntlet::sim
