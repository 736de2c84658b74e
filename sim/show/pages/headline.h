#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "sim/answers/compare/summary.h"
#include "sim/results/verdict.h"
#include "sim/score/statistics/judgement.h"

namespace gauntlet::sim {

/// A number at the head of a page.
struct HeadNumber {
  std::string name;                        // "tracking error"
  std::string value;                       // shown large: "-32 %"
  std::string note = {};                   // below it: values compared, confidence interval
  Judgement judgement = Judgement::kNone;  // its colour
};

/// The head of a page: the answer, the numbers that it rests on, then the sentences of the
/// terminal.
struct PageHead {
  std::string kind = {};  // "Gauntlet sweep"
  std::string title = {};
  std::string question = {};
  std::string headline = {};             // at most eight words where names are short
  std::vector<HeadNumber> numbers = {};  // at most four
  std::string of_numbers = {};           // where they are explained, as "#scores"; may be empty
  std::string answer = {};               // with the headline's sentence, unless it is all of it
  std::vector<std::string> warnings = {};
  std::string facts = {};
};

/// Takes over headline, answer and warnings of a verdict, as the terminal has them.
void SetAnswer(const Verdict& verdict, PageHead& head);
/// Takes over one text, whose first sentence is the headline.
void SetAnswer(const std::string& text, PageHead& head);

/// The head as HTML. All texts are escaped.
std::string HtmlOf(const PageHead& head);

/// A score with its confidence interval; `note` before the interval.
HeadNumber NumberOf(std::size_t metric, const MeanInterval& score, const std::string& note = "");
/// The primary scores among these, with their intervals; without one of them, the first score.
std::vector<HeadNumber> NumbersOf(const std::vector<std::size_t>& metrics,
                                  const std::vector<MeanInterval>& scores,
                                  const std::string& note = "");
/// A difference judged by `comparison`, large where it is better or worse, else the word of the
/// judgement; the values behind it below. `name`: of the baseline.
HeadNumber NumberOf(std::size_t metric, const Comparison& comparison, double value, double baseline,
                    const std::string& name);

/// "Use prediction in place of raw.": the answer of a comparison in at most eight words.
std::string Headline(const Summary& summary);

/// The primary scores of the recommended controller against the baseline, and the first of the
/// other main scores that is worse. Empty where there is nothing recommended to compare.
std::vector<HeadNumber> HeadlineDifferences(const Summary& summary);

}  // namespace gauntlet::sim
