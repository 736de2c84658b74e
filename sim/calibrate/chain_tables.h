#pragma once

#include <string>
#include <vector>

#include "sim/calibrate/chain_fit.h"
#include "sim/calibrate/chain_log.h"
#include "sim/calibrate/identified_chain.h"
#include "sim/results/table_text.h"

namespace gauntlet::sim {

/// Values of a hand with their intervals, a row per part.
ResultTable ChainTable(const ChainLog& log, const std::vector<ChainFit>& fits);
/// The same for a person, with the reason of each value that is withheld.
ResultText ChainText(const ChainLog& log, const std::vector<ChainFit>& fits);

/// The horizon to set, the values that are withheld, and warnings. `file` contains the chain; the
/// recommendation is empty if the log determines no delay.
Verdict VerdictOf(const ChainLog& log, const std::vector<ChainFit>& fits,
                  const IdentifiedChain& chain, const std::string& file);
/// The verdict and a table of the delays; `verbose` adds ChainText().
ResultText ChainAnswer(const ChainLog& log, const std::vector<ChainFit>& fits,
                       const IdentifiedChain& chain, const std::string& file, bool verbose);
std::string ChainJson(const ChainLog& log, const std::vector<ChainFit>& fits,
                      const Verdict& verdict);

}  // namespace gauntlet::sim
