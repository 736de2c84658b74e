#pragma once

#include <string>
#include <vector>

#include "sim/answers/compare/study_difference.h"
#include "sim/results/table_text.h"

namespace gauntlet::sim {

struct DifferenceDetail {
  bool all = false;      // rows of scores without a difference, too
  bool verbose = false;  // all changed scores and settings, versions, intervals and methods
};

/// The scores, relevant differences of primary scores first, then the larger in multiples of the
/// smallest relevant difference.
std::vector<ScoreDifference> LargestFirst(const StudyDifference& difference);

/// The answer with the largest differences.
std::string DifferenceAnswer(const StudyFolder& a, const StudyFolder& b,
                             const StudyDifference& difference);

/// The differences of two output folders for a person: the answer with the largest differences,
/// settings, names, and a table of the changed scores, as LargestFirst() has them.
ResultText DifferenceText(const StudyFolder& a, const StudyFolder& b,
                          const StudyDifference& difference, const DifferenceDetail& detail = {});

}  // namespace gauntlet::sim
