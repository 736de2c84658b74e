// Answers of another program to a recording are compared as a filter of Gauntlet is.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <fstream>
#include <numbers>
#include <string>
#include <vector>

#include "controller/settings.h"
#include "sim/base/error.h"
#include "sim/study/scenario/scenario_reader.h"
#include "sim/study/study_identity.h"
#include "sim/study/study_run.h"
#include "tests/support/program.h"

namespace gauntlet::sim {
namespace {

using testing::HasSubstr;

constexpr double kAlpha = 0.3;
constexpr int kRows = 600;

class AnswersOfPrograms : public testing::Test {
 protected:
  struct Row {
    double time_s;
    std::array<double, 2> angle_deg;
  };

  /// Two joints at 50 Hz.
  static std::vector<Row> Measured() {
    std::vector<Row> rows;
    for (int i = 0; i < kRows; ++i) {
      const double t = i / 50.0;
      const auto swing = [t](double hz) { return std::sin(2.0 * std::numbers::pi * hz * t); };
      rows.push_back({t,
                      {40.0 + 20.0 * swing(0.43) + 2.0 * swing(13.0),
                       50.0 + 30.0 * swing(0.71) + 2.0 * swing(17.0)}});
    }
    return rows;
  }
  /// These rows, filtered as `exponential` does.
  static std::vector<Row> Filtered() {
    std::vector<Row> rows = Measured();
    for (std::size_t i = 1; i < rows.size(); ++i) {
      for (std::size_t c = 0; c < 2; ++c) {
        const double before = rows[i - 1].angle_deg[c];
        rows[i].angle_deg[c] = before + kAlpha * (rows[i].angle_deg[c] - before);
      }
    }
    return rows;
  }
  void Write(const std::string& file, const std::vector<Row>& rows,
             const std::string& names = "time_s,index_mcp,index_pip") const {
    std::ofstream text(folder_.path() / file);
    text << names << "\n";
    for (const Row& row : rows) {
      text << fmt::format("{:.6f},{:.6f},{:.6f}\n", row.time_s, row.angle_deg[0], row.angle_deg[1]);
    }
  }

  Study Prepare(const std::string& filter, const std::string& glove = "  noise: none\n",
                const std::string& motion = "use: measured") const {
    return PrepareStudy(ParseScenario(
        {.file = folder_.path() / "s.yaml",
         .text = fmt::format("question: Same?\n"
                             "glove:\n  rate_hz: 50\n  channels: [index_mcp, index_pip]\n"
                             "  converter: {{bits: 16}}\n{}"
                             "  motion: {{kind: recording, file: glove.csv, {}}}\n"
                             "controllers:\n"
                             "  raw: {{filter: none}}\n"
                             "  own: {{filter: {{kind: exponential, alpha: {}}}}}\n"
                             "  mine: {}\n",
                             glove, motion, kAlpha, filter)}));
  }
  /// The error of such a scenario; empty if there is none.
  std::string Problem(const std::string& filter, const std::string& glove = "  noise: none\n",
                      const std::string& motion = "use: measured") const {
    try {
      Prepare(filter, glove, motion);
      return "";
    } catch (const UserError& error) {
      return error.what();
    } catch (const controller::SettingError& error) {
      return error.key() + ": " + error.problem();
    }
  }

