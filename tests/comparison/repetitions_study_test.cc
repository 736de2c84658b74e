// A comparison over several recordings is what its single trials are, and knows which seeds share a
// motion.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

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

using testing::ElementsAre;

/// A slow glove of five channels, and three recordings of different lengths.
class RepetitionsStudyTest : public testing::Test {
 protected:
  RepetitionsStudyTest() {
    WriteRecording("a.csv", 0.4, 10.0);
    WriteRecording("b.csv", 0.5, 25.0);
    WriteRecording("c.csv", 0.3, 40.0);
  }
  void WriteRecording(const std::string& name, double duration_s, double swing_deg) {
    std::ofstream file(folder_.path() / name);
    file << "time_s,thumb_ip,index_pip,middle_pip,ring_pip,little_pip\n";
    for (int k = 0; k <= 100.0 * duration_s; ++k) {
      const double angle_deg = 45.0 + swing_deg * std::sin(0.06 * k);
      file << fmt::format("{:.2f},{:.3f},{:.3f},{:.3f},{:.3f},{:.3f}\n", 0.01 * k, 0.5 * angle_deg,
                          angle_deg, 90.0 - angle_deg, angle_deg, 0.7 * angle_deg);
    }
  }
  Scenario Parse(const std::string& glove, const std::string& repetitions) {
    return ParseScenario({.file = folder_.path() / "s.yaml",
                          .text = "question: Same?\nseed: 3\nglove:\n  rate_hz: 33.3\n" + glove +
                                  "repetitions:\n" + repetitions +
                                  "controllers:\n"
                                  "  first:\n    filter: {kind: exponential}\n"
                                  "  second:\n    filter: {kind: median, window: 3}\n"});
  }
  Scenario OfThreeRecordings(const std::string& glove = "") {
    return Parse(
        "  channels: [thumb_ip, index_pip, middle_pip, ring_pip, little_pip]\n"
        "  motion: {kind: recording}\n" +
            glove,
        "  glove.motion.file: [a.csv, b.csv, c.csv]\n");
  }
  static StudyOptions Seeds(int seeds) {
    StudyOptions options;
    options.seeds = seeds;
    options.jobs = 2;
    return options;
  }
  static std::vector<int> Motions(const StudyResult& result) {
    std::vector<int> motions;
    for (const SeedOutcome& seed : result.seeds) motions.push_back(seed.motion);
    return motions;
  }

  test::TemporaryDirectory folder_;
};

bool SameBits(const std::vector<double>& a, const std::vector<double>& b) {
  return std::ranges::equal(a, b, [](double x, double y) {
    return std::bit_cast<std::uint64_t>(x) == std::bit_cast<std::uint64_t>(y);
  });
}

void ExpectSameScores(const SeedOutcome& a, const SeedOutcome& b) {
  ASSERT_EQ(a.controllers.size(), b.controllers.size());
  for (std::size_t c = 0; c < a.controllers.size(); ++c) {
    EXPECT_TRUE(SameBits(a.controllers[c].scores.summary, b.controllers[c].scores.summary)) << c;
  }
}

TEST_F(RepetitionsStudyTest, EveryTrialIsTheOneOfItsSeedAlone) {
  const Study study = PrepareStudy(OfThreeRecordings());
  const StudyResult result = RunStudy(study, Seeds(6));
  ASSERT_EQ(result.seeds.size(), 6u);
  EXPECT_THAT(Motions(result), ElementsAre(0, 1, 2, 0, 1, 2));
  EXPECT_FALSE(result.seeds_alike);
  EXPECT_NEAR(result.shortest_s, 0.3, 0.02);
  EXPECT_NEAR(result.longest_s, 0.5, 0.02);
  for (const SeedOutcome& seed : result.seeds) {
    Scenario alone = study.scenario;
    alone.glove = GloveOf(study.scenario, seed.seed);
    alone.repetitions = {};
    alone.seed = seed.seed;
    ExpectSameScores(RunStudy(PrepareStudy(alone), {}).seeds[0], seed);
  }
  // Two noises of one motion differ.
  EXPECT_NE(result.seeds[0].controllers[0].scores.summary[MetricIndex("tracking_rmse_deg")],
            result.seeds[3].controllers[0].scores.summary[MetricIndex("tracking_rmse_deg")]);
}

TEST_F(RepetitionsStudyTest, FewerSeedsThanRepetitionsTakeTheFirstOnes) {
  const StudyResult result = RunStudy(PrepareStudy(OfThreeRecordings()), Seeds(2));
  EXPECT_THAT(Motions(result), ElementsAre(0, 1));
  EXPECT_NEAR(result.shortest_s, 0.4, 0.02);
}

TEST_F(RepetitionsStudyTest, WhereNothingIsDrawnEveryRepetitionRunsOnce) {
  const std::string exact =
      "  noise: none\n"
      "  sensor: {gain_deviation_percent: 0, offset_deviation_percent: 0,\n"
      "    curvature_deviation_percent: 0, cross_talk_percent: 0, hysteresis_deg: 0}\n";
  const StudyResult result = RunStudy(PrepareStudy(OfThreeRecordings(exact)), Seeds(8));
  EXPECT_TRUE(result.seeds_alike);
  EXPECT_THAT(Motions(result), ElementsAre(0, 1, 2));
}

TEST_F(RepetitionsStudyTest, AMotionThatIsDrawnIsAnotherForEverySeed) {
  const StudyResult drawn =
      RunStudy(PrepareStudy(Parse("",
                                  "  glove.motion: [{kind: random, duration_s: 0.3}, {kind: hold, "
                                  "duration_s: 0.3}]\n")),
               Seeds(6));
  EXPECT_THAT(Motions(drawn), ElementsAre(0, 1, 2, 1, 3, 1));

  const StudyResult noises =
      RunStudy(PrepareStudy(Parse("  motion: {kind: hold, duration_s: 0.3}\n",
                                  "  glove.noise.variance_scale: [1, 4]\n")),
               Seeds(5));
  EXPECT_THAT(Motions(noises), ElementsAre(0, 0, 0, 0, 0));
}

TEST_F(RepetitionsStudyTest, TheDatabaseKnowsTheContentOfEveryRecording) {
  const std::filesystem::path file = folder_.path() / "study.db";
  const auto trials_kept = [&] {
    const Study study = PrepareStudy(OfThreeRecordings());
    StudyDatabase database(file, study, {.seeds = 6});
    const int kept = database.TrialCount();
    StudyOptions options = Seeds(6);
    options.store = &database;
    RunStudy(study, options);
    return kept;
  };
  EXPECT_EQ(trials_kept(), 0);
  EXPECT_EQ(trials_kept(), 12);
  WriteRecording("c.csv", 0.3, 41.0);  // the last of them, under the same name
  EXPECT_EQ(trials_kept(), 0);
}

}  // namespace
}  // namespace gauntlet::sim
