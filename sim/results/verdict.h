#pragma once

#include <string>
#include <vector>

namespace gauntlet::sim {

class Json;

/// A sentence of a verdict. `key`: what it is about, for programs.
struct VerdictRemark {
  std::string key;
  std::string text;
};

/// Recommendation and its reasons. It is made once, from the judgements: terminal, page and JSON
/// show it.
struct Verdict {
  std::string recommended = {};  // a controller, cell, setting or filter; may be empty
  std::vector<std::string> alternatives = {};  // equivalent, or better in another score
  std::vector<VerdictRemark> reasons = {};
  std::vector<VerdictRemark> warnings = {};
  /// The answer in at most eight words where names are short: the beginning of a sentence of the
  /// reasons, without its end. Empty: the first sentence.
  std::string headline = {};

  /// An empty text is not added.
  void AddReason(std::string key, std::string text);
  /// Adds `beginning` + `rest`, of which the beginning is the headline from now on.
  void AddHeadline(std::string key, std::string beginning, const std::string& rest);
  void AddWarning(std::string key, std::string text);
  /// These are not told apart from the best, so they may be as good: nothing is recommended then.
  /// `cure`: sentence on how to decide it. `noun`: names several by their number alone, "8 other
  /// settings"; empty: by the first names.
  void AddUndecided(const std::vector<std::string>& undecided,
                    const std::string& cure = "More seeds can decide it.",
                    const std::string& noun = "");
  void AddWithoutHand();

  /// The reasons, then assumptions, a sentence or two each.
  std::vector<std::string> Answer() const;
  /// The other warnings.
  std::vector<std::string> Doubts() const;
  /// The headline as a sentence; empty without reasons.
  std::string Headline() const;
  /// The recommended one, or `other` where there is none.
  const std::string& best_or(const std::string& other) const {
    return recommended.empty() ? other : recommended;
  }
  /// Both in one line.
  std::string Text() const;
};

/// {"version": 1, "recommended": .., "alternatives": [..], "reasons": [{"key", "text"}],
/// "warnings": [{"key", "text"}]}.
Json JsonOf(const Verdict& verdict);

}  // namespace gauntlet::sim
