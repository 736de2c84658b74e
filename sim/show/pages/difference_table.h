#pragma once

#include <string>

#include "sim/answers/compare/study_difference.h"
#include "sim/results/table_text.h"

namespace gauntlet::sim {

struct DifferenceDetail {
  bool all = false;      // rows of scores without a difference, too
  bool verbose = false;  // all changed scores and settings, versions, intervals and methods
};

/// The differences of two output folders for a person: the answer with the largest differences,
/// settings, names, and a table of the changed scores: relevant differences of primary scores
/// first, then the larger in multiples of the smallest relevant difference.
ResultText DifferenceText(const StudyFolder& a, const StudyFolder& b,
                          const StudyDifference& difference, const DifferenceDetail& detail = {});

}  // namespace gauntlet::sim
