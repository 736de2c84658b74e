#include "sim/answers/compare/prediction_ceiling.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <string>
#include <vector>

#include "sim/study/scenario/scenario_reader.h"
#include "tests/support/program.h"
#include "tests/support/source_dir.h"

namespace gauntlet::sim {
namespace {

/// Three joints, so many seeds of their motion; nothing is simulated.
class PredictionCeilingTest : public testing::Test {
 protected:
  std::vector<PredictionCeiling> Measure(const std::string& controllers, int seeds = 4,
                                         const std::vector<std::string>& overrides = {}) {
    const auto file = folder_.path() / "scenario.yaml";
    std::ofstream(file) << "question: q\nglove:\n" + glove_ + "controllers:\n" + controllers;
    const Study study = PrepareStudy(LoadScenario(file, overrides));
    StudyResult result;
    for (int i = 0; i < seeds; ++i) {
      result.seeds.push_back({.seed = study.scenario.seed + i, .motion = i, .controllers = {}});
    }
    remarks_.clear();
    return MeasurePredictionCeilings(study, result,
                                     [this](const std::string& line) { remarks_.push_back(line); });
  }

  test::TemporaryDirectory folder_;
  std::vector<std::string> remarks_;
  std::string glove_ =
      "  channels: [index_mcp, index_pip, wrist_flexion]\n"
      "  motion: {kind: random, duration_s: 6, bandwidth_hz: 1}\n";
};

TEST_F(PredictionCeilingTest, IsOnlyForPredictionsWithAHorizonOnSeveralRepetitions) {
  EXPECT_TRUE(Measure("  raw: {filter: none}\n").empty());
  EXPECT_TRUE(Measure("  still: {prediction: {kind: linear, horizon_ms: 0}}\n").empty());
  EXPECT_TRUE(Measure("  a: {prediction: adaptive}\n", 1).empty());
  const auto two = Measure("  raw: {filter: none}\n  a: {prediction: adaptive}\n", 2);
  ASSERT_EQ(two.size(), 1u);
  EXPECT_EQ(two[0].controller, "a");
  EXPECT_EQ(two[0].now.count, 2);
  EXPECT_TRUE(remarks_.empty());
}

TEST_F(PredictionCeilingTest, OrdersWhatKnowsMore) {
  const auto ceilings = Measure(
      "  ours: {prediction: {kind: adaptive, horizon_ms: [100, 80, 100]}}\n"
      "  careless: {prediction: {kind: linear, horizon_ms: [100, 80, 100], window_ms: 5}}\n"
      "  late: {filter: {kind: moving_average, window: 200},"
      " prediction: {kind: linear, horizon_ms: [100, 80, 100]}}\n");
  ASSERT_EQ(ceilings.size(), 3u);
  const PredictionCeiling& ours = ceilings[0];
  EXPECT_EQ(ours.shortest_horizon_ms, 80);
  EXPECT_EQ(ours.longest_horizon_ms, 100);
  EXPECT_LT(ours.known.mean, ours.fitted.mean);
  EXPECT_LT(ours.fitted.mean, 0.7 * ours.now.mean);
  EXPECT_LT(ours.ours.mean, 0.8 * ours.now.mean);
  EXPECT_GT(ours.used.mean, 0.65);
  EXPECT_NEAR(ours.used.mean, (ours.now.mean - ours.ours.mean) / (ours.now.mean - ours.fitted.mean),
              0.05);
  // A slope over 5 ms is noise; a filter that is 100 ms late takes the prediction away.
  EXPECT_LT(ceilings[1].used.mean, 0.0);
  EXPECT_LT(ceilings[2].used.mean, 0.3);
  for (const PredictionCeiling& other : ceilings) {  // the way's ends are the motion's own
    EXPECT_EQ(other.now.mean, ours.now.mean);
    EXPECT_EQ(other.fitted.mean, ours.fitted.mean);
    EXPECT_EQ(other.known.mean, ours.known.mean);
  }
}

/// No prediction of the program goes beyond its interval, and one that is fitted so goes all of it.
TEST_F(PredictionCeilingTest, IsBeatenByNoPrediction) {
  glove_ =
      "  motion: {kind: recording}\n"
      "repetitions:\n  glove.motion.file:\n";
  for (const char* number : {"01", "02", "03", "04", "05", "06", "07", "08", "09", "10"}) {
    glove_ += fmt::format("    - {}/scenarios/recordings/door_opening/angles_{}.csv\n", SourceDir(),
                          number);
  }
  std::string controllers;
  for (const char* kind : {"linear", "kalman", "kalman, states: 3", "adaptive", "fitted_to_others",
                           "fitted_to_others, offset: true"}) {
    controllers += fmt::format("  c{}: {{prediction: {{kind: {}, horizon_ms: 90}}}}\n",
                               controllers.size(), kind);
  }
  const auto ceilings = Measure(controllers, 10);
  ASSERT_EQ(ceilings.size(), 6u) << (remarks_.empty() ? "" : remarks_[0]);
  for (const PredictionCeiling& ceiling : ceilings) {
    EXPECT_LE(ceiling.used.low, 1.0) << ceiling.controller;
    EXPECT_LE(ceiling.used_of_all.low, 1.0) << ceiling.controller;
    EXPECT_FALSE(ceiling.is_same_motion);
  }
  EXPECT_LT(ceilings[3].used.mean, 0.75);  // of samples 5 ms apart it was 0.86
  EXPECT_GT(ceilings[4].used.mean, 0.75);
  EXPECT_DOUBLE_EQ(ceilings[5].used.mean, 1.0);
  EXPECT_LT(ceilings[5].used_of_all.mean, 0.97);
}

TEST_F(PredictionCeilingTest, SaysWhereAllRepetitionsHaveOneMotion) {
  glove_ =
      "  channels: [index_mcp, index_pip]\n"
      "  motion: {kind: bursts, bursts: 4, cycles: 5}\n";
  StudyResult result;
  const auto file = folder_.path() / "scenario.yaml";
  std::ofstream(file) << "question: q\nglove:\n" + glove_ +
                             "controllers:\n  a: {prediction: adaptive}\n";
  const Study study = PrepareStudy(LoadScenario(file, {}));
  for (int i = 0; i < 3; ++i)
    result.seeds.push_back({.seed = i + 1, .motion = 0, .controllers = {}});
  const auto ceilings = MeasurePredictionCeilings(study, result, {});
  ASSERT_EQ(ceilings.size(), 1u);
  EXPECT_TRUE(ceilings[0].is_same_motion);
}

TEST_F(PredictionCeilingTest, LeavesOutWhatNobodyKnowsOfARecording) {
  glove_ =
      "  rate_hz: 100\n  channels: [index_mcp]\n  noise: none\n"
      "  motion: {kind: recording, files: [glove_1.csv, glove_2.csv], use: measured, "
      "problems: repair}\n";
  const auto measure = [this](bool cut) {
    for (const int number : {1, 2}) {
      std::ofstream rows(folder_.path() / ("glove_" + std::to_string(number) + ".csv"));
      rows << "time_s,index_mcp\n";
      for (int i = 0; i < 1200; ++i) {
        const double t = 0.01 * i;
        if (cut && t > 5.5 && t < 6.5) continue;
        rows << t << ',' << 30.0 + 20.0 * std::sin(1.4 * t) + 9.0 * std::sin((2.0 + number) * t)
             << '\n';
      }
    }
    const auto ceilings =
        Measure("  a: {prediction: {kind: kalman, states: 3, horizon_ms: 100}}\n", 2);
    EXPECT_THAT(remarks_, testing::IsEmpty());
    return ceilings.at(0);
  };
  const PredictionCeiling whole = measure(false);
  const PredictionCeiling rest = measure(true);
  EXPECT_NEAR(rest.now.mean, whole.now.mean, 0.1 * whole.now.mean);
  EXPECT_NEAR(rest.known.mean, whole.known.mean, 0.1 * whole.known.mean);
}

TEST_F(PredictionCeilingTest, MeasuresWeightsOnWhatTheyWereNotFittedTo) {
  const std::string fitted = "  a: {prediction: {kind: kalman, states: 3, horizon_ms: 100}}\n";
  const auto short_motions = Measure(fitted, 2, {"glove.motion.duration_s=2"});
  const auto long_motions = Measure(fitted, 2, {"glove.motion.duration_s=30"});
  ASSERT_EQ(short_motions.size() * long_motions.size(), 1u);
  // Weights that were fitted to the two seconds they are measured on would be the better there.
  EXPECT_GT(short_motions[0].fitted.mean / short_motions[0].now.mean,
            long_motions[0].fitted.mean / long_motions[0].now.mean);
}

TEST_F(PredictionCeilingTest, HasNoShareOfNothing) {
  const auto ceilings =
      Measure("  a: {prediction: {kind: adaptive, horizon_ms: 20}}\n", 4,
              {"glove.motion.bandwidth_hz=0.05", "glove.noise.variance_scale=0.0025"});
  ASSERT_EQ(ceilings.size(), 1u);
  EXPECT_TRUE(std::isnan(ceilings[0].used.mean)) << ceilings[0].used.mean;
}

TEST_F(PredictionCeilingTest, WorksAtOtherRates) {
  for (const char* rate : {"glove.rate_hz=33.3", "glove.rate_hz=4000"}) {
    const auto ceilings = Measure("  a: {prediction: {kind: kalman, horizon_ms: 120}}\n", 4,
                                  {rate, "glove.motion.duration_s=15"});
    ASSERT_EQ(ceilings.size(), 1u) << rate << (remarks_.empty() ? "" : remarks_[0]);
    EXPECT_LT(ceilings[0].fitted.mean, ceilings[0].now.mean) << rate;
  }
}

// A sample of this glove lasts 30 ms: weights look ahead by parts of it, as it is judged by parts.
TEST_F(PredictionCeilingTest, DoesNotDependOnWhichSampleIsNearest) {
  const auto fitted = [this](const std::string& horizon_ms) {
    const auto ceilings =
        Measure("  a: {prediction: {kind: kalman, horizon_ms: " + horizon_ms + "}}\n", 4,
                {"glove.rate_hz=33.3", "glove.motion.duration_s=20"});
    return ceilings.at(0).fitted.mean;
  };
  const double below = fitted("44.9");
  EXPECT_NEAR(fitted("45.2"), below, 0.02 * below);
}

TEST_F(PredictionCeilingTest, IsKnownOfFiltersAtEventsAndOfPlannedCommands) {
  const auto ceilings = Measure(
      "  events: {filter_at: event, prediction: {kind: adaptive, horizon_ms: 80}}\n"
      "  planned: {model_predictive: {kind: second_order}, prediction: {kind: adaptive, "
      "horizon_ms: "
      "80}}\n");
  EXPECT_THAT(remarks_, testing::IsEmpty());
  ASSERT_EQ(ceilings.size(), 2u);
  EXPECT_EQ(ceilings[0].fitted.mean, ceilings[1].fitted.mean);
  EXPECT_EQ(ceilings[0].now.mean, ceilings[1].now.mean);
}

TEST_F(PredictionCeilingTest, SaysWhyThereIsNone) {
  EXPECT_TRUE(Measure("  a: {prediction: adaptive}\n", 4, {"glove.motion.duration_s=0.3"}).empty());
  ASSERT_EQ(remarks_.size(), 1u);
  EXPECT_THAT(remarks_[0], testing::StartsWith("a: what is predictable is not known: "));
}

}  // namespace
}  // namespace gauntlet::sim
