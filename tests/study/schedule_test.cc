// Whatever threads there are, and whatever is known of a study already: the same scores.
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <map>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "sim/scenario/scenario_reader.h"
#include "sim/score/score.h"
#include "sim/study/study_run.h"

namespace gauntlet::sim {
namespace {

constexpr int kSeeds = 4;

Study FiveControllers() {
  return PrepareStudy(ParseScenario(
      {.file = "s.yaml",
       .text = "question: Does it matter who made the glove?\nseed: 3\nglove:\n"
               "  motion: {kind: random, duration_s: 0.3}\ncontrollers:\n  raw: {filter: none}\n"
               "  mean_2: {filter: {kind: moving_average, window: 2}}\n"
               "  mean_5: {filter: {kind: moving_average, window: 5}}\n"
               "  mean_9: {filter: {kind: moving_average, window: 9}}\n"
               "  median: {filter: {kind: median, window: 5}}\n"}));
}

/// Trials in memory.
class Shelf final : public TrialStore {
 public:
  std::optional<TrialOutcome> Take(int seed, std::size_t controller) override {
    const std::lock_guard lock(mutex_);
    const auto place = trials_.find({seed, controller});
    if (place == trials_.end()) return std::nullopt;
    return place->second;
  }
  void Keep(int seed, std::size_t controller, const TrialOutcome& outcome) override {
    const std::lock_guard lock(mutex_);
    ++kept_;
    trials_[{seed, controller}] = outcome;
  }
  int kept() const { return kept_; }

 private:
  std::mutex mutex_;
  std::map<std::pair<int, std::size_t>, TrialOutcome> trials_;
  int kept_ = 0;
};

using Bits = std::vector<std::uint64_t>;

/// The scores of all trials, bit by bit.
Bits BitsOf(const StudyResult& result) {
  Bits bits;
  for (const SeedOutcome& seed : result.seeds) {
    for (const TrialOutcome& outcome : seed.controllers) {
      for (const double score : outcome.scores.summary) {
        bits.push_back(std::bit_cast<std::uint64_t>(score));
      }
    }
  }
  return bits;
}

enum class Way { kHand, kFilters, kFiltersInPassing };

StudyOptions Options(int jobs, Way way, TrialStore* store) {
  StudyOptions options;
  options.seeds = kSeeds;
  options.jobs = jobs;
  options.physics = way == Way::kHand;
  if (way == Way::kFiltersInPassing) options.scores = {MetricIndex("tracking_rmse_deg")};
  options.keep_first_traces = false;
  options.store = store;
  return options;
}

std::string NameOf(const ::testing::TestParamInfo<Way>& one) {
  const char* const names[] = {"hand", "filters", "filters_in_passing"};
  return names[static_cast<int>(one.param)];
}
class AnySchedule : public ::testing::TestWithParam<Way> {};
INSTANTIATE_TEST_SUITE_P(Each, AnySchedule,
                         ::testing::Values(Way::kHand, Way::kFilters, Way::kFiltersInPassing),
                         NameOf);

TEST_P(AnySchedule, GivesTheSameScores) {
  const Study study = FiveControllers();
  const Bits alone = BitsOf(RunStudy(study, Options(1, GetParam(), nullptr)));
  for (const int jobs : {2, 3, 7}) {
    EXPECT_EQ(BitsOf(RunStudy(study, Options(jobs, GetParam(), nullptr))), alone) << jobs;
  }
}

// A seed that is known whole needs no glove, one of which the first trial is known may need one.
TEST_P(AnySchedule, RunsWhatIsNotKnownAndNothingElse) {
  const Study study = FiveControllers();
  Shelf all;
  const Bits alone = BitsOf(RunStudy(study, Options(1, GetParam(), &all)));
  ASSERT_EQ(all.kept(), kSeeds * 5);
  const std::vector<std::vector<std::pair<int, std::size_t>>> known = {
      {{4, 0}},
      {{4, 0}, {4, 1}, {4, 2}, {4, 3}, {4, 4}},
      {{4, 1}, {4, 2}, {4, 3}, {4, 4}, {6, 4}},
      {{3, 3}, {3, 4}, {5, 0}, {6, 0}, {6, 1}, {6, 2}, {6, 3}, {6, 4}}};
  for (const auto& trials : known) {
    for (const int jobs : {1, 2, 3}) {
      Shelf some;
      for (const auto& [seed, controller] : trials) {
        some.Keep(seed, controller, *all.Take(seed, controller));
      }
      EXPECT_EQ(BitsOf(RunStudy(study, Options(jobs, GetParam(), &some))), alone) << jobs;
      EXPECT_EQ(some.kept(), kSeeds * 5);
    }
  }
}

// Controllers of a seed that run together, more or fewer at once, and each by itself.
TEST(SchedulePassing, GivesEachControllerItsOwnScores) {
  Study study = FiveControllers();
  const NamedController raw = study.scenario.controllers[0];
  study.scenario.controllers.clear();
  for (int window = 1; window <= 37; ++window) {
    NamedController& mean = study.scenario.controllers.emplace_back(raw);
    mean.name = "mean_" + std::to_string(window);
    mean.config.filters = {{controller::MovingAverageConfig{.window = window}}};
  }
  const StudyResult together = RunStudy(study, Options(1, Way::kFiltersInPassing, nullptr));
  for (const int jobs : {2, 3, 40}) {
    EXPECT_EQ(BitsOf(RunStudy(study, Options(jobs, Way::kFiltersInPassing, nullptr))),
              BitsOf(together))
        << jobs;
  }
  const std::size_t tracking = MetricIndex("tracking_rmse_deg");
  Study alone = study;
  for (const std::size_t c : {0, 15, 16, 36}) {
    alone.scenario.controllers = {study.scenario.controllers[c]};
    const StudyResult whole = RunStudy(alone, Options(1, Way::kFilters, nullptr));
    for (int i = 0; i < kSeeds; ++i) {
      const TrialOutcome& outcome = together.seeds[i].controllers[c];
      EXPECT_EQ(outcome.scores.summary[tracking],
                whole.seeds[i].controllers[0].scores.summary[tracking])
          << c;
      EXPECT_EQ(outcome.untrusted_samples, whole.seeds[i].controllers[0].untrusted_samples);
    }
  }
}

}  // namespace
}  // namespace gauntlet::sim
