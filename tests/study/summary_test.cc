// What a comparison says of made-up scores whose answer is known.
#include "sim/study/summary.h"

#include <gtest/gtest.h>

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
    const double base[] = {5.0, 4.0, 5.5};
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
    EXPECT_TRUE(controller.worse_than_baseline.empty());
    EXPECT_TRUE(controller.difference_to_baseline.empty());
  }
}

TEST_F(SummaryTest, HoldsOthersAgainstTheBaselineThatIsNamed) {
  study_.scenario.baseline = "better";
  const Summary summary = Summarise(study_, result_);
  EXPECT_EQ(summary.baseline, 1u);
  EXPECT_TRUE(summary.controllers[0].worse_than_baseline[0]);  // raw against better
  EXPECT_TRUE(summary.controllers[1].difference_to_baseline.empty());
}

TEST_F(SummaryTest, PairingSeesADifferenceThatTheScatterOfSeedsWouldHide) {
  const Summary summary = Summarise(study_, result_);
  const ControllerSummary& worse = summary.controllers[2];
  // The intervals of the means overlap ...
  EXPECT_LT(worse.summary[0].ci95_low, summary.controllers[0].summary[0].ci95_high);
  // ... that of the paired difference does not reach zero.
  EXPECT_GT(worse.difference_to_baseline[0].ci95_low, 0.4);
  EXPECT_LT(worse.difference_to_baseline[0].ci95_high, 0.6);
  EXPECT_TRUE(worse.worse_than_baseline[0]);
  EXPECT_FALSE(summary.controllers[1].worse_than_baseline[0]);
}

TEST_F(SummaryTest, RanksAndMarksDominatedControllers) {
  const Summary summary = Summarise(study_, result_);
  EXPECT_EQ(summary.controllers[0].rank[0], 2);
  EXPECT_EQ(summary.controllers[1].rank[0], 1);
  EXPECT_EQ(summary.controllers[2].rank[0], 3);
  EXPECT_EQ(summary.dominated, (std::vector<bool>{true, false, true}));
}

TEST_F(SummaryTest, CallsAsGoodAsTheBestWhatChanceCannotTellFromIt) {
  for (SeedOutcome& seed : result_.seeds) {  // "worse" becomes "better" with a scatter of its own
    seed.controllers[2] = seed.controllers[1];
    seed.controllers[2].scores.summary[0] += 0.1 * std::cos(2.9 * seed.seed) + 0.005;
  }
  const Summary summary = Summarise(study_, result_);
  EXPECT_EQ(summary.controllers[1].rank[0], 1);
  EXPECT_FALSE(summary.controllers[0].as_good_as_best[0]);
  EXPECT_TRUE(summary.controllers[1].as_good_as_best[0]);
  EXPECT_TRUE(summary.controllers[2].as_good_as_best[0]);
}

TEST_F(SummaryTest, CallsNothingGoodThatHasNoValue) {
  for (SeedOutcome& seed : result_.seeds) seed.controllers[2].scores.summary[0] = std::nan("");
  EXPECT_FALSE(Summarise(study_, result_).controllers[2].as_good_as_best[0]);
}

TEST_F(SummaryTest, OnePairOfManySeedsDecidesNothing) {
  for (SeedOutcome& seed : result_.seeds) {
    if (seed.seed > 0) seed.controllers[2].scores.summary[0] = std::nan("");
  }
  const ControllerSummary worse = Summarise(study_, result_).controllers[2];
  EXPECT_EQ(worse.summary[0].count, 1);
  EXPECT_EQ(worse.summary[1].count, 10);
  EXPECT_GT(worse.difference_to_baseline[0].mean, 0.0);
  EXPECT_FALSE(worse.worse_than_baseline[0]);
}

TEST_F(SummaryTest, OneSeedDecidesNothing) {
  result_.seeds.resize(1);
  const Summary summary = Summarise(study_, result_);
  EXPECT_TRUE(summary.one_run);
  EXPECT_EQ(summary.controllers[1].rank[0], 1);
  for (const ControllerSummary& controller : summary.controllers) {
    EXPECT_FALSE(controller.as_good_as_best[0]);
    EXPECT_TRUE(std::isnan(controller.summary[0].ci95_low));
    EXPECT_TRUE(controller.name == "raw" || !controller.worse_than_baseline[0]);
  }
}

TEST_F(SummaryTest, RowsAreMeansOverSeeds) {
  const Summary summary = Summarise(study_, result_);
  EXPECT_NEAR(summary.controllers[0].rows[0][0], 2.0 * summary.controllers[0].summary[0].mean,
              1e-12);
}

TEST_F(SummaryTest, TellsTheFirstProblemOfAHand) {
  result_.seeds[3].controllers[1].health = {.ok = false, .problem = "at 1.5 s: diverged"};
  const Summary summary = Summarise(study_, result_);
  EXPECT_EQ(summary.controllers[0].problem, "");
  EXPECT_EQ(summary.controllers[1].problem, "at 1.5 s: diverged (seed 3)");
}

}  // namespace
}  // namespace gauntlet::sim
