#pragma once

#include <string>
#include <vector>

#include "sim/fit/chain_episodes.h"
#include "sim/settings/identified_chain.h"

namespace gauntlet::sim {

/// The file that `gauntlet identify` writes of the fits of a log's parts, in their order.
IdentifiedChain MakeIdentifiedChain(const ChainLog& log, const std::vector<ChainFit>& fits);

/// All that `gauntlet identify` makes of a log.
struct IdentifiedHand {
  ChainResult result;
  IdentifiedChain chain;
  std::string chain_yaml;  // the chain as settings of controllers
  std::string servo_yaml;  // see ServoSettingsText(); empty where the log is not of a hand alone
};

/// IdentifyChain(), and what follows from it. The servo is that of most parts: none where these
/// have a speed limit, where the unit is unknown, or for a log that begins with the wearer. Errors:
/// as IdentifyChain().
IdentifiedHand IdentifyHand(ChainEpisodes episodes, const ChainProgress& progress = {});

}  // namespace gauntlet::sim
