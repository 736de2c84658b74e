// Whatever threads there are, and whatever is known of a study already: the same scores.
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <map>
#include <mutex>
#include <utility>
#include <vector>

#include "sim/scenario/scenario_reader.h"
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

StudyOptions Options(int jobs, bool physics, TrialStore* store) {
  StudyOptions options;
  options.seeds = kSeeds;
  options.jobs = jobs;
  options.physics = physics;
  options.keep_first_traces = false;
  options.store = store;
  return options;
}

class AnySchedule : public ::testing::TestWithParam<bool> {};
INSTANTIATE_TEST_SUITE_P(WithAndWithoutHand, AnySchedule, ::testing::Bool(),
                         [](const auto& one) { return one.param ? "hand" : "filters"; });

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

}  // namespace
}  // namespace gauntlet::sim
