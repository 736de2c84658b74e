// An output folder and what its scenario names, moved elsewhere together: the run can be repeated,
// and nothing tells where it was.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "tests/support/program.h"
#include "tests/support/read_file.h"

namespace gauntlet::test {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

class MovedFolderTest : public testing::Test {
 protected:
  MovedFolderTest() {
    fs::create_directories(In("first/data"));
    for (const char* name : {"a", "b"}) {
      std::ofstream file(In("first/data") / (std::string(name) + ".csv"));
      file << "time_s,index_mcp\n";
      for (int i = 0; i < 20; ++i) file << 0.02 * i << ',' << i << '\n';
    }
    std::ofstream(In("first/scenario.yaml"))
        << "question: Which?\nglove: {motion: {kind: recording}}\n"
           "repetitions:\n  glove.motion.file: [data/a.csv, data/b.csv]\n"
           "controllers:\n  raw: {}\n  mean: {filter: {kind: moving_average, window: 20}}\n";
  }
  fs::path In(const std::string& name) const { return folder_.path() / name; }
  ProgramResult Run(std::vector<std::string> arguments, const std::string& where) const {
    arguments.insert(arguments.begin(), GAUNTLET_PROGRAM);
    return RunProgram(arguments, {.working_directory = In(where)});
  }

  TemporaryDirectory folder_;
};

TEST_F(MovedFolderTest, RepeatsToTheSameBytesAndNamesNoPlaceOfTheMachine) {
  ASSERT_EQ(Run({"run", "scenario.yaml", "--out", "out/one"}, "first").exit_code, 0);
  for (const char* name : {"report.html", "scenario.resolved.yaml", "scores.json", "trace.h5"}) {
    EXPECT_THAT(ReadFile(In("first/out/one") / name), Not(HasSubstr(folder_.path().string())))
        << name;
  }
  EXPECT_THAT(ReadFile(In("first/out/one/scenario.resolved.yaml")),
              HasSubstr("file: \"../../data/a.csv\""));
  fs::create_directories(In("far/away"));
  fs::rename(In("first"), In("far/away/second"));
  const ProgramResult again =
      Run({"run", "one/scenario.resolved.yaml", "--out", "again"}, "far/away/second/out");
  ASSERT_EQ(again.exit_code, 0) << again.standard_error;
  EXPECT_THAT(again.standard_error, Not(HasSubstr("warning")));
  const fs::path out = In("far/away/second/out");
  for (const char* name :
       {"scores.json", "scores.csv", "trace.h5", "report.html", "scenario.resolved.yaml"}) {
    EXPECT_TRUE(ReadFile(out / "one" / name) == ReadFile(out / "again" / name)) << name;
  }
}

TEST_F(MovedFolderTest, TheDatabaseStillKnowsItsTrialsUntilAFileIsAnother) {
  const std::vector<std::string> compare = {"compare", "scenario.yaml", "--seeds",
                                            "2",       "--out",         "out"};
  ASSERT_EQ(Run(compare, "first").exit_code, 0);
  fs::rename(In("first"), In("second"));
  const ProgramResult again = Run(compare, "second");
  ASSERT_EQ(again.exit_code, 0) << again.standard_error;
  EXPECT_THAT(again.standard_error, HasSubstr("which holds 4 trials"));
  std::ofstream(In("second/data/b.csv"), std::ios::app) << "0.4,21\n";
  EXPECT_THAT(Run(compare, "second").standard_error, Not(HasSubstr("which holds")));
}

TEST_F(MovedFolderTest, ARecordingThatChangedIsNamed) {
  ASSERT_EQ(Run({"run", "scenario.yaml", "--out", "out"}, "first").exit_code, 0);
  std::ofstream(In("first/data/b.csv"), std::ios::app) << "0.4,21\n";
  const ProgramResult again = Run({"run", "out/scenario.resolved.yaml", "--out", "again"}, "first");
  EXPECT_EQ(again.exit_code, 0) << again.standard_error;
  EXPECT_THAT(again.standard_error,
              AllOf(HasSubstr("data/b.csv is not as it was when this scenario was resolved"),
                    Not(HasSubstr("data/a.csv"))));
  // What it is now counts from then on.
  const ProgramResult third =
      Run({"run", "again/scenario.resolved.yaml", "--out", "third"}, "first");
  EXPECT_THAT(third.standard_error, Not(HasSubstr("warning")));
}

TEST_F(MovedFolderTest, ARecordingOfGauntletsOwnIsFoundFromAnywhere) {
  ASSERT_EQ(Run({"run", "door_opening", "--controllers", "raw", "--set",
                 "glove.motion.duration_s=0.1", "--out", "out"},
                "first")
                .exit_code,
            0);
  EXPECT_THAT(ReadFile(In("first/out/scenario.resolved.yaml")),
              HasSubstr("file: \"scenarios/recordings/door_opening/"));
  fs::create_directories(In("far/away"));
  fs::rename(In("first/out"), In("far/away/out"));
  const ProgramResult again =
      Run({"run", "out/scenario.resolved.yaml", "--out", "again"}, "far/away");
  ASSERT_EQ(again.exit_code, 0) << again.standard_error;
  for (const char* name : {"trace.h5", "scenario.resolved.yaml"}) {
    EXPECT_TRUE(ReadFile(In("far/away/out") / name) == ReadFile(In("far/away/again") / name));
  }
}

}  // namespace
}  // namespace gauntlet::test
