#pragma once

#include <string>
#include <vector>

#include "sim/comparison/summary.h"
#include "sim/results/table_text.h"

namespace gauntlet::sim {

/// "5 of 18 joints measured".
std::string Measured(const Study& study);

/// How long the trials are: "10.8 s", "3.1 to 5.4 s".
std::string DurationText(const StudyResult& result);

/// What differs from seed to seed: "one motion, 8 noises", "25 motions, one noise each".
std::string WhatVaries(const StudyResult& result);

/// How the marks and intervals come about, a sentence or two each: for the table and the page.
std::vector<std::string> Notes(const FinishedStudy& finished);

/// The scores for a person: what was asked; per controller its means and, below each, the
/// difference to the best with the interval that decides; a star at the best of each column and at
/// those equal to it, a tilde where it is undecided, an exclamation mark where a filter is worse
/// than the baseline; a verdict. Columns are the main metrics that have a value. Of one run alone
/// nothing is marked, and the text says why.
ResultText ScoreText(const FinishedStudy& finished);

}  // namespace gauntlet::sim
