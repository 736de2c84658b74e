// Early stop: the winner is that of all seeds, and most seeds are saved.
#include "sim/answers/sweep/early_stop.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

#include "sim/answers/sweep/sweep_tables.h"
#include "sim/base/random.h"
#include "tests/support/program.h"

namespace gauntlet::sim {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

SweepPlan PlanOf(int seeds) {
  SweepPlan plan;
  plan.file.seeds = seeds;
  plan.best_by = MetricIndex("tracking_rmse_deg");
  plan.metrics = {plan.best_by, MetricIndex("jitter_rms_deg")};
  return plan;
}

CellResult Made(const SweepPlan& plan, std::vector<double> tracking, double jitter = 0.0) {
  CellResult result;
  result.motions.assign(tracking.size(), 0);
  result.by_seed = {std::move(tracking), std::vector<double>(result.motions.size(), jitter)};
  result.scores.resize(2);
  KeepSeeds(plan, result.motions.size(), result);
  return result;
}

TEST(EarlyStop, LooksAtFixedNumbersOfSeeds) {
  EXPECT_THAT(LooksOf(3), IsEmpty());
  EXPECT_THAT(LooksOf(8), ElementsAre(3, 4, 6));
  EXPECT_THAT(LooksOf(30), ElementsAre(3, 4, 6, 8, 12, 16, 24));
}

TEST(EarlyStop, StopsWhatIsWorseFailsOrBreaksABound) {
  SweepPlan plan = PlanOf(16);
  plan.constraints = {ParseConstraint("jitter_rms_deg<=0.2", "")};
  std::vector<CellResult> alive = {
      Made(plan, {1.0, 1.1, 0.9, 1.0}, 0.1),  // leads
      Made(plan, {3.0, 3.2, 2.9, 3.0}, 0.1),  // worse, paired
      Made(plan, {1.1, 0.9, 1.0, 1.1}, 0.1),  // may still win
      Made(plan, {0.1, 0.1, 0.1, 0.1}, 0.5),  // breaks the bound: neither leads nor goes on
      Made(plan, {0.9, 0.9, 0.9, 0.9}, 0.1),
  };
  alive[4].problem = "diverged";
  EXPECT_THAT(CannotWin(plan, alive, alive.size(), 3), ElementsAre(false, true, false, true, true));
}

TEST(EarlyStop, KeepsTheLargestWhereThatIsBetter) {
  SweepPlan plan = PlanOf(16);
  plan.best_by = MetricIndex("sparc");
  plan.metrics[0] = plan.best_by;
  const std::vector<CellResult> alive = {Made(plan, {-5.0, -5.1, -5.0, -4.9}),
                                         Made(plan, {-2.0, -2.1, -2.0, -1.8})};
  EXPECT_THAT(CannotWin(plan, alive, 2, 3), ElementsAre(true, false));
}

double Normal(RandomStream& stream) {
  return std::sqrt(-2.0 * std::log(stream.UniformAboveZero())) *
         std::cos(2.0 * M_PI * stream.Uniform());
}

/// A sweep of a score with its least in the middle of the cells; every cell shares the effects of
/// seeds, and has noise of its own.
struct SimulatedStudy {
  std::size_t winner_of_all = 0;
  std::size_t winner = 0;
  int trials = 0;
};

SimulatedStudy Simulate(int number, int cells, int seeds, double noise) {
  RandomStream stream(20261122, "simulated sweep", static_cast<std::uint64_t>(number));
  const SweepPlan plan = PlanOf(seeds);
  const double best = stream.Uniform(0.2, 0.8);
  std::vector<CellResult> all;
  std::vector<double> of_seeds;
  for (int i = 0; i < seeds; ++i) of_seeds.push_back(3.0 * Normal(stream));
  for (int cell = 0; cell < cells; ++cell) {
    const double off = (cell + 0.5) / cells - best;
    std::vector<double> values;
    for (const double of_seed : of_seeds) {
      values.push_back(5.0 + 8.0 * off * off + of_seed + noise * Normal(stream));
    }
    all.push_back(Made(plan, values));
    all.back().number = cell;
  }
  const auto mean = [](const CellResult& result) { return result.scores.front().mean; };
  SimulatedStudy study;
  study.winner_of_all =
      static_cast<std::size_t>(std::ranges::min_element(all, {}, mean) - all.begin());
  const std::vector<int> looks = LooksOf(seeds);
  std::vector<CellResult> alive = all;
  int before = 0;
  for (const int look : looks) {
    study.trials += static_cast<int>(alive.size()) * (look - before);
    before = look;
    std::vector<CellResult> seen = alive;
    for (CellResult& result : seen) KeepSeeds(plan, static_cast<std::size_t>(look), result);
    const std::vector<bool> cannot = CannotWin(plan, seen, all.size(), looks.size());
    std::size_t i = 0;
    std::erase_if(alive, [&](const CellResult&) { return cannot[i++]; });
  }
  study.trials += static_cast<int>(alive.size()) * (seeds - before);
  study.winner = static_cast<std::size_t>(std::ranges::min_element(alive, {}, mean)->number);
  return study;
}

TEST(EarlyStop, FindsTheSameWinnerWithAtMostHalfOfTheTrials) {
  constexpr int kStudies = 100, kCells = 40, kSeeds = 32;
  for (const double noise : {0.05, 0.2}) {
    int same = 0;
    double trials = 0.0;
    for (int i = 0; i < kStudies; ++i) {
      const SimulatedStudy study = Simulate(i, kCells, kSeeds, noise);
      same += study.winner == study.winner_of_all;
      trials += study.trials;
    }
    EXPECT_GE(same, 95) << noise;
    EXPECT_LE(trials, 0.5 * kStudies * kCells * kSeeds) << noise;
    RecordProperty(fmt::format("same_winner_at_noise_{}", noise), same);
    RecordProperty(fmt::format("trials_percent_at_noise_{}", noise),
                   fmt::format("{:.1f}", trials / (0.01 * kStudies * kCells * kSeeds)));
  }
}

constexpr const char* kStudyFile = R"(
question: Which mean is best?
scenario: base.yaml
controllers: [mean, raw]
seeds: 8
physics: false
axes:
  - {key: glove.rate_hz, values: [500, 1000]}
  - {key: controllers.mean.filter.window, values: [1, 5, 0, 9, 60, 90]}
scores: [tracking_rmse_deg]
)";

