#include "tests/comparison/simulated_comparisons.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "controller/assert.h"
#include "sim/answers/compare/comparison_verdict.h"
#include "sim/answers/compare/summary.h"
#include "sim/base/normal_pair.h"
#include "sim/base/random.h"

namespace gauntlet::sim {
namespace {

constexpr double kSharedScatter = 3.0;  // of motions and seeds, over D

class Simulation {
 public:
  explicit Simulation(const ComparisonsShape& shape)
      : shape_(shape), random_(shape.seed, "simulated comparisons") {
    for (int c = 0; c < shape.controllers; ++c) {
      NamedController named;
      named.name = "controller_" + std::to_string(c);
      study_.scenario.controllers.push_back(named);
      result_.controller_names.push_back(named.name);
    }
    for (int i = 0; i < shape.motions * shape.noises; ++i) {
      SeedOutcome& seed = result_.seeds.emplace_back();
      seed.seed = i + 1;
      seed.motion = i % shape.motions;
      seed.controllers.resize(static_cast<std::size_t>(shape.controllers));
      for (TrialOutcome& trial : seed.controllers) {
        trial.scores.summary.assign(Metrics().size(), 0.0);
      }
    }
  }

  RecommendationOutcome Recommend(bool has_baseline) {
    const std::size_t tracking = MetricIndex("tracking_rmse_deg");
    const double relevant = Metrics()[tracking].relevant_difference.absolute;
    RecommendationOutcome shares;
    for (int study = 0; study < shape_.studies; ++study) {
      truth_.assign(Metrics().size(), {});
      for (const PrimaryScore& score : PrimaryScores()) Draw(score.metric);
      Draw(MetricIndex("command_reversals_per_s"));  // others decide nothing
      Summary summary = Summarise(study_, result_);
      GAUNTLET_ASSERT(summary.baseline == std::size_t{0});
      if (!has_baseline) summary.baseline.reset();
      const std::string name = AnswerOf(summary).verdict.recommended;
      if (name.empty()) continue;
      const std::size_t chosen = static_cast<std::size_t>(
          std::ranges::find(result_.controller_names, name) - result_.controller_names.begin());
      const std::vector<double>& means = truth_[tracking];
      shares.recommended += 1.0 / shape_.studies;
      if (chosen == 0) shares.baseline += 1.0 / shape_.studies;
      if (means[chosen] - std::ranges::min(means) > 2.0 * relevant) {
        shares.too_bad += 1.0 / shape_.studies;
      }
    }
    return shares;
  }

  ComparisonsOutcome Run() {
    for (int study = 0; study < shape_.studies; ++study) {
      truth_.assign(Metrics().size(), {});
      for (std::size_t m = 0; m < Metrics().size(); ++m) Draw(m);
      Count(Summarise(study_, result_));
    }
    return Shares();
  }

 private:
  /// Mean 0, variance 1.
  double Effect() {
    if (shape_.scatter == Scatter::kSkewed) return -std::log(random_.UniformAboveZero()) - 1.0;
    return BoxMuller(random_).first;
  }

  /// Over D.
  double Offset(std::size_t controller) {
    const double side = random_.Uniform() < 0.5 ? -1.0 : 1.0;
    if (shape_.truth == Truth::kEqual || controller == 0) return 0.0;
    if (shape_.truth == Truth::kUniform) return side * random_.Uniform(0.0, 4.0);
    if (shape_.truth == Truth::kAtLimit) return side * (controller % 2 == 1 ? 1.0 : 0.0);
    switch (random_.Index(3)) {
      case 0:
        return 0.0;
      case 1:
        return side * random_.Uniform(0.2, 0.8);
      default:
        return side * random_.Uniform(1.5, 4.0);
    }
  }

