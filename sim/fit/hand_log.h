#pragma once

#include <filesystem>
#include <string>

#include "sim/fit/chain_log.h"

namespace gauntlet::sim {

struct HandLogOptions {
  std::string controller = {};  // of a trace; empty: the first
  bool from_wearer = true;      // of a trace: commands are the wearer's angles, else the targets
  ChainLogOptions table = {};   // of any other log
};

/// The log of a hand: an output folder of `gauntlet run`, its trace.h5 (one controller, the whole
/// hand), or a table as LoadChainEpisodes() reads it.
/// Errors: UserError; as ReadTraceFile() and LoadChainEpisodes().
ChainEpisodes LoadHandLog(const std::filesystem::path& log, const HandLogOptions& options);

}  // namespace gauntlet::sim
