#pragma once

#include <string>

#include "sim/recordings/inspect/inspection.h"

namespace gauntlet::sim {

/// An inspection as a page without scripts: the health of the sensors, the worst first, with what
/// to do; the joints with unit and assumptions; a small picture of each channel over time.
std::string InspectionPage(const Inspection& inspection);

}  // namespace gauntlet::sim
