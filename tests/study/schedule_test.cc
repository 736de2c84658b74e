// Whatever threads there are, and whatever is known of a study already: the same scores.
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <filesystem>
#include <map>
#include <mutex>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "sim/score/score.h"
#include "sim/study/scenario/scenario_reader.h"
#include "sim/study/trial_table/study_database.h"
#include "tests/support/program.h"

namespace gauntlet::sim {
namespace {

constexpr int kSeeds = 4;

Study FiveControllers(double duration_s = 0.3) {
  return PrepareStudy(
      ParseScenario({.file = "s.yaml",
                     .text = "question: Does it matter who made the glove?\nseed: 3\nglove:\n"
                             "  motion: {kind: random, duration_s: " +
                             std::to_string(duration_s) +
                             "}\ncontrollers:\n  raw: {filter: none}\n"
                             "  mean_2: {filter: {kind: moving_average, window: 2}}\n"
                             "  mean_5: {filter: {kind: moving_average, window: 5}}\n"
                             "  mean_9: {filter: {kind: moving_average, window: 9}}\n"
                             "  median: {filter: {kind: median, window: 5}}\n"}));
}

/// Trials in memory, of which each is taken once.
class Shelf final : public TrialStore {
 public:
  bool Has(int seed, std::size_t controller) override {
    const std::lock_guard lock(mutex_);
    return trials_.contains({seed, controller});
  }
  std::optional<TrialOutcome> Take(int seed, std::size_t controller) override {
    const std::lock_guard lock(mutex_);
    auto trial = trials_.extract({seed, controller});
    if (trial.empty()) return std::nullopt;
    return std::move(trial.mapped());
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

enum class Way { kHand, kFilters, kTrackingOfFilters };

StudyOptions Options(int jobs, Way way, TrialStore* store) {
  StudyOptions options;
  options.seeds = kSeeds;
  options.jobs = jobs;
  options.physics = way == Way::kHand;
  if (way == Way::kTrackingOfFilters) options.scores = {MetricIndex("tracking_rmse_deg")};
  options.keep_first_traces = false;
  options.store = store;
  return options;
}

std::string NameOf(const ::testing::TestParamInfo<Way>& one) {
  const char* const names[] = {"hand", "filters", "tracking_of_filters"};
  return names[static_cast<int>(one.param)];
}
class AnySchedule : public ::testing::TestWithParam<Way> {};
INSTANTIATE_TEST_SUITE_P(Each, AnySchedule,
                         ::testing::Values(Way::kHand, Way::kFilters, Way::kTrackingOfFilters),
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
        const TrialOutcome outcome = *all.Take(seed, controller);
        all.Keep(seed, controller, outcome);
        some.Keep(seed, controller, outcome);
      }
      EXPECT_EQ(BitsOf(RunStudy(study, Options(jobs, GetParam(), &some))), alone) << jobs;
      EXPECT_EQ(some.kept(), kSeeds * 5);
    }
  }
}

/// All numbers of so many bits; of many bits those that begin and end seeds of four controllers.
std::vector<int> MasksOf(int bits) {
  std::vector<int> masks;
  for (int mask = 0; mask < 1 << std::min(bits, 6); ++mask) {
    if (bits <= 6) masks.push_back(mask);
    constexpr int kSeed[] = {0b0000, 0b0001, 0b1000, 0b1111};
    if (bits > 6)
      masks.push_back(kSeed[mask & 3] | kSeed[mask >> 2 & 3] << 4 | kSeed[mask >> 4] << 8);
  }
  return masks;
}

// Choices of trials that are known, of few controllers and seeds.
TEST(ScheduleOfKnownTrials, RunsEachOtherTrialOnce) {
  Study study = FiveControllers(0.02);
  const std::vector<NamedController> five = study.scenario.controllers;
  const TrialOutcome made_up = {
      .scores = NoScores(study.rows), .health = {}, .untrusted_samples = {}};
  for (const auto& [controllers, seeds] : {std::pair(2, 3), std::pair(3, 2), std::pair(4, 3)}) {
    study.scenario.controllers.assign(five.begin(), five.begin() + controllers);
    const int trials = controllers * seeds;
    for (const int mask : MasksOf(trials)) {
      for (const int jobs : {1, 2, 3}) {
        Shelf store;
        for (int i = 0; i < trials; ++i) {
          if ((mask >> i & 1) != 0) store.Keep(3 + i / controllers, i % controllers, made_up);
        }
        StudyOptions options = Options(jobs, Way::kTrackingOfFilters, &store);
        options.seeds = seeds;
        RunStudy(study, options);
        ASSERT_EQ(store.kept(), trials)
            << controllers << " controllers, " << jobs << " jobs, known: " << mask;
      }
    }
  }
}

/// The database of a comparison, and which trials it got.
class Watched final : public TrialStore {
 public:
  Watched(const std::filesystem::path& file, const Study& study)
      : database_(file, study, {.seeds = kSeeds}), study_(study) {}
  bool Has(int seed, std::size_t controller) override { return database_.Has(seed, controller); }
  std::optional<TrialOutcome> Take(int seed, std::size_t controller) override {
    return database_.Take(seed, controller);
  }
  void Keep(int seed, std::size_t controller, const TrialOutcome& outcome) override {
    database_.Keep(seed, controller, outcome);
    const std::lock_guard lock(mutex_);
    kept_.emplace(seed, study_.scenario.controllers[controller].name);
  }
  const std::multiset<std::pair<int, std::string>>& kept() const { return kept_; }

