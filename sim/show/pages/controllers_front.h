#pragma once

#include <string>

#include "sim/answers/compare/summary.h"

namespace gauntlet::sim {

/// Jitter against delay of the controllers as HTML: a figure for each of three widths of the page,
/// of which style sheets show one, or a sentence if no controller has both scores.
std::string ControllersFront(const Summary& summary);
/// ControllersFront() as an SVG that is complete as a file; empty if no controller has both scores.
std::string ControllersFrontFile(const Summary& summary);

}  // namespace gauntlet::sim
