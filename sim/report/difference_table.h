#pragma once

#include <string>

#include "sim/study/study_difference.h"

namespace gauntlet::sim {

struct DifferenceTableOptions {
  bool all = false;     // also the scores that are the same
  bool colour = false;  // mark better and worse with terminal colours besides words
};

/// What differs between two output folders, for a person at a terminal: settings, versions, names,
/// a row per score that changed, and the verdict in one sentence.
std::string DifferenceTable(const StudyFolder& a, const StudyFolder& b,
                            const StudyDifference& difference,
                            const DifferenceTableOptions& options);

}  // namespace gauntlet::sim
