// Filters that differ by nothing that matters are told apart in no score.
#include <gtest/gtest.h>

#include "sim/answers/compare/summary.h"
#include "sim/study/scenario/scenario_reader.h"
#include "tests/support/source_dir.h"

namespace gauntlet::sim {
namespace {

TEST(Summary, TiesFiltersThatDifferByNothingThatMatters) {
  Scenario scenario =
      LoadScenario(SourceDir() + "/scenarios/random_motion.yaml", {"glove.motion.duration_s=6"});
  scenario.controllers.clear();
  for (const double q : {0.0100, 0.0101, 0.0102}) {
    controller::KalmanConfig kalman;
    kalman.noise.q = {q};
    controller::FilterConfig filter;
    filter.settings = kalman;
    NamedController& named = scenario.controllers.emplace_back();
    named.name = "q_" + std::to_string(q);
    named.config.filters = {filter};
  }
  scenario.baseline.clear();
  const Study study = PrepareStudy(std::move(scenario));
  const StudyResult result =
      RunStudy(study, {.seeds = 4, .jobs = 2, .progress = {}, .keep_first_traces = false});
  const Summary summary = Summarise(study, result);
  int scores = 0;
  for (std::size_t c = 0; c < summary.controllers.size(); ++c) {
    const ControllerSummary& controller = summary.controllers[c];
    for (std::size_t m = 0; m < Metrics().size(); ++m) {
      // Nothing is gripped. In so short a motion at most a few movements begin from rest, and
      // friction decides when the hand follows.
      if (controller.summary[m].count < std::ssize(result.seeds)) continue;
      if (Metrics()[m].key == "onset_delay_ms") continue;
      for (std::size_t other = 0; other < c; ++other) {
        EXPECT_EQ(summary.Of(m, c, other).judgement, Judgement::kEqual)
            << controller.name << " " << Metrics()[m].key;
      }
      ++scores;
    }
  }
  EXPECT_GT(scores, 3 * 15);
  EXPECT_NE(summary.controllers[0].summary[0].mean, summary.controllers[2].summary[0].mean);
}

}  // namespace
}  // namespace gauntlet::sim
