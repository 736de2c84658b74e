#pragma once

#include <string>
#include <vector>

#include "sim/calibrate/chain_log.h"

namespace gauntlet::sim {

/// What gauntlet identify found, as a page without scripts: the table of the terminal, and for each
/// part of the log, over the command, what was measured beside what the model makes of the same
/// command; in the stretch of a few seconds in which it moves most, and the difference over the
/// whole log but its first second.
std::string ChainPage(const ChainLog& log, const std::vector<ChainFit>& fits);

}  // namespace gauntlet::sim