class EarlyStoppedSweep : public testing::Test {
 protected:
  EarlyStoppedSweep() {
    std::ofstream(folder_.path() / "base.yaml")
        << "question: Does a sweep work?\n"
           "glove: {motion: {kind: random, duration_s: 0.3, bandwidth_hz: 2}}\n"
           "score: {noise_free_twin: false}\n"
           "controllers: {raw: {filter: none}, mean: {filter: {kind: moving_average}}}\n";
    std::ofstream(folder_.path() / "sweep.yaml") << kStudyFile;
  }

  SweepPlan Plan(bool all_seeds) const {
    SweepOverrides overrides;
    overrides.all_seeds = all_seeds;
    return LoadSweepPlan(folder_.path() / "sweep.yaml", overrides);
  }
  struct Outcome {
    std::string csv;
    SweepSummary summary;
    std::int64_t trials = 0;
  };
  Outcome Run(const SweepPlan& plan, const std::string& name, int jobs = 1, int shard = 1,
              int shards = 1) const {
    SweepDatabase database(folder_.path() / name, HashOfSweep(plan), plan.metrics);
    for (int i = 1; shards == 1 && i <= 2; ++i) {
      if (std::filesystem::exists(folder_.path() / fmt::format("{}.{}", name, i))) {
        database.Collect(folder_.path() / fmt::format("{}.{}", name, i));
      }
    }
    RunSweep(plan, database, {.jobs = jobs, .cells = ShardOf(plan, shard, shards)});
    Outcome outcome;
    outcome.summary = WriteCellsCsv(plan, database, ShardOf(plan, 1, 1),
                                    [&](std::string_view text) { outcome.csv += text; });
    outcome.trials = database.TrialCount();
    return outcome;
  }

  test::TemporaryDirectory folder_;
};

TEST_F(EarlyStoppedSweep, HasTheWinnerOfAllSeedsAndTheSameBytesForAnyWay) {
  const SweepPlan plan = Plan(false);
  const Outcome stopped = Run(plan, "stopped.db");
  const Outcome all = Run(Plan(true), "all.db");
  EXPECT_EQ(all.summary.stopped, 0);
  EXPECT_GT(stopped.summary.stopped, 0);
  EXPECT_LT(stopped.summary.stopped, stopped.summary.results);
  EXPECT_LT(stopped.trials, all.trials);
  EXPECT_EQ(stopped.summary.best.front().number, all.summary.best.front().number);
  EXPECT_EQ(stopped.summary.best.front().controller, all.summary.best.front().controller);
  EXPECT_FALSE(stopped.summary.best.front().stopped);
  EXPECT_EQ(Run(plan, "two.db", 2).csv, stopped.csv);
  EXPECT_EQ(Run(plan, "stopped.db").csv, stopped.csv);  // again
  // Shards stop by what they know; together they are what one machine makes.
  Run(plan, "merged.db.1", 1, 1, 2);
  Run(plan, "merged.db.2", 1, 2, 2);
  EXPECT_EQ(Run(plan, "merged.db").csv, stopped.csv);
  // All seeds that were asked for later, and then no more.
  EXPECT_EQ(Run(Plan(true), "stopped.db").csv, all.csv);
  EXPECT_EQ(Run(plan, "stopped.db").csv, stopped.csv);
}

TEST_F(EarlyStoppedSweep, GoesOnAfterAStop) {
  const SweepPlan plan = Plan(false);
  {
    SweepDatabase database(folder_.path() / "cut.db", HashOfSweep(plan), plan.metrics);
    int left = 40;
    EXPECT_THROW(RunSweep(plan, database,
                          {.cells = ShardOf(plan, 1, 1),
                           .progress = [&left](double, double) { return --left > 0; }}),
                 Cancelled);
  }
  EXPECT_EQ(Run(plan, "cut.db").csv, Run(plan, "whole.db").csv);
}

}  // namespace
}  // namespace gauntlet::sim
