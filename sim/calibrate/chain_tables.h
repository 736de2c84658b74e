#pragma once

#include <string>
#include <vector>

#include "sim/calibrate/chain_fit.h"
#include "sim/calibrate/chain_log.h"
#include "sim/results/table_text.h"

namespace gauntlet::sim {

/// What a log says of a hand, a row per part.
ResultTable ChainTable(const ChainLog& log, const std::vector<ChainFit>& fits);
/// The same for a person, with what is not known and why.
ResultText ChainText(const ChainLog& log, const std::vector<ChainFit>& fits);
std::string ChainJson(const ChainLog& log, const std::vector<ChainFit>& fits);

}  // namespace gauntlet::sim
