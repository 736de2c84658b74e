#pragma once

#include <span>
#include <vector>

#include "sim/answers/sweep/sweep_result.h"

namespace gauntlet::sim {

/// After how many seeds a sweep looks which cells cannot win any more: 3, 4, 6, 8, 12, 16 and so on
/// below all seeds. Fixed numbers, so that nothing depends on the schedule.
std::vector<int> LooksOf(int seeds);

/// True for each controller of a cell that cannot win any more, judged by the first seeds. It
/// cannot
///
/// - if a trial of it failed: then it is not ranked;
/// - if it breaks a bound with its whole interval;
/// - if it is worse than the leader with the whole interval of their difference, paired by seed.
///
/// The leader is the best mean of those that keep all bounds with their whole intervals. With K
/// looks, C candidates and B bounds an interval's one side has the level
///
///     1 - 0.05 / (K (C + 1) (B + 1))
///
/// which is Bonferroni's over all looks, all that the best could be compared with, and all bounds:
/// what is truly best is stopped in at most 5 % of sweeps, as far as differences are normal.
/// Source: Dunn 1961, doi 10.1080/01621459.1961.10482090.
///
/// `alive`: those not yet stopped, all with the same seeds. `candidates`: how many there were in
/// the beginning.
std::vector<bool> CannotWin(const SweepPlan& plan, std::span<const CellResult> alive,
                            std::size_t candidates, std::size_t looks);

}  // namespace gauntlet::sim
