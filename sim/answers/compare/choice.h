#pragma once

#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

#include "sim/answers/compare/summary.h"

namespace gauntlet::sim {

/// Places in Summary::controllers, or in Metrics().
using Places = std::vector<std::size_t>;

/// The controllers that a verdict is about, the primary scores that all of them have, and the
/// choice between them by the rule of AnswerOf(). It keeps a reference to the summary.
class Choice {
 public:
  explicit Choice(const Summary& summary);

  const Places& all() const { return all_; }
  const Places& scores() const { return scores_; }
  const Places& left_out() const { return left_out_; }
  /// With a baseline, it or one that is better in a primary score. Without one, a controller that
  /// is better than each other in a primary score or, where it is equivalent, in reversals.
  std::optional<std::size_t> recommended() const;
  /// Equivalent to the candidate for the priority in every primary score. The baseline is none: a
  /// controller that is recommended is better than it.
  Places equivalent() const { return best_ && best_ != baseline_ ? equivalent_ : Places{}; }
  /// The candidate for the priority and its equivalents, where nothing more decides between them.
  Places any_of() const;
  /// The candidate for the priority and those that it is better than in no primary score, where
  /// there is no recommendation because of them.
  Places not_beaten() const;
  bool decides_by_reversals() const { return !baseline_; }
  /// Scores other than the priority with a controller that is better in them than the recommended
  /// one.
  std::vector<std::pair<std::size_t, std::size_t>> alternatives() const;
  Judgement JudgementOf(std::size_t metric, std::size_t c, std::size_t other) const {
    return c == other ? Judgement::kEqual : summary_.Of(metric, c, other).judgement;
  }
  /// By how much the first may be worse than the other, at the end of the interval.
  double MostWorse(std::size_t metric, std::size_t c, std::size_t other) const;
  bool KeepsBounds(std::size_t c) const;

 private:
  bool HasFewerReversals(std::size_t c, std::size_t other) const {
    return JudgementOf(reversals_, c, other) == Judgement::kBetter;
  }
  /// In a primary score.
  bool IsBetter(std::size_t c, std::size_t other) const;
  /// Number of primary scores in which it is worse than the baseline.
  std::ptrdiff_t ScoresBelowBaseline(std::size_t c) const;
  /// In every primary score.
  bool IsEquivalent(std::size_t c, std::size_t other) const;
  bool IsNoWorse(std::size_t metric, std::size_t c, std::size_t other) const;
  bool IsDominated(std::size_t c) const;
  std::optional<std::size_t> CandidateFor(std::size_t metric) const;
  Places::const_iterator Best(std::size_t metric, const Places& places) const;
  /// Keeps the best of a score, and those equivalent to it.
  void KeepBest(std::size_t metric, Places& places) const;
  std::optional<std::size_t> For(std::size_t metric) const;

  const Summary& summary_;
  const std::size_t reversals_ = MetricIndex("command_reversals_per_s");
  Places all_;
  Places scores_;                                                // in the order of PrimaryScores()
  Places left_out_;                                              // primary scores
  std::optional<std::size_t> baseline_;                          // if it may be recommended
  std::vector<std::pair<std::size_t, std::size_t>> candidates_;  // score, controller
  std::optional<std::size_t> best_;                              // candidate for the priority
  Places not_beaten_;                                            // by it in any primary score
  Places equivalent_;                                            // of these
};

}  // namespace gauntlet::sim
