#pragma once

#include <string>
#include <vector>

#include "sim/fit/chain_episodes.h"
#include "sim/results/table_text.h"
#include "sim/settings/identified_chain.h"

namespace gauntlet::sim {

/// "12.4 s at 30 Hz", or "50 episodes, 612 s at 30 Hz: 25 fitted, 25 held out".
std::string ExtentText(const ChainResult& result);

/// Values of a hand with their intervals, a row per part.
ResultTable ChainTable(const ChainResult& result);
/// ChainTable() for a person, with the reason of each value that is withheld.
ResultText ChainText(const ChainResult& result);

/// A sentence on parts whose angle is beside its command by more than kOffsetOfTravel; empty
/// without any, and for the chain from a wearer.
std::string OffsetsText(const ChainResult& result);
/// The horizon to set, the values that are withheld, and warnings. `file` contains the chain; the
/// recommendation is empty if the log determines no delay.
Verdict VerdictOf(const ChainResult& result, const IdentifiedChain& chain, const std::string& file);
/// The verdict, a table of the delays and HeldOutText(); `verbose` adds ChainText().
ResultText ChainAnswer(const ChainResult& result, const IdentifiedChain& chain,
                       const std::string& file, bool verbose);
std::string ChainJson(const ChainResult& result, const Verdict& verdict);

}  // namespace gauntlet::sim
