#pragma once

#include <string>
#include <vector>

#include "sim/fit/chain_log.h"
#include "sim/results/table_text.h"
#include "sim/settings/identified_chain.h"

namespace gauntlet::sim {

/// The mean over episodes, with the 95 % interval of Student's t; none of one value.
ChainEstimate MeanOfEpisodes(const std::vector<double>& values);

/// How well the chain of some episodes holds for others, of one part.
struct HeldOutPart {
  std::size_t fitted = 0;           // episodes that count
  std::size_t held_out = 0;         // the same, of those that no fit contains
  ChainEstimate held_out_delay_ms;  // their mean
  double fitted_rms_deg = kNaN;     // of the combined model in the fitted episodes
  double held_out_rms_deg = kNaN;   // and in the held-out ones
  double repeat_rms_deg = kNaN;     // of angles between episodes with the same commands
};

/// Result of the identification from a log.
struct ChainResult {
  std::vector<ChainLog> episodes;     // one or more
  std::vector<ChainFit> fits;         // per part; means over the fitted episodes
  std::vector<HeldOutPart> held_out;  // per part; empty for one episode
  std::vector<std::string> left_out;  // "episode 7: ..", sentences without a period
  std::size_t fitted = 0;             // episodes
  std::size_t judged = 0;             // held-out episodes
  std::size_t shown = 0;              // of the episodes, the one for curves

  const ChainLog& log() const { return episodes[shown]; }
  double duration_s() const;  // of all episodes
};

/// One episode: FitChains(). Of several, fits the basic chain (see FitChain()) to every second one,
/// from the first on, and judges it on the others. A value is the mean over episodes, with the 95 %
/// interval of Student's t, which covers what differs between motions. An episode counts for a part
/// that moves in it by at least a fifth of its largest travel. Values whose interval is as wide as
/// their range are withheld as in a log of one episode. With fewer than four episodes all are
/// fitted and none is held out.
///
/// Two episodes repeat each other if the commands of a part differ by less than 2 % of its travel
/// (RMS) over the shorter of both. The spread of their angles is the RMS difference over the root
/// of 2: no model can leave less.
/// Errors: UserError if no part can be fitted in any episode.
ChainResult IdentifyChain(ChainEpisodes episodes, const ChainProgress& progress = {});

/// The judgement on the held-out episodes, a row per part.
ResultTable HeldOutTable(const ChainResult& result);
/// HeldOutTable() for a person, with the episodes that were left out; empty for one episode.
ResultText HeldOutText(const ChainResult& result);

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
