// What a comparison says of made-up scores whose answer is known.
#include "sim/answers/compare/summary.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace gauntlet::sim {
namespace {

/// Three controllers, ten seeds; every metric of a controller is `base + seed effect`, the seed
/// effect being the same for all, as it is for paired trials.
class SummaryTest : public testing::Test {
 protected:
  SummaryTest() {
    study_.scenario.controllers = {{.name = "raw", .config = {}},
                                   {.name = "better", .config = {}},
                                   {.name = "worse", .config = {}}};
    controller::FilterConfig filter;
    filter.settings = controller::MovingAverageConfig{};
    study_.scenario.controllers[1].config.filters = {filter};
    study_.scenario.controllers[2].config.filters = {filter};
    result_.controller_names = {"raw", "better", "worse"};
    result_.row_names = {"only"};
    const double base[] = {5.0, 4.0, 5.55};  // a difference of 0.5 deg matters
    for (int s = 0; s < 10; ++s) {
      SeedOutcome seed{.seed = s, .controllers = {}};
      for (int c = 0; c < 3; ++c) {
        // A wiggle of each controller by itself, smaller than the differences.
        const double value = base[c] + 0.8 * std::sin(1.7 * s) + 0.05 * std::cos(3.1 * s + c);
        TrialOutcome trial;
        trial.scores.summary.assign(Metrics().size(), value);
        trial.scores.channels = {std::vector<double>(Metrics().size(), 2.0 * value)};
        seed.controllers.push_back(trial);
      }
      result_.seeds.push_back(seed);
    }
  }

