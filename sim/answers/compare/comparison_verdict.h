#pragma once

#include <cstddef>
#include <vector>

#include "sim/answers/compare/summary.h"

namespace gauntlet::sim {

/// The answer of a comparison; Summarise() keeps it in the summary. Tracking error, delay and
/// jitter are the primary scores; one that a controller has no value of is left out for all.
///
/// D is the smallest relevant difference. A controller is no worse than another in a score if it is
/// judged better or equivalent, or if the difference is undecided and at most 2 D to its
/// disadvantage. A controller is dominated if another is better in one primary score and no worse
/// in the others. Candidates for a score are not dominated, keep the bounds of the priority, are
/// no worse than any controller in it, and are the baseline, or judged better than it in a primary
/// score and not worse in that one. Of them the least jitter, then the least delay, then the least
/// tracking error decides, each among those that are no worse; after that the baseline. Of those
/// that are equivalent in all primary scores, those that are worse than the baseline in the fewest
/// stay, and of these the one with the fewest command reversals is named. The others are named as
/// equivalent.
///
/// The candidate for the user's priority is recommended. Without a baseline it must also be judged
/// better than every other controller in a primary score or, where both are equivalent, in command
/// reversals; else all of them are named as equivalent, or as undecided. Candidates for the other
/// primary scores are the alternatives, where they are better than the recommended one in their
/// score. One run recommends nothing.
ComparisonAnswer AnswerOf(const Summary& summary);

/// The main metrics that some controller has a value of.
std::vector<std::size_t> ShownMetrics(const Summary& summary);
/// These, and those of the detailed table alone.
std::vector<std::size_t> DetailedMetrics(const Summary& summary);

}  // namespace gauntlet::sim
