#pragma once

#include <string>

#include "sim/report/table_text.h"
#include "sim/study/study_difference.h"

namespace gauntlet::sim {

struct DifferenceTableOptions {
  bool all = false;  // also the scores that are the same
  TerminalStyle style = TerminalStyle::Unlimited();
};

/// What differs between two output folders, for a person at a terminal: settings, versions, names,
/// a row per score that changed, and the verdict in one sentence.
std::string DifferenceTable(const StudyFolder& a, const StudyFolder& b,
                            const StudyDifference& difference,
                            const DifferenceTableOptions& options);

}  // namespace gauntlet::sim
