// The noise-free twin of a trial is the same trial without the glove's noise and faults, and what
// is scored against it is the noise's.
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <fstream>
#include <string>
#include <vector>

#include "sim/study/scenario/scenario.h"
#include "sim/study/scenario/scenario_reader.h"
#include "sim/study/study_run.h"
#include "sim/study/trial_table/study_database.h"
#include "tests/support/program.h"

namespace gauntlet::sim {
namespace {

/// Five sensors at 33.3 Hz, with tremor, noise of every kind and faults; no controller is raw, and
/// r is given, as its default is the scenario's noise.
Scenario SlowGlove(const std::string& more_of_glove = "", double duration_s = 0.8) {
  return ParseScenario(
      {.file = "s.yaml",
       .text = "question: What does noise do?\nseed: 7\nglove:\n  rate_hz: 33.3\n"
               "  channels: [thumb_ip, index_pip, middle_pip, ring_pip, little_pip]\n"
               "  motion: {kind: random, duration_s: " +
               std::to_string(duration_s) +
               "}\n"
               "  tremor: {rms_deg: 1}\n" +
               (more_of_glove.empty()
                    ? "  noise: {pink_variance_counts2: 9}\n"
                      "  faults: [spikes, {kind: stuck, channels: [index_pip], start_s: 0.5}]\n"
                    : more_of_glove) +
               "controllers:\n"
               "  mean:\n    filter: {kind: moving_average, window: 3}\n"
               "  kalman:\n    filter: {kind: kalman, q: 0.1, r: 20}\n"});
}

StudyOptions Seeds(int seeds, int jobs = 2) {
  StudyOptions options;
  options.seeds = seeds;
  options.jobs = jobs;
  return options;
}

bool SameBits(const std::vector<double>& a, const std::vector<double>& b) {
  return std::ranges::equal(a, b, [](double x, double y) {
    return std::bit_cast<std::uint64_t>(x) == std::bit_cast<std::uint64_t>(y);
  });
}

double Score(const TrialOutcome& outcome, std::string_view metric) {
  return outcome.scores.summary[MetricIndex(metric)];
}

TEST(NoiseFreeTwin, IsTheTrialThatRunsWithoutNoise) {
  const StudyResult noisy = RunStudy(PrepareStudy(SlowGlove()), Seeds(1));
  Scenario quiet_scenario = SlowGlove();
  quiet_scenario.glove = WithoutNoise(quiet_scenario.glove);
  const StudyResult quiet = RunStudy(PrepareStudy(quiet_scenario), Seeds(1));
  EXPECT_EQ(noisy.first_glove->true_angle_rad, quiet.first_glove->true_angle_rad);
  ASSERT_EQ(noisy.first_twins.size(), 2u);
  for (std::size_t c = 0; c < 2; ++c) {
    ASSERT_TRUE(noisy.first_twins[c]);
    const Trace& alone = quiet.first_traces[c];
    EXPECT_EQ(noisy.first_twins[c]->hand_angle_rad, alone.hand_angle_rad);
    EXPECT_EQ(noisy.first_twins[c]->spool_speed_rad_s, alone.spool_speed_rad_s);
    EXPECT_NE(noisy.first_traces[c].hand_angle_rad, alone.hand_angle_rad);
  }
}

TEST(NoiseFreeTwin, WhereThereIsNoNoiseTheTrialIsItsOwnAndNoiseScoresZero) {
  const Study study = PrepareStudy(SlowGlove("  noise: {variance_scale: 0}\n", 1.6));
  EXPECT_EQ(TwinOf(study, 7), TwinSource::kItself);
  EXPECT_EQ(TrialCount(study, 3), 6);
  const StudyResult result = RunStudy(study, Seeds(2));
  for (const SeedOutcome& seed : result.seeds) {
    for (const TrialOutcome& outcome : seed.controllers) {
      EXPECT_EQ(Score(outcome, "noise_jitter_rms_deg"), 0.0);
      EXPECT_EQ(Score(outcome, "motor_noise_rms_deg_s"), 0.0);
    }
  }
  EXPECT_EQ(result.first_twins[1]->hand_angle_rad, result.first_traces[1].hand_angle_rad);
}

TEST(NoiseFreeTwin, CanBeLeftOut) {
  Scenario scenario = SlowGlove();
  scenario.score.noise_free_twin = false;
  const Study study = PrepareStudy(scenario);
  EXPECT_EQ(TrialCount(study, 4), 8);
  const StudyResult without = RunStudy(study, Seeds(1));
  const StudyResult with = RunStudy(PrepareStudy(SlowGlove()), Seeds(1));
  for (std::size_t c = 0; c < 2; ++c) {
    EXPECT_FALSE(without.first_twins[c]);
    const TrialOutcome& outcome = without.seeds[0].controllers[c];
    EXPECT_TRUE(std::isnan(Score(outcome, "noise_jitter_rms_deg")));
    EXPECT_EQ(Score(outcome, "tracking_rmse_deg"),
              Score(with.seeds[0].controllers[c], "tracking_rmse_deg"));
  }
}

TEST(NoiseFreeTwin, ARecordedGloveHasNone) {
  const test::TemporaryDirectory folder;
  const std::string file = folder.path() / "glove.csv";
  std::ofstream table(file);
  table << "time_s,index_pip,ring_pip\n";
  for (int k = 0; k < 100; ++k) table << 0.02 * k << "," << 40 + k % 7 << "," << 50 - k % 5 << "\n";
  table.close();
  const Study study = PrepareStudy(ParseScenario(
      {.file = "s.yaml",
       .text = "question: Counts?\nglove:\n  channels: [index_pip, ring_pip]\n  motion: {kind: "
               "recording, use: measured, file: " +
               file + "}\n  noise: none\ncontrollers:\n  raw:\n    filter: none\n"}));
  EXPECT_EQ(TwinOf(study, 1), TwinSource::kNone);
  const StudyResult result = RunStudy(study, Seeds(1));
  EXPECT_FALSE(result.first_twins[0]);
  EXPECT_TRUE(std::isnan(Score(result.seeds[0].controllers[0], "noise_jitter_rms_deg")));
}

TEST(NoiseFreeTwin, ManyThreadsGiveTheSameBits) {
  const Study study = PrepareStudy(SlowGlove());
  const StudyResult one = RunStudy(study, Seeds(2, 1));
  const StudyResult three = RunStudy(study, Seeds(2, 3));
  for (std::size_t s = 0; s < 2; ++s) {
    for (std::size_t c = 0; c < 2; ++c) {
      EXPECT_TRUE(SameBits(one.seeds[s].controllers[c].scores.summary,
                           three.seeds[s].controllers[c].scores.summary));
    }
  }
}

TEST(NoiseFreeTwin, RunsOnlyForTrialsThatAreMissing) {
  const test::TemporaryDirectory folder;
  const Study study = PrepareStudy(SlowGlove("", 0.3));
  const auto steps_of_progress = [&](int seeds) {
    StudyDatabase database(folder.path() / "study.db", study, {.seeds = seeds});
    StudyOptions options = Seeds(seeds, 1);
    options.store = &database;
    int steps = 0;
    double done = 0.0;
    options.progress = [&](double trials, int all) {
      EXPECT_EQ(all, 4 * seeds);  // two controllers, each with its twin
      EXPECT_LE(trials, all);
      done = trials;
      ++steps;
      return true;
    };
    RunStudy(study, options);
    EXPECT_GT(done, 0.75 * 4 * seeds);  // what is left of a trial behind its last step is not told
    return steps;
  };
  // A trial tells its progress every 64 ticks; one that is known tells it once.
  const int of_a_trial = static_cast<int>(study.repetitions[0].ticks) / 64;
  EXPECT_EQ(steps_of_progress(3), 3 * 4 * of_a_trial);
  EXPECT_EQ(steps_of_progress(4), 2 * 4 * of_a_trial + 2 * 2);  // the first seed and the new one
}

TEST(NoiseFreeTwin, TheShareAtTheLimitIsTheMeanOfItsTicks) {
  Scenario scenario = SlowGlove();
  scenario.glove.motion.settings = StepsConfig{.duration_s = 0.6, .period_s = 0.4};
  const Study study = PrepareStudy(scenario);
  const StudyResult result = RunStudy(study, Seeds(1));
  const FlagSignal& at_limit = result.first_traces[0].motor_at_limit;
  const std::size_t metric = MetricIndex("saturation_share");
  double largest = 0.0;
  for (std::size_t i = 0; i < study.measured_motors.size(); ++i) {
    const double share =
        result.seeds[0].controllers[0].scores.channels[study.rows.motors[i]][metric];
    EXPECT_DOUBLE_EQ(share, at_limit.col(study.measured_motors[i]).cast<double>().mean());
    largest = std::max(largest, share);
  }
  EXPECT_GT(largest, 0.0);
  EXPECT_LT(largest, 1.0);
}

}  // namespace
}  // namespace gauntlet::sim
