// A study that keeps some scores computes and records only what these need.
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <map>

#include "sim/study/scenario/scenario_reader.h"
#include "sim/study/study_run.h"
#include "sim/study/trial_score.h"

namespace gauntlet::sim {
namespace {

/// With trembling long enough to be measured, a movement and all kinds of parts.
Study ShortStudy() {
  return PrepareStudy(
      ParseScenario({.file = "s.yaml",
                     .text = "question: Which?\nglove:\n  channels: [index_mcp, index_pip]\n"
                             "  motion: {kind: random, duration_s: 2}\n"
                             "controllers:\n  raw: {filter: none}\n"}));
}

StudyOptions Keeping(std::vector<std::size_t> metrics, bool physics = true) {
  StudyOptions options;
  options.keep_first_traces = false;
  options.keep_rows = true;
  options.physics = physics;
  options.scores = std::move(metrics);
  options.causes = CauseSeeds::kAll;
  return options;
}

const Scores& ScoresOf(const StudyResult& result) {
  return result.seeds.front().controllers.front().scores;
}

void ExpectSameBits(double some, double all, std::string_view what) {
  EXPECT_EQ(std::bit_cast<std::uint64_t>(some), std::bit_cast<std::uint64_t>(all))
      << what << ": " << some << " and " << all;
}

TEST(KeptScores, HaveTheValuesThatTheyHaveAmongAll) {
  const Study study = ShortStudy();
  const StudyResult all_result = RunStudy(study, Keeping({}));
  const Scores& all = ScoresOf(all_result);
  // Those that are made of the same signals together.
  std::map<std::vector<std::string_view>, std::vector<std::size_t>> kinds;
  for (std::size_t m = 0; m < Metrics().size(); ++m) {
    kinds[SignalsOfScores(std::vector{m})].push_back(m);
  }
  EXPECT_EQ(kinds.size(), 5u);  // joints, without a twin and with one, motors, cables, the hand
  for (const auto& [signals, metrics] : kinds) {
    const StudyResult some_result = RunStudy(study, Keeping(metrics));
    const Scores& some = ScoresOf(some_result);
    int finite = 0;
    for (std::size_t m = 0; m < Metrics().size(); ++m) {
      if (!std::ranges::binary_search(metrics, m)) {
        EXPECT_TRUE(std::isnan(some.summary[m])) << Metrics()[m].key;
        continue;
      }
      ExpectSameBits(some.summary[m], all.summary[m], Metrics()[m].key);
      for (std::size_t row = 0; row < all.channels.size(); ++row) {
        ExpectSameBits(some.channels[row][m], all.channels[row][m], Metrics()[m].key);
        finite += std::isfinite(some.channels[row][m]) ? 1 : 0;
      }
    }
    EXPECT_TRUE(finite > 0 || std::ranges::count(signals, "digit_overlap_m") == 1);  // the hand
  }
}

TEST(KeptScores, OfATrialWithoutAHandHaveThemToo) {
  const Study study = ShortStudy();
  const StudyResult all_result = RunStudy(study, Keeping({}, false));
  for (const char* key : {"tracking_rmse_deg", "jitter_rms_deg", "noise_jitter_rms_deg"}) {
    const std::size_t m = MetricIndex(key);
    const StudyResult one_result = RunStudy(study, Keeping({m}, false));
    ExpectSameBits(ScoresOf(one_result).summary[m], ScoresOf(all_result).summary[m], key);
  }
}

TEST(KeptScores, OfJointsAloneNeedNoSignalOfMotorsAndCables) {
  const std::size_t tracking[] = {MetricIndex("tracking_rmse_deg"), MetricIndex("delay_ms")};
  EXPECT_EQ(SignalsOfScores(tracking), std::vector<std::string_view>{"hand_angle_rad"});
  const std::size_t slack[] = {MetricIndex("slack_share")};
  EXPECT_EQ(SignalsOfScores(slack), (std::vector<std::string_view>{"hand_angle_rad", "tension_n"}));
  EXPECT_EQ(std::ranges::count(SignalsOfScores({}), "linearised_angle_rad"), 0);
}

}  // namespace
}  // namespace gauntlet::sim