  /// True means and values of one metric.
  void Draw(std::size_t metric) {
    constexpr double kBase = 100.0;
    const Metric& drawn = Metrics()[metric];
    const double d = RelevantDifferenceBetween(drawn, kBase, kBase);
    std::vector<double>& means = truth_[metric];
    for (int c = 0; c < shape_.controllers; ++c) {
      double mean = kBase + d * Offset(static_cast<std::size_t>(c));
      // D is a share of the smaller of the two.
      const double relative = drawn.relevant_difference.relative;
      const bool share = relative > 0.0 && shape_.truth == Truth::kAtLimit;
      if (share && mean < kBase) mean = kBase / (1.0 + relative);
      means.push_back(mean);
    }
    const bool motions = shape_.motions > 1;
    std::vector<double> of_motion, interaction;
    for (int g = 0; g < shape_.motions; ++g) {
      of_motion.push_back(Effect());
      for (int c = 0; c < shape_.controllers; ++c) interaction.push_back(Effect());
    }
    for (SeedOutcome& seed : result_.seeds) {
      const double of_seed = Effect();
      for (int c = 0; c < shape_.controllers; ++c) {
        const double size =
            shape_.scatter_size * (1.0 - 0.2 * c) * (motions ? std::sqrt(0.5) : 1.0);
        double value = kSharedScatter * of_seed + size * Effect();
        if (motions) {
          value +=
              kSharedScatter * of_motion[static_cast<std::size_t>(seed.motion)] +
              size * interaction[static_cast<std::size_t>(seed.motion * shape_.controllers + c)];
        }
        seed.controllers[static_cast<std::size_t>(c)].scores.summary[metric] =
            means[static_cast<std::size_t>(c)] + d * value;
      }
    }
  }

  void Count(const Summary& summary) {
    const std::vector<int> motions = MotionsOf(result_);
    bool false_step = false, false_equal = false, false_other = false;
    for (std::size_t m = 0; m < Metrics().size(); ++m) {
      const bool is_primary = std::ranges::count(PrimaryScores(), m, &PrimaryScore::metric) > 0;
      for (std::size_t a = 0; a < truth_[m].size(); ++a) {
        for (std::size_t b = 0; b < a; ++b) {
          const double truth = truth_[m][a] - truth_[m][b];
          const double gain = Metrics()[m].lower_is_better ? -truth : truth;
          const double d = RelevantDifferenceBetween(Metrics()[m], truth_[m][a], truth_[m][b]);
          const auto& [difference, printed_d, judgement] = summary.Of(m, a, b);
          const bool wrong = (judgement == Judgement::kBetter && gain <= 0.0) ||
                             (judgement == Judgement::kWorse && gain >= 0.0);
          const bool matters = std::abs(truth) >= d * (1.0 - 1e-9);
          const bool wrongly_equal = judgement == Judgement::kEqual && std::abs(truth) >= printed_d;
          const MeanInterval interval =
              EstimateDifference(Values(m, a), Values(m, b), motions).IntervalAt(0.95);
          outcome_.coverage += interval.low <= truth && truth <= interval.high;
          ++pairs_;
          if (!is_primary) {
            false_other |= wrong || wrongly_equal;
            continue;
          }
          false_step |= wrong;
          false_equal |= wrongly_equal;
          auto& verdicts = outcome_.of_truth[truth == 0.0 ? 0 : matters ? 2 : 1];
          if (wrong || wrongly_equal) {
            ++verdicts.wrong;
          } else if (judgement == Judgement::kEqual) {
            ++verdicts.equal;
          } else if (judgement == Judgement::kUndecided) {
            ++verdicts.undecided;
          } else {
            ++verdicts.right;
          }
        }
      }
    }
    outcome_.false_better_worse += false_step;
    outcome_.false_equal += false_equal;
    outcome_.false_verdict += false_step || false_equal;
    outcome_.false_other += false_other;
  }

  std::vector<double> Values(std::size_t metric, std::size_t controller) const {
    std::vector<double> values;
    for (const SeedOutcome& seed : result_.seeds) {
      values.push_back(seed.controllers[controller].scores.summary[metric]);
    }
    return values;
  }

  ComparisonsOutcome Shares() const {
    ComparisonsOutcome shares = outcome_;
    shares.coverage /= pairs_;
    for (double* share : {&shares.false_better_worse, &shares.false_equal, &shares.false_verdict,
                          &shares.false_other}) {
      *share /= shape_.studies;
    }
    for (auto& [right, equal, undecided, wrong] : shares.of_truth) {
      const double all = right + equal + undecided + wrong;
      if (all == 0.0) continue;
      for (double* share : {&right, &equal, &undecided, &wrong}) *share /= all;
    }
    return shares;
  }

  const ComparisonsShape shape_;
  RandomStream random_;
  Study study_;
  StudyResult result_;
  std::vector<std::vector<double>> truth_;  // metrics x controllers
  ComparisonsOutcome outcome_;
  double pairs_ = 0.0;
};

}  // namespace

ComparisonsOutcome SimulateComparisons(const ComparisonsShape& shape) {
  return Simulation(shape).Run();
}

RecommendationOutcome SimulateRecommendations(const ComparisonsShape& shape, bool has_baseline) {
  return Simulation(shape).Recommend(has_baseline);
}

}  // namespace gauntlet::sim
