#pragma once

#include <vector>

#include "sim/fit/chain_log.h"
#include "sim/settings/identified_chain.h"

namespace gauntlet::sim {

/// The file that `gauntlet identify` writes of the fits of a log's parts, in their order.
IdentifiedChain MakeIdentifiedChain(const ChainLog& log, const std::vector<ChainFit>& fits);

}  // namespace gauntlet::sim
