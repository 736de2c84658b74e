// Trials come back from the database bit by bit, and only to the study that they belong to.
#include "sim/study/study_database.h"

#include <SQLiteCpp/SQLiteCpp.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/support/program.h"

namespace gauntlet::sim {
namespace {

Study MakeStudy(const std::string& question, double duration_s) {
  Scenario scenario;
  scenario.name = "made_up";
  scenario.question = question;
  scenario.glove.motion.settings = HoldConfig{.duration_s = duration_s};
  scenario.controllers = {{.name = "raw", .config = {}}, {.name = "same", .config = {}}};
  return PrepareStudy(scenario);
}

TrialOutcome MakeOutcome() {
  TrialOutcome outcome;
  for (std::size_t m = 0; m < Metrics().size(); ++m) {
    outcome.scores.summary.push_back(1.0 / 3.0 + static_cast<double>(m));
  }
  outcome.scores.summary[2] = std::numeric_limits<double>::quiet_NaN();
  outcome.scores.channels.assign(18 + 36, outcome.scores.summary);  // joints and motors, cables
  outcome.scores.channels[7][3] = -1e-300;
  outcome.untrusted_samples.assign(18, 0);
  outcome.untrusted_samples[4] = 1'000'000'000'000;
  return outcome;
}

class StudyDatabaseTest : public testing::Test {
 protected:
  test::TemporaryDirectory folder_;
  std::filesystem::path file_ = folder_.path() / "study.db";
  Study study_ = MakeStudy("What is kept?", 0.5);
};

TEST_F(StudyDatabaseTest, GivesATrialBackBitByBit) {
  const TrialOutcome kept = MakeOutcome();
  StudyDatabase(file_, study_).Keep(7, 1, kept);
  StudyDatabase database(file_, study_);
  EXPECT_EQ(database.TrialCount(), 1);
  const auto found = database.Find(7, 1);
  ASSERT_TRUE(found);
  for (std::size_t m = 0; m < Metrics().size(); ++m) {
    if (m == 2) {
      EXPECT_TRUE(std::isnan(found->scores.summary[m]));
    } else {
      EXPECT_EQ(found->scores.summary[m], kept.scores.summary[m]);
    }
  }
  EXPECT_EQ(found->scores.channels[7][3], -1e-300);
  EXPECT_EQ(found->untrusted_samples, kept.untrusted_samples);
  EXPECT_TRUE(found->health.ok);
}

TEST_F(StudyDatabaseTest, KeepsWhyAHandStopped) {
  TrialOutcome outcome = MakeOutcome();
  outcome.health = {.ok = false, .problem = "at 1.5 s: diverged"};
  StudyDatabase database(file_, study_);
  database.Keep(1, 0, outcome);
  EXPECT_FALSE(database.Find(1, 0)->health.ok);
  EXPECT_EQ(database.Find(1, 0)->health.problem, "at 1.5 s: diverged");
}

TEST_F(StudyDatabaseTest, FindsNeitherOtherSeedsNorOtherControllers) {
  StudyDatabase database(file_, study_);
  EXPECT_FALSE(database.Find(7, 1));
  database.Keep(7, 1, MakeOutcome());
  EXPECT_FALSE(database.Find(8, 1));
  EXPECT_FALSE(database.Find(7, 0));  // of the same settings, but of another name
}

TEST_F(StudyDatabaseTest, AnotherWordingIsTheSameStudyAnotherSettingIsNot) {
  StudyDatabase(file_, study_).Keep(7, 1, MakeOutcome());
  const Study reworded = MakeStudy("Reworded?", 0.5);
  EXPECT_TRUE(StudyDatabase(file_, reworded).Find(7, 1));
  const Study longer = MakeStudy("What is kept?", 0.6);
  StudyDatabase other(file_, longer);
  EXPECT_FALSE(other.Find(7, 1));
  other.Keep(1, 0, MakeOutcome());
  EXPECT_EQ(StudyDatabase(file_, longer).TrialCount(), 1);
  EXPECT_EQ(StudyDatabase(file_, study_).TrialCount(), 1);  // what other settings gave stays
  EXPECT_TRUE(StudyDatabase(file_, study_).Find(7, 1));
}

TEST_F(StudyDatabaseTest, ShowsWhatWasAskedForLast) {
  StudyDatabase(file_, study_).Keep(7, 0, MakeOutcome());
  StudyDatabase(file_, study_).Keep(7, 1, MakeOutcome());
  StudyDatabase(file_, MakeStudy("What is kept?", 0.6)).Keep(7, 0, MakeOutcome());
  SQLite::Database database(file_.string());
  const auto count = [&](const std::string& view) {
    return database
        .execAndGet("SELECT count(*) FROM " + view +
                    " WHERE channel = 'summary' AND metric = 'delay_ms'")
        .getInt();
  };
  EXPECT_EQ(count("scores"), 1);
  EXPECT_EQ(count("all_scores"), 3);
  {
    StudyDatabase again(file_, study_);
    again.Keep(8, 0, MakeOutcome());
    EXPECT_TRUE(again.Find(7, 0));
  }
  EXPECT_EQ(count("scores"), 2);  // of controller 1, kept before, nobody asked again
  EXPECT_EQ(count("all_scores"), 4);
}

TEST_F(StudyDatabaseTest, AControllerThatIsLeftOutKeepsItsTrials) {
  StudyDatabase(file_, study_).Keep(7, 1, MakeOutcome());
  Study only_raw = study_;
  only_raw.scenario.controllers.pop_back();
  {
    StudyDatabase database(file_, only_raw);
    database.Keep(7, 0, MakeOutcome());
  }
  EXPECT_EQ(StudyDatabase(file_, study_).TrialCount(), 2);
}

TEST_F(StudyDatabaseTest, TrialsOfOtherSettingsOfAControllerStay) {
  study_.scenario.controllers[1].name = "it's mine";
  StudyDatabase(file_, study_).Keep(7, 0, MakeOutcome());
  StudyDatabase(file_, study_).Keep(7, 1, MakeOutcome());
  Study changed = study_;
  changed.scenario.controllers[1].config.filter_at = controller::FilterAt::kEvent;
  StudyDatabase database(file_, changed);
  EXPECT_TRUE(database.Find(7, 0));
  EXPECT_FALSE(database.Find(7, 1));
  database.Keep(7, 1, MakeOutcome());
  EXPECT_EQ(database.TrialCount(), 2);
  EXPECT_EQ(StudyDatabase(file_, study_).TrialCount(), 2);
}

TEST_F(StudyDatabaseTest, TheFileAppearsWithTheFirstTrial) {
  {
    StudyDatabase database(file_, study_);
    EXPECT_EQ(database.TrialCount(), 0);
  }
  EXPECT_FALSE(std::filesystem::exists(file_));
  StudyDatabase(file_, study_).Keep(1, 0, MakeOutcome());
  EXPECT_TRUE(std::filesystem::exists(file_));
}

}  // namespace
}  // namespace gauntlet::sim
