#pragma once

#include <array>
#include <cstdint>

namespace gauntlet::sim {

/// How the true means of controllers differ.
enum class Truth {
  kEqual,  // not at all
  kMixed,  // in each metric and controller: equal, slightly (0.2 to 0.8 D), or clearly (1.5 to 4 D)
  kUniform,  // by 0 to 4 D, uniformly, in each metric and controller
  kAtLimit,  // by exactly D, the smallest difference that matters
};

enum class Scatter { kNormal, kSkewed };

/// Comparisons of controllers whose true means are known, in all metrics, with independent scatter.
///
///     value = mean + 3 D motion_g + 3 D seed_i + scatter D (interaction_gc + noise_ic) / sqrt(2)
///
/// Motion and seed are the same for all controllers. Without several motions there is no motion
/// and no interaction. Effects are normal, or exponential with the mean taken off (skewness 2). The
/// last two are the smaller the later the controller, as of a filter that takes more away: 1, 0.8,
/// 0.6, 0.4; so differences are skewed, too.
struct ComparisonsShape {
  Truth truth = Truth::kMixed;
  Scatter scatter = Scatter::kNormal;
  double scatter_size = 0.3;  // of the first controller's own effects, over D
  int motions = 1;
  int noises = 8;  // of each motion
  int controllers = 4;
  int studies = 1000;
  std::uint64_t seed = 1;
};

/// Judgements by Summarise(). Shares of pairs of controllers in the primary scores, unless said.
struct ComparisonsOutcome {
  double coverage = 0.0;            // of the 95 % interval of the paired difference, all scores
  double false_better_worse = 0.0;  // of studies with one where the truth is equal or the reverse
  double false_equal = 0.0;         // of studies with one where the truth is the printed D or more
  double false_verdict = 0.0;       // of studies with one of either
  double false_other = 0.0;         // of studies with one of either in another score
  /// How pairs whose truth is equal, slightly and clearly different are judged: shares of what is
  /// right
  /// (in the direction of the truth), equal, undecided, wrong.
  struct Verdicts {
    double right = 0.0, equal = 0.0, undecided = 0.0, wrong = 0.0;
  };
  std::array<Verdicts, 3> of_truth;
};

ComparisonsOutcome SimulateComparisons(const ComparisonsShape& shape);

/// Recommendations of VerdictOf(). Shares of studies.
struct RecommendationOutcome {
  double recommended = 0.0;  // with a recommendation
  double baseline = 0.0;     // it is the first controller
  double too_bad = 0.0;  // it is worse than another in tracking error by more than 2 D, in truth
};

/// `has_baseline`: the first controller is the baseline; else there is none.
RecommendationOutcome SimulateRecommendations(const ComparisonsShape& shape,
                                              bool has_baseline = true);

}  // namespace gauntlet::sim
