#pragma once

#include <string>
#include <vector>

#include "sim/fit/chain_episodes.h"
#include "sim/fit/identified_hand.h"

namespace gauntlet::sim {

/// Findings of gauntlet identify as a page without scripts: the table of the terminal, and for each
/// part of the log, over the command, what was measured beside what the model makes of the same
/// command; in the stretch of a few seconds in which it moves most, and the difference over the
/// whole log but its first second. Of several episodes, these are of the held-out one with the most
/// motion. `file`: name of the file of the chain, without folders.
std::string ChainPage(const ChainResult& result, const IdentifiedChain& chain,
                      const std::string& file);

}  // namespace gauntlet::sim