  Study study_;
  StudyResult result_;
};

TEST_F(SummaryTest, WithoutABaselineNothingIsWorse) {
  EXPECT_EQ(Summarise(study_, result_).baseline, 0u);
  study_.scenario.controllers[0].config.filters = study_.scenario.controllers[1].config.filters;
  const Summary summary = Summarise(study_, result_);
  EXPECT_EQ(summary.baseline, std::nullopt);
  for (const ControllerSummary& controller : summary.controllers) {
    EXPECT_EQ(controller.AgainstBaseline(0), Judgement::kNone);
    EXPECT_TRUE(controller.to_baseline.empty());
  }
  EXPECT_EQ(summary.Of(0, 0, 1).judgement, Judgement::kWorse);  // that needs none
  EXPECT_EQ(summary.MarkOf(0, 0), ' ');
}

TEST_F(SummaryTest, HoldsOthersAgainstTheBaselineThatIsNamed) {
  study_.scenario.baseline = "better";
  const Summary summary = Summarise(study_, result_);
  EXPECT_EQ(summary.baseline, 1u);
  EXPECT_EQ(summary.MarkOf(0, 0), '!');  // raw against better
  EXPECT_TRUE(summary.controllers[1].to_baseline.empty());
}

TEST_F(SummaryTest, PairingSeesADifferenceThatTheScatterOfSeedsWouldHide) {
  const Summary summary = Summarise(study_, result_);
  const ControllerSummary& worse = summary.controllers[2];
  // The intervals of the means overlap ...
  EXPECT_LT(worse.summary[0].low, summary.controllers[0].summary[0].high);
  // ... that of the paired difference does not reach zero.
  EXPECT_GT(worse.to_baseline[0].difference.low, 0.35);
  EXPECT_LT(worse.to_baseline[0].difference.high, 0.75);
  EXPECT_EQ(worse.AgainstBaseline(0), Judgement::kWorse);
  EXPECT_EQ(summary.controllers[1].AgainstBaseline(0), Judgement::kBetter);
}

TEST_F(SummaryTest, CallsEqualWhatDiffersByNothingThatMatters) {
  for (SeedOutcome& seed : result_.seeds) {  // "worse" becomes "better" with a scatter of its own
    seed.controllers[2] = seed.controllers[1];
    seed.controllers[2].scores.summary[0] += 0.1 * std::cos(2.9 * seed.seed) + 0.005;
  }
  const Summary summary = Summarise(study_, result_);
  EXPECT_EQ(summary.Of(0, 1, 2).judgement, Judgement::kEqual);
  EXPECT_EQ(summary.MarkOf(1, 0), '*');
  EXPECT_EQ(summary.MarkOf(2, 0), '*');
}

TEST_F(SummaryTest, CallsUndecidedWhatChanceMayHaveMade) {
  for (SeedOutcome& seed : result_.seeds) {  // a difference that would matter, and more scatter
    seed.controllers[2] = seed.controllers[1];
    seed.controllers[2].scores.summary[0] += 0.6 + 1.5 * std::cos(2.9 * seed.seed);
  }
  const Summary summary = Summarise(study_, result_);
  EXPECT_EQ(summary.Of(0, 2, 1).judgement, Judgement::kUndecided);
  const MeanInterval& difference = summary.Of(0, 2, 1).difference;
  EXPECT_LT(difference.low, 0.0);
  EXPECT_GT(difference.high, 0.5);
}

TEST_F(SummaryTest, OfSeveralMotionsTheseAreWhatRepeats) {
  const MeanInterval of_noise = Summarise(study_, result_).Of(0, 0, 1).difference;
  for (SeedOutcome& seed : result_.seeds) seed.motion = seed.seed % 3;
  const Summary summary = Summarise(study_, result_);
  EXPECT_EQ(summary.motions, 3);
  const MeanInterval of_motions = summary.Of(0, 0, 1).difference;
  EXPECT_NEAR(of_motions.mean, of_noise.mean, 0.05);
  EXPECT_GT(of_motions.high - of_motions.low, 2.0 * (of_noise.high - of_noise.low));
  EXPECT_GE(of_motions.motion_share, 0.0);
  EXPECT_TRUE(std::isnan(of_noise.motion_share));
}

TEST_F(SummaryTest, EveryPairHasOneIntervalWhoeverItIsShownAgainst) {
  study_.scenario.baseline = "better";  // which is the best, too
  const Summary summary = Summarise(study_, result_);
  EXPECT_EQ(summary.pairs, 3 * std::ssize(Metrics()));
  for (const std::size_t c : {0U, 2U}) {
    const ControllerSummary& controller = summary.controllers[c];
    EXPECT_EQ(controller.to_baseline[0].difference.low, -summary.Of(0, 1, c).difference.high);
    EXPECT_EQ(summary.Of(0, 1, c).judgement, Judgement::kBetter);
    EXPECT_EQ(summary.Of(0, c, 1).judgement, Judgement::kWorse);
  }
}

TEST_F(SummaryTest, OfEqualValuesAllAreAsGood) {
  for (SeedOutcome& seed : result_.seeds) {
    for (TrialOutcome& trial : seed.controllers) trial.scores.summary.assign(Metrics().size(), 0.0);
  }
  const Summary summary = Summarise(study_, result_);
  for (const ControllerSummary& controller : summary.controllers) {
    for (std::size_t m = 0; m < Metrics().size(); ++m) {
      if (controller.to_baseline.empty()) continue;
      EXPECT_EQ(controller.AgainstBaseline(m), Judgement::kEqual) << Metrics()[m].key;
    }
  }
}

TEST_F(SummaryTest, OneFarSeedOfEightDecidesNothing) {
  result_.seeds.resize(8);
  for (SeedOutcome& seed : result_.seeds) seed.controllers[2] = seed.controllers[0];
  result_.seeds[5].controllers[2].scores.summary[0] += 130.0;
  const Summary summary = Summarise(study_, result_);
  EXPECT_EQ(summary.controllers[2].to_baseline[0].judgement, Judgement::kUndecided);
  EXPECT_EQ(summary.Of(0, 0, 1).judgement, Judgement::kWorse);
}

TEST_F(SummaryTest, ThePrimaryScoresAreAFamilyOfTheirOwn) {
  const Summary summary = Summarise(study_, result_);
  EXPECT_EQ(summary.primary_pairs, 3 * 3);
  const double others = 3.0 * static_cast<double>(Metrics().size() - 3);
  for (std::size_t m = 0; m < Metrics().size(); ++m) {
    const bool is_primary = std::ranges::count(PrimaryScores(), m, &PrimaryScore::metric) > 0;
    EXPECT_DOUBLE_EQ(summary.Of(m, 0, 1).difference.level,
                     1.0 - 0.05 / (is_primary ? 9.0 : others));
  }
}

TEST_F(SummaryTest, BlocksOfARecordingAreTheReplicates) {
  result_.seeds.resize(1);
  RecordingBlocks blocks;
  blocks.plan = PlanBlocks(40.0, 1.0);
  blocks.values.assign(3, std::vector<std::vector<double>>(Metrics().size()));
  for (int block = 0; block < blocks.plan.count; ++block) {
    blocks.blocks.push_back({5.0 * block, 5.0 * (block + 1)});
    const double noise = 0.01 * (block % 3);
    for (std::size_t c = 0; c < 3; ++c) {
      blocks.values[c][0].push_back(5.0 - static_cast<double>(c) + 10.0 * noise +
                                    static_cast<double>(c) * noise);
    }
  }
  const std::size_t peak = MetricIndex("peak_error_deg");
  const Summary alone = Summarise(study_, result_);
  EXPECT_TRUE(alone.one_run);
  EXPECT_TRUE(std::isnan(alone.Of(0, 0, 1).difference.low));
  const Summary summary = Summarise(study_, result_, blocks);
  EXPECT_FALSE(summary.one_run);
  EXPECT_EQ(summary.controllers[0].summary[0].count, 8);
  EXPECT_EQ(summary.Of(0, 0, 1).judgement, Judgement::kWorse);
  const MeanInterval expected =
      EstimateDifference(blocks.values[0][0], blocks.values[1][0]).IntervalAt(1.0 - 0.05 / 3.0);
  EXPECT_DOUBLE_EQ(summary.Of(0, 0, 1).difference.low, expected.low);  // a family of 3 pairs
  EXPECT_EQ(summary.primary_pairs, 3);
  EXPECT_EQ(summary.Of(peak, 0, 1).judgement, Judgement::kNone);  // has no values of blocks
  EXPECT_DOUBLE_EQ(summary.controllers[0].summary[peak].mean,
                   alone.controllers[0].summary[peak].mean);
  const std::vector<std::string> doubts = summary.answer.verdict.Doubts();
  EXPECT_EQ(std::ranges::count(doubts,
                               "The confidence intervals are from 8 blocks of 5.0 s of this "
                               "recording: one session of one person. They are too narrow if "
                               "it has few fast movements."),
            1);
}

TEST_F(SummaryTest, TwoSeedsDecideOnlyWhatIsPlain) {
  result_.seeds.resize(2);
  const Summary summary = Summarise(study_, result_);
  EXPECT_FALSE(summary.one_run);
  const Comparison& comparison = summary.controllers[2].to_baseline[0];
  EXPECT_EQ(comparison.judgement, Judgement::kUndecided);
  EXPECT_LT(comparison.difference.low, 0.0);
}

TEST_F(SummaryTest, OneControllerIsComparedWithNobody) {
  study_.scenario.controllers.resize(1);
  result_.controller_names.resize(1);
  for (SeedOutcome& seed : result_.seeds) seed.controllers.resize(1);
  const Summary summary = Summarise(study_, result_);
  EXPECT_EQ(summary.pairs, 0);
  EXPECT_TRUE(summary.controllers[0].has_score[0]);
  EXPECT_EQ(summary.MarkOf(0, 0), ' ');
  EXPECT_TRUE(std::isfinite(summary.controllers[0].summary[0].low));
}

TEST_F(SummaryTest, CallsNothingGoodThatHasNoValue) {
  for (SeedOutcome& seed : result_.seeds) seed.controllers[2].scores.summary[0] = std::nan("");
  EXPECT_EQ(Summarise(study_, result_).MarkOf(2, 0), ' ');
}

TEST_F(SummaryTest, OnePairOfManySeedsDecidesNothing) {
  for (SeedOutcome& seed : result_.seeds) {
    if (seed.seed > 0) seed.controllers[2].scores.summary[0] = std::nan("");
  }
  const ControllerSummary worse = Summarise(study_, result_).controllers[2];
  EXPECT_EQ(worse.summary[0].count, 1);
  EXPECT_EQ(worse.summary[1].count, 10);
  EXPECT_GT(worse.to_baseline[0].difference.mean, 0.0);
  EXPECT_EQ(worse.to_baseline[0].judgement, Judgement::kUndecided);
}

TEST_F(SummaryTest, OneSeedDecidesNothing) {
  result_.seeds.resize(1);
  const Summary summary = Summarise(study_, result_);
  EXPECT_TRUE(summary.one_run);
  for (const ControllerSummary& controller : summary.controllers) {
    EXPECT_TRUE(std::isnan(controller.summary[0].low));
    EXPECT_EQ(controller.AgainstBaseline(0), Judgement::kNone);
  }
}

TEST_F(SummaryTest, RowsAreMeansOverSeeds) {
  const Summary summary = Summarise(study_, result_);
  EXPECT_NEAR(summary.controllers[0].rows[0][0], 2.0 * summary.controllers[0].summary[0].mean,
              1e-12);
}

TEST_F(SummaryTest, DoesNotRankAControllerOfWhichATrialFailed) {
  for (const std::size_t seed : {3U, 7U}) {
    TrialOutcome& trial = result_.seeds[seed].controllers[1];
    trial.health = {.ok = false, .problem = seed == 3 ? "at 1.5 s: diverged" : "at 2 s: other"};
    trial.scores.summary.assign(Metrics().size(), std::nan(""));
  }
  const Summary summary = Summarise(study_, result_);
  const ControllerSummary& failed = summary.controllers[1];
  EXPECT_EQ(summary.controllers[0].problem, "");
  EXPECT_EQ(failed.problem, "at 1.5 s: diverged (seed 3)");
  EXPECT_EQ(failed.failed_trials, 2);
  EXPECT_EQ(Failures(summary, 10),
            (std::vector<std::string>{"better failed in 2 of 10 trials and is not ranked: at 1.5 "
                                      "s: diverged (seed 3)"}));
  for (std::size_t m = 0; m < Metrics().size(); ++m) {
    EXPECT_FALSE(failed.has_score[m]);
    EXPECT_EQ(failed.AgainstBaseline(m), Judgement::kNone);
  }
  EXPECT_TRUE(summary.controllers[0].has_score[0]);
  EXPECT_EQ(summary.pairs, std::ssize(Metrics()));
}

TEST_F(SummaryTest, HoldsNobodyAgainstABaselineOfWhichATrialFailed) {
  result_.seeds[0].controllers[0].health = {.ok = false, .problem = "at 1.5 s: diverged"};
  const Summary summary = Summarise(study_, result_);
  EXPECT_EQ(summary.baseline, 0u);
  for (const Comparison& comparison : summary.controllers[2].to_baseline) {
    EXPECT_EQ(comparison.judgement, Judgement::kNone);
  }
}

}  // namespace
}  // namespace gauntlet::sim