  test::TemporaryDirectory folder_;
};

constexpr std::string_view kMine = "{filter: {kind: external, answers: mine.csv}}";

TEST_F(AnswersOfPrograms, OfAFilterHaveTheScoresOfTheFilter) {
  Write("glove.csv", Measured());
  Write("mine.csv", Filtered());
  const Study study = Prepare(std::string(kMine));
  for (const bool physics : {true, false}) {
    StudyOptions options;
    options.physics = physics;
    const SeedOutcome outcome = RunStudy(study, options).seeds[0];
    const auto score = [&](int place, std::string_view name) {
      return outcome.controllers[place].scores.summary[MetricIndex(name)];
    };
    for (const std::string_view name : {"tracking_rmse_deg", "delay_ms", "jitter_rms_deg"}) {
      EXPECT_NEAR(score(2, name), score(1, name), 1e-3 * std::abs(score(1, name))) << name;
      EXPECT_GT(std::abs(score(2, name) - score(0, name)), 0.05 * score(0, name)) << name;
    }
  }
}

TEST_F(AnswersOfPrograms, TakeAColumnMapOfTheirOwn) {
  Write("glove.csv", Measured());
  std::vector<Row> swapped = Filtered();
  for (Row& row : swapped) std::swap(row.angle_deg[0], row.angle_deg[1]);
  Write("mine.csv", swapped, "time_s,b,a");
  std::ofstream(folder_.path() / "mine.map.csv")
      << "column,channel,unit\ntime_s,time,s\na,index_mcp,deg\nb,index_pip,deg\n";
  const Study study =
      Prepare("{filter: {kind: external, answers: mine.csv, answers_map: mine.map.csv}}");
  StudyOptions options;
  options.physics = false;
  const SeedOutcome outcome = RunStudy(study, options).seeds[0];
  const std::size_t tracking = MetricIndex("tracking_rmse_deg");
  EXPECT_NEAR(outcome.controllers[2].scores.summary[tracking],
              outcome.controllers[1].scores.summary[tracking], 0.01);
}

TEST_F(AnswersOfPrograms, HoldTheLastWhereOneIsMissing) {
  Write("glove.csv", Measured());
  std::vector<Row> rows = Filtered();
  for (int i = 300; i < 360; ++i) rows[i].angle_deg[0] = NAN;  // for a second
  Write("mine.csv", rows);
  const Study study =
      Prepare(std::string(kMine), "  noise: none\n", "use: measured, problems: repair");
  StudyOptions options;
  options.physics = false;
  const StudyResult result = RunStudy(study, options);
  EXPECT_TRUE(result.seeds[0].controllers[2].health.ok);
  const std::size_t tracking = MetricIndex("tracking_rmse_deg");
  EXPECT_GT(result.seeds[0].controllers[2].scores.summary[tracking],
            result.seeds[0].controllers[1].scores.summary[tracking] + 0.5);
}

TEST_F(AnswersOfPrograms, MustHaveTheRowsOfTheRecording) {
  Write("glove.csv", Measured());
  std::vector<Row> rows = Filtered();
  rows.erase(rows.begin() + 100);
  Write("mine.csv", rows);
  EXPECT_THAT(Problem(std::string(kMine)), HasSubstr("mine.csv: has no row at 2.000 s, where"));
  rows = Filtered();
  rows.erase(rows.begin());  // the clock of the rest begins a row later
  Write("mine.csv", rows);
  EXPECT_THAT(Problem(std::string(kMine)), HasSubstr("mine.csv: has no row at"));
  rows = Filtered();
  for (Row& row : rows) row.time_s *= 1.01;
  Write("mine.csv", rows);
  EXPECT_THAT(Problem(std::string(kMine)), HasSubstr("mine.csv: has no row at"));
}

TEST_F(AnswersOfPrograms, MustHaveTheChannelsOfTheGlove) {
  Write("glove.csv", Measured());
  std::ofstream text(folder_.path() / "mine.csv");
  text << "time_s,index_mcp\n";
  for (const Row& row : Filtered()) text << row.time_s << "," << row.angle_deg[0] << "\n";
  text.close();
  EXPECT_THAT(Problem(std::string(kMine)), HasSubstr("has no index_pip, which"));
}

TEST_F(AnswersOfPrograms, AreOfARecordingAsItIs) {
  Write("glove.csv", Measured());
  Write("mine.csv", Filtered());
  EXPECT_EQ(Problem(std::string(kMine)), "");
  EXPECT_THAT(Problem(std::string(kMine), "  noise: none\n", "use: truth"),
              HasSubstr("answers: are of a recording, which must be played"));
  EXPECT_THAT(Problem(std::string(kMine), "  noise: {kind: box_muller}\n"),
              HasSubstr("glove.noise must be none, without glove.faults"));
  EXPECT_THAT(Problem("{filter_on: angle, filter: {kind: external, answers: mine.csv}}"),
              HasSubstr("must be the first filter, with filter_on: counts"));
  EXPECT_THAT(Problem("{filter: [{kind: exponential, alpha: 0.5}, "
                      "{kind: external, answers: mine.csv}]}"),
              HasSubstr("must be the first filter"));
  EXPECT_THAT(Problem("{filter: {kind: external, answers: mine.csv, command: cat}}"),
              HasSubstr("is there beside a command or library"));
  EXPECT_THAT(Problem("{filter: {kind: external, answers: other.csv}}"),
              HasSubstr("other.csv: no such file"));
}

TEST_F(AnswersOfPrograms, ThatChangedAreOtherTrials) {
  Write("glove.csv", Measured());
  Write("mine.csv", Filtered());
  const auto identity = [&] {
    return HashOfSettings(Prepare(std::string(kMine)).scenario.controllers[2]);
  };
  const std::string before = identity();
  EXPECT_EQ(identity(), before);
  std::vector<Row> rows = Filtered();
  rows[17].angle_deg[1] += 0.5;
  Write("mine.csv", rows);
  EXPECT_NE(identity(), before);
}

}  // namespace
}  // namespace gauntlet::sim
