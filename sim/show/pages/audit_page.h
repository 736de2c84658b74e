#pragma once

#include <string>

#include "sim/fit/audit.h"

namespace gauntlet::sim {

/// Findings of gauntlet audit as a page without scripts: the verdict, the delay of each part with
/// its range over the data set, the table, the offset and the delay of each part and episode as
/// heat maps, and for each part the stretch in which the angle is farthest from its command.
std::string AuditPage(const Audit& audit);

}  // namespace gauntlet::sim
