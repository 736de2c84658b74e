#pragma once

#include <string>

#include "sim/comparison/study_difference.h"
#include "sim/results/table_text.h"

namespace gauntlet::sim {

/// What differs between two output folders, for a person: settings, versions, names, a row per
/// score that changed, or `all`, and the verdict in one sentence.
ResultText DifferenceText(const StudyFolder& a, const StudyFolder& b,
                          const StudyDifference& difference, bool all);

}  // namespace gauntlet::sim
