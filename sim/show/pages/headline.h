#pragma once

#include <string>

#include "sim/answers/compare/summary.h"

namespace gauntlet::sim {

/// "Use prediction in place of raw.": the answer of a comparison in at most eight words.
std::string Headline(const Summary& summary);

/// The primary scores of the recommended controller against the baseline, as HTML: a large
/// difference where it is judged better or worse, else the word of the judgement; both values and
/// the interval of the difference below. Empty where there is nothing recommended to compare.
std::string HeadlineDifferences(const Summary& summary);

}  // namespace gauntlet::sim
