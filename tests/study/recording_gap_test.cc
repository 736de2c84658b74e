// What is missing in a recording does not move the scores of the rest.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <functional>
#include <numbers>
#include <string>

#include "sim/study/scenario/scenario_reader.h"
#include "sim/study/study_run.h"
#include "tests/support/program.h"

namespace gauntlet::sim {
namespace {

class RecordingGap : public testing::Test {
 protected:
  /// Tracking error of a glove of one finger that swings for 12 s; a row of time below 0 is left
  /// out.
  double TrackingOf(const std::function<double(double)>& time_of,
                    const std::string& settings = "") {
    const std::string file = (folder_.path() / "glove.csv").string();
    {
      std::ofstream rows(file);
      rows << "time_s,index_mcp,index_pip\n";
      for (int i = 0; i < 1200; ++i) {
        const double t = 0.01 * i;
        if (time_of(t) < 0.0) continue;
        const auto swing = [t](double hz) { return std::sin(2.0 * std::numbers::pi * hz * t); };
        rows << fmt::format("{:.2f},{:.3f},{:.3f}\n", time_of(t), 30.0 + 30.0 * swing(0.23),
                            50.0 + 40.0 * swing(0.31));
      }
    }
    const Study study = PrepareStudy(ParseScenario(
        {.file = folder_.path() / "s.yaml",
         .text = "question: Same?\n" + settings +
                 "glove:\n  rate_hz: 100\n  channels: [index_mcp, index_pip]\n  noise: none\n"
                 "  motion: {kind: recording, file: glove.csv, use: measured, problems: repair}\n"
                 "controllers:\n  raw: {filter: none}\n"}));
    remarks_ = study.remarks;
    StudyOptions options;
    options.keep_first_traces = false;
    const Scores scores = RunStudy(study, options).seeds[0].controllers[0].scores;
    return scores.summary[MetricIndex("tracking_rmse_deg")];
  }

  std::vector<std::string> remarks_;
  test::TemporaryDirectory folder_;
};

TEST_F(RecordingGap, OfASecondDoesNotMoveTheErrorOfTheRest) {
  const double whole = TrackingOf([](double t) { return t; });
  EXPECT_THAT(remarks_, testing::IsEmpty());
  const auto cut = [](double t) { return t > 5.5 && t < 6.5 ? -1.0 : t; };
  EXPECT_NEAR(TrackingOf(cut), whole, 0.15 * whole);
  EXPECT_THAT(remarks_,
              testing::Contains(testing::HasSubstr(
                  "(gaps and restarts of the recording, 1 s after each, and clipped samples")));
  EXPECT_THAT(remarks_, testing::Contains(testing::HasSubstr("scored: 83 % of every joint")));
  // The same, but the clock starts anew behind it.
  const auto restart = [](double t) { return t > 5.5 && t < 6.5 ? -1.0 : t > 6.0 ? t - 6.4 : t; };
  EXPECT_NEAR(TrackingOf(restart), whole, 0.15 * whole);
  // Without the time to come back the error of coming back counts.
  EXPECT_GT(TrackingOf(cut, "score: {recovery_s: 0}\n"), 1.05 * whole);
}

}  // namespace
}  // namespace gauntlet::sim
