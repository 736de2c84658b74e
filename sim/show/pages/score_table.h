#pragma once

#include <string>
#include <vector>

#include "sim/answers/compare/summary.h"
#include "sim/results/table_text.h"

namespace gauntlet::sim {

/// "18 of 18 joints, 12 of them at rest": with scores, of the hand, and at rest in the one motion.
std::string Measured(const Study& study, const StudyResult& result);

/// How long the trials are: "10.8 s", "3.1 to 5.4 s".
std::string DurationText(const StudyResult& result);

/// Differences from seed to seed: "one motion, 8 noises", "25 motions, one noise each".
std::string WhatVaries(const StudyResult& result);

/// How the marks and intervals come about, a sentence or two each: for the table and the page.
std::vector<std::string> Notes(const FinishedStudy& finished);

/// Meaning of the marks of Summary::MarkOf(); empty where there are none.
std::string MarkLegend(const Summary& summary);

/// Below the sentences of the verdict: the table of the primary scores with marks against the
/// baseline.
ResultText AnswerText(const FinishedStudy& finished);
/// The primary scores of the controllers that the answer shows, the baseline last.
ResultText ShownText(const FinishedStudy& finished);
/// Adds causes of the error and warnings of the verdict.
void AddAnswerNotes(const FinishedStudy& finished, ResultText& text);

/// The answer for a person: verdict; table of the primary scores with marks against the baseline;
/// causes of the error; warnings. `verbose` adds the main metrics with the difference to the
/// baseline and its confidence interval, the method, and the causes for each controller.
/// One run has no marks, and the text says why.
ResultText ScoreText(const FinishedStudy& finished, bool verbose);

}  // namespace gauntlet::sim