 private:
  StudyDatabase database_;
  const Study& study_;
  std::mutex mutex_;
  std::multiset<std::pair<int, std::string>> kept_;
};

// Of a, b, c and d that are known: every order of a, b, a changed c and a new controller, and of
// some of them.
TEST(KeptTrials, StayWhateverControllersAreAddedRemovedChangedAndMoved) {
  const test::TemporaryDirectory folder;
  const std::filesystem::path before = folder.path() / "before.db";
  const std::filesystem::path file = folder.path() / "study.db";
  Study study = FiveControllers(0.02);
  std::vector<NamedController>& controllers = study.scenario.controllers;
  NamedController added = controllers.back();
  controllers.pop_back();
  {
    Watched database(before, study);
    RunStudy(study, Options(1, Way::kTrackingOfFilters, &database));
  }
  NamedController changed = controllers[2];
  changed.config.filter_at = controller::FilterAt::kEvent;
  const std::vector<NamedController> choice = {controllers[0], controllers[1], changed, added};
  std::set<std::vector<int>> lists;
  for (std::vector<int> order = {0, 1, 2, 3}; lists.size() < 64;) {
    for (auto end = order.begin() + 1; end <= order.end(); ++end) lists.emplace(order.begin(), end);
    std::ranges::next_permutation(order);
  }
  for (const std::vector<int>& list : lists) {
    controllers.clear();
    std::multiset<std::pair<int, std::string>> unknown;
    for (const int place : list) {
      controllers.push_back(choice[place]);
      for (int i = 0; place >= 2 && i < kSeeds; ++i) unknown.emplace(3 + i, choice[place].name);
    }
    for (const int jobs : {1, 2, 3}) {
      std::filesystem::copy_file(before, file, std::filesystem::copy_options::overwrite_existing);
      Watched database(file, study);
      RunStudy(study, Options(jobs, Way::kTrackingOfFilters, &database));
      ASSERT_EQ(database.kept(), unknown) << testing::PrintToString(list) << ", jobs: " << jobs;
    }
  }
}

// Many controllers of a seed, and each by itself.
TEST(AnyNumberOfControllers, GivesEachItsOwnScores) {
  Study study = FiveControllers();
  const NamedController raw = study.scenario.controllers[0];
  study.scenario.controllers.clear();
  for (int window = 1; window <= 37; ++window) {
    NamedController& mean = study.scenario.controllers.emplace_back(raw);
    mean.name = "mean_" + std::to_string(window);
    mean.config.filters = {{controller::MovingAverageConfig{.window = window}}};
  }
  const StudyResult together = RunStudy(study, Options(1, Way::kTrackingOfFilters, nullptr));
  for (const int jobs : {2, 3, 40}) {
    EXPECT_EQ(BitsOf(RunStudy(study, Options(jobs, Way::kTrackingOfFilters, nullptr))),
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
